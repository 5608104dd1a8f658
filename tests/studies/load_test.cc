#include "studies/report/load.h"

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <thread>

#include "tests/store/store_fixture.h"
#include "tests/studies/five_missions.h"

namespace ed3r {
namespace {

store::RunLayout Layout() {
  return {.name = "baselines",
          .seed = 7,
          .stages = {{.name = "warmup", .missions = 2, .arms = {{"warmup", 0}}},
                     {.name = "train", .missions = 0, .arms = {{"train-75", 0}}},
                     {.name = "online", .missions = 8, .arms = {{"rbs", 5000}, {"ed3r-75", 5000}}}}};
}

mission::MissionRecord Mission(int number) {
  mission::MissionRecord mission = FiveMissions().missions[static_cast<std::size_t>(number)];
  mission.scenario = 5000 + number;
  for (int k = 1; k <= 3; ++k) mission.steps.emplace_back().k = k;
  return mission;
}

// All five missions of ed3r-75, one that failed, two that are missing; nothing of the other arms.
void WriteRun(const std::string& dir) {
  const auto store = store::ResultStore::Open(dir, store::TestRecipe(), Layout());
  for (const int number : {3, 1, 4, 0, 2}) store->Put({2, 1, number}, Mission(number), 0.5);
  store->PutFailure({2, 1, 6}, {"exception", "a broken invariant"});
  store->Commit();
}

report::RunResults LoadRunIn(const std::string& dir) {
  store::ResultReader reader(dir);
  return report::LoadRun(reader);
}

TEST(LoadRunTest, GivesFlyingArmsInPlanOrder) {
  const store::TempDir temp;
  WriteRun(temp / "run");
  const report::RunResults run = LoadRunIn(temp / "run");
  EXPECT_EQ(run.name, "baselines");
  ASSERT_EQ(run.arms.size(), 3u);
  EXPECT_EQ(run.arms[0].stage, "warmup");
  EXPECT_EQ(run.arms[0].missing, 2);
  EXPECT_EQ(run.arms[1].name, "rbs");
  EXPECT_EQ(run.arms[1].missing, 8);
  const metrics::ArmData& arm = run.arms[2];
  EXPECT_EQ(arm.stage, "online");
  EXPECT_EQ(arm.name, "ed3r-75");
  EXPECT_EQ(arm.failed, 1);
  EXPECT_EQ(arm.missing, 2);
  ASSERT_EQ(arm.missions.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(arm.missions[i].scenario, 5000 + i);
    EXPECT_TRUE(arm.missions[i].steps.empty());
  }
}

// Missions that a run with a precision lacks between others are missing, however well the rest is known.
TEST(LoadRunTest, AGapOfARunWithAPrecisionIsMissing) {
  sweep::SweepPlan plan{.name = "p", .question = "", .file = "", .seed = 7, .stages = {sweep::Stage()}};
  plan.stages[0].name = "online";
  plan.stages[0].missions = 200;
  plan.stages[0].precision = sweep::Precision{.metric = "total_energy_kj", .half_width = 1e9, .every = 2};
  plan.stages[0].arms.emplace_back().name = "rbs";
  store::Recipe recipe = store::TestRecipe();
  recipe.plan_text = plan.CanonicalText();
  const auto missing = [&](const std::vector<int>& numbers) {
    const store::TempDir temp;
    {
      const auto store = store::ResultStore::Open(temp / "run", recipe, store::LayoutOf(plan));
      for (const int number : numbers) store->Put({0, 0, number}, Mission(number), 0.5);
      store->Commit();
    }
    return LoadRunIn(temp / "run").arms[0].missing;
  };
  EXPECT_EQ(missing({0, 1, 2, 3}), 0);
  EXPECT_EQ(missing({0, 4}), 3);
}

// A run that goes on while it is read: numbers, counts and digest are of one moment.
TEST(LoadWholeTest, AllIsOfOneMoment) {
  const store::TempDir temp;
  store::RunLayout layout = Layout();
  layout.stages[2].missions = 150;
  std::map<std::int64_t, std::string> digests;  // by missions
  std::atomic<bool> ended = false;
  const auto put = [&](store::ResultStore& store, int number) {
    mission::MissionRecord mission = Mission(number % 5);
    mission.scenario = 5000 + number;
    store.Put({2, 1, number}, mission, 0.5);
    store.Commit();
  };
  {
    const auto store = store::ResultStore::Open(temp / "before", store::TestRecipe(), layout);
    for (int number = 0; number < 150; ++number) {
      put(*store, number);
      digests[number + 1] = store::DigestOfDir(temp / "before");
    }
  }
  const auto store = store::ResultStore::Open(temp / "run", store::TestRecipe(), layout);
  put(*store, 0);
  std::thread writer([&] {
    for (int number = 1; number < 150; ++number) put(*store, number);
    ended = true;
  });
  int looks = 0;
  for (; !ended || looks == 0; ++looks) {
    store::ResultReader reader(temp / "run");
    const report::WholeRun whole = report::LoadWhole(reader, "called");
    const auto missions = static_cast<std::int64_t>(whole.results.arms[2].missions.size());
    EXPECT_EQ(whole.provenance.stored, missions);
    EXPECT_EQ(whole.results.arms[2].missing, 150 - missions);
    EXPECT_EQ(whole.provenance.digest, digests.at(missions));
    EXPECT_EQ(whole.provenance.dir, "called");
  }
  writer.join();
  store::ResultReader reader(temp / "run");
  const report::WholeRun whole = report::LoadWhole(reader, "called");
  const report::RunResults again = LoadRunIn(temp / "run");
  ASSERT_EQ(whole.results.arms[2].missions.size(), again.arms[2].missions.size());
  EXPECT_TRUE(whole.results.arms[2].missions[7].steps.empty());
}

TEST(LoadRunTest, ReportOfAStoreIsTheReportOfItsMissions) {
  const store::TempDir temp;
  WriteRun(temp / "run");
  const report::Report report = report::MakeReport(LoadRunIn(temp / "run"), {});
  const metrics::ArmMetrics direct = metrics::ComputeMetrics(FiveMissions());
  for (const char* metric : {"total_energy_kj", "mscs_pct", "wer_pct", "or_pct", "lf_accuracy_pct"}) {
    EXPECT_EQ(report.arms[2][metric].value, direct[metric].value) << metric;
    EXPECT_EQ(report.arms[2][metric].hi, direct[metric].hi) << metric;
  }
  EXPECT_EQ(report::ReportJson(report).at("arms").at("rbs").at("missing"), 8);
}

TEST(LoadRunTest, NoStoreIsAUserError) {
  const store::TempDir temp;
  EXPECT_TRUE(store::Contains(store::UserErrorOf([&] { LoadRunIn(temp / "nowhere"); }), "nowhere"));
}

}  // namespace
}  // namespace ed3r
