// What the tests of store and schedule share: a directory that goes away, a small run, and records that are a
// pure function of the mission's number.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/store/digest.h"
#include "engine/store/finished.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/store.h"

namespace ed3r::store {

class TempDir {
 public:
  TempDir() {
    // In memory where there is such a place: a test opens hundreds of stores, and each syncs the disk.
    const bool shared_memory = access("/dev/shm", W_OK) == 0;
    std::string pattern =
        ((shared_memory ? std::filesystem::path("/dev/shm") : std::filesystem::temp_directory_path()) /
         "ed3r_test_XXXXXX")
            .string();
    path_ = mkdtemp(pattern.data());
  }
  ~TempDir() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string ResultsIn(const std::string& dir) {
  return (std::filesystem::path(dir) / kResultsFile).string();
}

inline Recipe TestRecipe() {
  return {.plan_text = "name: test\nseed: 7\nstage online\n  mission.strategy: rbs\n",
          .code = {{"flight", {"0123abcd"}}, {"training", {"4567"}}},
          .inputs = {{"worlds/ridges.yaml", "fingerprint-1"}},
          .notes = {{"simd", "avx2"}, {"compiler", "gcc 12"}}};
}

// A warm-up of one arm, a training stage without missions, and an online stage of two arms: 40 + 2 x 30
// missions.
inline RunLayout TestLayout() {
  return {.name = "test",
          .seed = 7,
          .stages = {{.name = "warmup", .missions = 40, .arms = {{"warmup", 0}}},
                     {.name = "train", .missions = 0, .arms = {{"train-75", 0}}},
                     {.name = "online", .missions = 30, .arms = {{"rbs", 5000}, {"ed3r-75", 5000}}}}};
}

inline std::vector<sweep::RunId> AllMissions(const RunLayout& layout) {
  std::vector<sweep::RunId> all;
  for (int s = 0; s < static_cast<int>(layout.stages.size()); ++s)
    for (int a = 0; a < static_cast<int>(layout.stages[s].arms.size()); ++a)
      for (int m = 0; m < layout.stages[s].missions; ++m) all.push_back({s, a, m});
  return all;
}

template <class Record>
void FillColumns(Stream& stream, Record& record) {
  Record::Describe(record, [&](std::string_view, auto& field) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, double>)
      field = stream.Normal() * 100;
    else
      field = stream.Below(1000);
  });
}

// The record that mission `id` would leave: every column drawn from a stream of its own.
inline mission::MissionRecord TestRecord(const sweep::RunId& id) {
  Stream stream(static_cast<std::uint64_t>(id.stage),
                static_cast<std::uint32_t>(id.arm * 100000 + id.mission), Purpose::kScenario);
  mission::MissionRecord record;
  FillColumns(stream, record);
  const auto timesteps = stream.Below(8);
  for (std::uint32_t k = 1; k <= timesteps; ++k) {
    FillColumns(stream, record.steps.emplace_back());
    record.steps.back().k = k;
  }
  return record;
}

inline std::string DigestOfDir(const std::string& dir) {
  ResultReader reader(dir);
  return DigestOf(reader);
}

inline void Remember(const std::string& dir, const FinishedRun& run) {
  RememberFinished(dir, LookAtFile(dir), TestRecipe().plan_text, run);
}

// What the UserError says that `action` throws; a test failure when it throws none.
template <class Action>
std::string UserErrorOf(const Action& action) {
  try {
    action();
  } catch (const UserError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no UserError";
  return "";
}

inline ::testing::AssertionResult Contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "\"" << part << "\" is not in \"" << text << "\"";
}

// A store with these missions, all in one group.
inline void WriteStore(const std::string& dir, const std::vector<sweep::RunId>& missions,
                       const Recipe& recipe = TestRecipe()) {
  const auto store = ResultStore::Open(dir, recipe, TestLayout());
  for (const sweep::RunId& id : missions) store->Put(id, TestRecord(id), 0.25);
  store->Commit();
}

}  // namespace ed3r::store
