// What a run directory keeps beside missions: code, networks and files.
#include <sqlite3.h>

#include <fstream>
#include <iterator>

#include "engine/core/sha256.h"
#include "engine/store/restored_files.h"
#include "engine/store/shards/merge.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

void Sql(const std::string& file, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

std::string Bytes(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

std::string HashOf(const std::string& bytes) {
  Sha256 sha;
  sha.Update(bytes);
  return sha.Hex();
}

Recipe WithFlightCode(const std::string& flight) {
  Recipe recipe = TestRecipe();
  recipe.code["flight"] = {flight};
  return recipe;
}

TEST(MixedCodeTest, IsRefusedUnlessAcceptedAndThenRemembered) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  EXPECT_TRUE(
      Contains(UserErrorOf([&] { ResultStore::Open(temp / "run", WithFlightCode("ffff"), TestLayout()); }),
               "the code of flight is 0123abcd there and ffff here; give another --out, or --accept-mixed"));
  EXPECT_FALSE(MixedCode(ResultReader(temp / "run").StoredRecipe().code));
  ResultStore::Open(temp / "run", WithFlightCode("ffff"), TestLayout(), {.other_code = OtherCode::kAccept})
      ->Commit();
  const CodeIdentities code = ResultReader(temp / "run").StoredRecipe().code;
  EXPECT_TRUE(MixedCode(code));
  EXPECT_EQ(CodeText(code), "flight 0123abcd and ffff, training 4567");
  // Either of them goes on now; a third does not.
  EXPECT_NO_THROW(ResultStore::Open(temp / "run", TestRecipe(), TestLayout()));
  EXPECT_NO_THROW(ResultStore::Open(temp / "run", WithFlightCode("ffff"), TestLayout()));
  EXPECT_TRUE(
      Contains(UserErrorOf([&] { ResultStore::Open(temp / "run", WithFlightCode("aaaa"), TestLayout()); }),
               "the code of flight is 0123abcd and ffff there and aaaa here"));
  WriteStore(temp / "pure", {{0, 0, 1}});
  // That both may be together was decided in `run`; of a third nobody has.
  EXPECT_EQ(MergeStores(temp / "new", {temp / "pure", temp / "run"}).added, 2);
  EXPECT_EQ(CodeText(ResultReader(temp / "new").StoredRecipe().code), CodeText(code));
  WriteStore(temp / "third", {{0, 0, 2}}, WithFlightCode("aaaa"));
  EXPECT_TRUE(Contains(
      UserErrorOf([&] {
        MergeStores(temp / "new", {temp / "pure", temp / "third"});
      }),
      "cannot be merged: the code of flight is 0123abcd there and aaaa here; --accept-mixed merges"));
  EXPECT_EQ(MergeStores(temp / "new", {temp / "third"}, OtherCode::kAccept).added, 1);
  EXPECT_EQ(CodeText(ResultReader(temp / "new").StoredRecipe().code),
            "flight 0123abcd and aaaa and ffff, training 4567");
  EXPECT_TRUE(ResultReader(temp / "new").FindDamage().empty());
}

FlownNetworks TwoNetworks() {
  return {.files = {{"aaaa", {"rc, seed 1", std::string("model\0one", 9)}},
                    {"bbbb", {"rc, seed 2", "model two"}}},
          .uses = {{2, 1, 0, "rc", "aaaa"}, {2, 1, 1, "rc", "bbbb"}}};
}

TEST(FlownNetworksTest, ComeBackAndGoThroughAMerge) {
  const TempDir temp;
  WriteStore(temp / "one", {{2, 1, 0}});
  WriteStore(temp / "two", {{2, 1, 1}});
  for (const char* run : {"one", "two"})
    ResultStore::Open(temp / run, TestRecipe(), TestLayout())->PutNetworks(TwoNetworks());
  MergeStores(temp / "both", {temp / "one", temp / "two"});
  for (const char* run : {"one", "both"}) {
    const FlownNetworks networks = ResultReader(temp / run).Networks();
    ASSERT_EQ(networks.files.size(), 2u);
    EXPECT_EQ(networks.files.at("aaaa").model, std::string("model\0one", 9));
    EXPECT_EQ(networks.files.at("bbbb").name, "rc, seed 2");
    ASSERT_EQ(networks.uses.size(), 2u);
    EXPECT_EQ(networks.uses[1].seed, 1);
    EXPECT_EQ(networks.uses[1].sha256, "bbbb");
    EXPECT_EQ(networks.uses[1].arm, 1);
  }
}

TEST(FlownNetworksTest, AnotherNetworkForTheSameArmIsRefused) {
  const TempDir temp;
  WriteStore(temp / "run", {{2, 1, 0}});
  WriteStore(temp / "other", {{2, 1, 1}});
  FlownNetworks other = TwoNetworks();
  other.uses[0].sha256 = "bbbb";
  const auto put = [&](const std::string& run, const FlownNetworks& networks) {
    ResultStore::Open(temp / run, TestRecipe(), TestLayout())->PutNetworks(networks);
  };
  put("run", TwoNetworks());
  put("run", TwoNetworks());  // as every session does
  EXPECT_TRUE(Contains(UserErrorOf([&] { put("run", other); }),
                       "arm ed3r-75 has flown with another rc network (aaaa) than this one (bbbb)"));
  put("other", other);
  EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(temp / "run", {temp / "other"}); }),
                       "has flown with another rc network"));
  EXPECT_EQ(ResultReader(temp / "run").Networks().uses[0].sha256, "aaaa");
}

