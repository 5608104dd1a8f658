// Where a run directory may lie.
#include <functional>

#include "engine/store/store.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

void Open(const std::string& dir) { ResultStore::Open(dir, TestRecipe(), TestLayout()); }

std::string Refusal(const std::function<void()>& use) {
  try {
    use();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(PlaceTest, WhatIsRefusedByItsNameOrItsDiskMakesNoFolder) {
  const TempDir temp;
  setenv("ED3R_STORE", "lokal", 1);
  EXPECT_EQ(Refusal([&] { Open(temp / "a/b/run"); }),
            "ED3R_STORE: 'lokal' is not allowed; allowed: local | shared");
  unsetenv("ED3R_STORE");
  EXPECT_FALSE(fs::exists(temp / "a"));

  const std::string base = fs::canonical(temp / ".").string();
  const auto run_of = [&](std::size_t bytes) {  // of the results file's path
    std::string dir = base + "/a";
    for (const std::size_t length = bytes - std::string("/results.sqlite").size(); dir.size() < length;)
      dir += dir.size() % 100 == 0 && dir.size() + 1 < length ? "/" : "d";
    return dir;
  };
  const std::string why =
      "/results.sqlite: its whole path has 505 bytes, and SQLite opens none of more than 504; give a shorter "
      "one";
  EXPECT_EQ(Refusal([&] { Open(run_of(505)); }), run_of(505) + why);
  EXPECT_FALSE(fs::exists(temp / "a"));
  WriteStore(run_of(504), {{0, 0, 3}});
  EXPECT_EQ(ResultReader(run_of(504)).Stored().size(), 1u);
  fs::create_directories(run_of(505));
  fs::copy(ResultsIn(run_of(504)), run_of(505));
  EXPECT_EQ(Refusal([&] { ResultReader(run_of(505)); }), run_of(505) + why);
  fs::create_directory_symlink(run_of(505), temp / "link");
  EXPECT_EQ(Refusal([&] { ResultReader(temp / "link"); }), temp / "link" + why)
      << "by what the link leads to";
}

}  // namespace
}  // namespace ed3r::store