TEST(FlownNetworksTest, AChangedNetworkIsDamageUntilItIsPutAgain) {
  const TempDir temp;
  WriteStore(temp / "run", {{2, 1, 0}});
  const auto put = [&] {
    ResultStore::Open(temp / "run", TestRecipe(), TestLayout())->PutNetworks(TwoNetworks());
  };
  put();
  Sql(ResultsIn(temp / "run"), "UPDATE networks SET model = x'00' WHERE sha256 = 'bbbb'");
  const std::string damage = "its network 'rc, seed 2' does not match its checksum";
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(temp / "run").Networks(); }), damage));
  EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(temp / "new", {temp / "run"}); }), damage));
  put();
  EXPECT_EQ(ResultReader(temp / "run").Networks().files.at("bbbb").model, "model two");
}

TEST(FlownNetworksTest, AUseWithoutItsNetworkIsDamage) {
  const TempDir temp;
  WriteStore(temp / "run", {{2, 1, 0}});
  ResultStore::Open(temp / "run", TestRecipe(), TestLayout())->PutNetworks(TwoNetworks());
  Sql(ResultsIn(temp / "run"), "DELETE FROM networks WHERE sha256 = 'bbbb'");
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(temp / "run").Networks(); }),
                       "the file is damaged: it does not hold the rc network bbbb"));
}

// Each file matches its checksum: what has changed is whose it is, or its name.
TEST(FlownNetworksTest, NetworksOfEachOthersNamesAreDamageUntilTheyArePutAgain) {
  for (const char* change :
       {"CREATE TEMP TABLE t AS SELECT * FROM networks; "
        "UPDATE networks SET model = (SELECT model FROM t WHERE t.sha256 <> networks.sha256), "
        "checksum = (SELECT checksum FROM t WHERE t.sha256 <> networks.sha256)",
        "UPDATE networks SET name = 'robot, seed 2' WHERE sha256 = 'bbbb'"}) {
    SCOPED_TRACE(change);
    const TempDir temp;
    WriteStore(temp / "run", {{2, 1, 0}});
    ResultStore::Open(temp / "run", TestRecipe(), TestLayout())->PutNetworks(TwoNetworks());
    Sql(ResultsIn(temp / "run"), change);
    const std::string damage =
        "the names of its networks, or which file is whose, do not match their checksum";
    EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(temp / "run").Networks(); }), damage));
    EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(temp / "new", {temp / "run"}); }), damage));
    // Somebody else's networks do not make these valid, nor none.
    WriteStore(temp / "other", {{2, 1, 1}});
    MergeStores(temp / "run", {temp / "other"});
    EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(temp / "run").Networks(); }), damage));
    FlownNetworks one = TwoNetworks();
    one.files.erase("bbbb");
    one.uses.pop_back();
    ResultStore::Open(temp / "run", TestRecipe(), TestLayout())->PutNetworks(one);
    EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(temp / "run").Networks(); }), damage));
    ResultStore::Open(temp / "run", TestRecipe(), TestLayout())->PutNetworks(TwoNetworks());
    EXPECT_EQ(ResultReader(temp / "run").Networks().files.at("bbbb").name, "rc, seed 2");
    EXPECT_EQ(ResultReader(temp / "run").Networks().files.at("bbbb").model, "model two");
  }
}

// Each is a network that is stored and whole: what has changed is whose it is.
TEST(FlownNetworksTest, ANetworkOfAnotherArmOrSeedIsDamage) {
  for (const char* change :
       {"UPDATE flown_networks SET sha256 = CASE sha256 WHEN 'aaaa' THEN 'bbbb' ELSE 'aaaa' END",
        "UPDATE flown_networks SET run = 2", "DELETE FROM flown_networks WHERE seed = 1",
        "DELETE FROM recipe WHERE key = 'networks'"}) {
    SCOPED_TRACE(change);
    const TempDir temp;
    WriteStore(temp / "run", {{2, 1, 0}});
    ResultStore::Open(temp / "run", TestRecipe(), TestLayout())->PutNetworks(TwoNetworks());
    Sql(ResultsIn(temp / "run"), change);
    EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(temp / "run").Networks(); }), "the file is damaged"));
    EXPECT_TRUE(Contains(UserErrorOf([&] { ResultStore::Open(temp / "run", TestRecipe(), TestLayout()); }),
                         "the file is damaged"));
  }
}

Recipe WithFiles(bool grid_kept) {
  Recipe recipe = TestRecipe();
  const std::string world = "terrain: {file: data/grid.asc}\n", grid = "ncols 2\n";
  recipe.places = {{"../worlds/a.yaml", "a.yaml"}};
  recipe.files = {{"a.yaml", HashOf(world), world}, {"data/grid.asc", HashOf(grid), std::nullopt}};
  if (grid_kept) recipe.files[1].content = grid;
  return recipe;
}

TEST(RestoredFilesTest, LieAsTheyLayAndGoAwayAgain) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}}, WithFiles(true));
  MergeStores(temp / "merged", {temp / "run"});
  for (const char* run : {"run", "merged"}) {
    std::string world;
    {
      ResultReader reader(temp / run);
      const RestoredFiles files(reader);
      world = files.PathOf("../worlds/a.yaml");
      EXPECT_EQ(Bytes(world), "terrain: {file: data/grid.asc}\n");
      EXPECT_EQ(Bytes((fs::path(world).parent_path() / "data/grid.asc").string()), "ncols 2\n");
      EXPECT_TRUE(Contains(UserErrorOf([&] { files.PathOf("b.yaml"); }), "does not keep the file 'b.yaml'"));
    }
    EXPECT_FALSE(fs::exists(fs::path(world).parent_path()));
  }
}

TEST(RestoredFilesTest, AFileThatWasTooLargeIsNamed) {
  const TempDir temp;
  Recipe recipe = WithFiles(false);
  recipe.notes["sweep file"] = temp / "sweeps/x.yaml";
  WriteStore(temp / "run", {{0, 0, 0}}, recipe);
  ResultReader reader(temp / "run");
  const RestoredFiles files(reader);
  EXPECT_TRUE(Contains(UserErrorOf([&] { files.PathOf("../worlds/a.yaml"); }),
                       "'data/grid.asc' was too large to be kept with the run"));
  // Whoever still has the sources may fly it again.
  fs::create_directories(temp / "worlds");
  std::ofstream(temp / "worlds/a.yaml") << "as it was";
  EXPECT_EQ(files.PathOf("../worlds/a.yaml"), temp / "worlds/a.yaml");
}

TEST(RestoredFilesTest, AChangedCopyIsDamageAndANameLeadsNowhereElse) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}}, WithFiles(true));
  Sql(ResultsIn(temp / "run"), "UPDATE files SET content = x'00' WHERE name = 'a.yaml'");
  ResultReader reader(temp / "run");
  EXPECT_TRUE(Contains(UserErrorOf([&] { RestoredFiles files(reader); }),
                       "its copy of a.yaml does not match its checksum"));
  Recipe outside = WithFiles(true);
  outside.files[0].name = "../a.yaml";
  WriteStore(temp / "outside", {{0, 0, 0}}, outside);
  ResultReader other(temp / "outside");
  EXPECT_TRUE(
      Contains(UserErrorOf([&] { RestoredFiles files(other); }), "it keeps a file called '../a.yaml'"));
}

}  // namespace
}  // namespace ed3r::store
