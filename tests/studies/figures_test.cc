#include <gtest/gtest.h>

#include <set>

#include "studies/figures/figure_data.h"
#include "studies/figures/mission_columns.h"
#include "studies/tables/result_table.h"
#include "tests/studies/five_missions.h"

namespace ed3r {
namespace {

metrics::ArmData Arm(const std::string& name, const std::string& stage = "online") {
  metrics::ArmData arm = FiveMissions();
  arm.stage = stage, arm.name = name;
  return arm;
}

figures::ArmPlan Plan(const std::string& stage, const std::string& name, const std::string& strategy,
                      bool warmup = false) {
  return {stage, name, warmup, {{"mission.strategy", strategy}, {"agents.eta_min", "0.75"}}};
}

std::vector<std::string> Ids(const std::vector<figures::FigureSpec>& figures) {
  std::vector<std::string> ids;
  for (const figures::FigureSpec& figure : figures) ids.push_back(figure.id);
  return ids;
}

nlohmann::ordered_json DataOf(const std::vector<metrics::ArmData>& arms,
                              const std::vector<figures::ArmPlan>& plans,
                              const std::vector<figures::ShownMission>& missions = {},
                              std::shared_ptr<const world::Scene> scene = {}) {
  std::vector<metrics::ArmMetrics> metrics;
  for (const metrics::ArmData& arm : arms) metrics.push_back(metrics::ComputeMetrics(arm));
  return figures::MakeFigureData({.name = "test",
                                  .arms = arms,
                                  .metrics = metrics,
                                  .plans = plans,
                                  .missions = missions,
                                  .scene = std::move(scene),
                                  .scene_note = "because"});
}

TEST(ArmPlanTest, IsReadFromThePlanText) {
  const auto plans = figures::ReadArmPlans(
      "sweep=s\nseed=1\nstage=a\nkind=fly\nafter=\nmissions=2\narm=x=1\nmission.strategy=random\n"
      "stage=t\nkind=train\nafter=a\nmissions=0\narm=t\nmission.strategy=random\n"
      "stage=b\nkind=fly\nafter=t\nmissions=3\narm=y\nmission.strategy=ed3r\nagents.eta_min=0.65\n");
  ASSERT_EQ(plans.size(), 3u);
  EXPECT_EQ(plans[0].name, "x=1");
  EXPECT_TRUE(plans[0].warmup);
  EXPECT_FALSE(plans[2].warmup);
  EXPECT_EQ(plans[2].stage, "b");
  EXPECT_EQ(plans[2].Setting("agents.eta_min"), "0.65");
  EXPECT_EQ(plans[2].Setting("no.such"), "");
  EXPECT_TRUE(figures::ReadArmPlans("").empty());
}

TEST(FigureListTest, ThePapersArmsComeInItsGroups) {
  const std::vector<metrics::ArmData> arms = {Arm("warmup", "warmup"), Arm("warmup-ecd2r", "warmup"),
                                              Arm("ed3r-65"),          Arm("ed3r-75"),
                                              Arm("ablation-1"),       Arm("ecd2r")};
  const std::vector<figures::ArmPlan> plans = {
      Plan("warmup", "warmup", "random", true),   Plan("warmup", "warmup-ecd2r", "random-offload", true),
      Plan("online", "ed3r-65", "ed3r"),          Plan("online", "ed3r-75", "ed3r"),
      Plan("online", "ablation-1", "ablation-1"), Plan("online", "ecd2r", "ecd2r")};
  const auto figures = figures::ListFigures(arms, plans, 0);
  EXPECT_EQ(Ids(figures),
            (std::vector<std::string>{"overview-thresholds", "insights-thresholds", "decisions-thresholds",
                                      "overview-ablations", "insights-ablations", "decisions-ablations",
                                      "overview-baselines", "insights-baselines", "decisions-baselines",
                                      "pareto", "sites"}));
  EXPECT_EQ(figures[0].warmups, std::vector<std::size_t>{0});
  EXPECT_EQ(figures[6].warmups, (std::vector<std::size_t>{0, 1}));  // ECD2R learnt from one of its own
  EXPECT_EQ(figures[9].arms, (std::vector<std::size_t>{2, 3, 4, 5}));
}

TEST(FigureListTest, OneArmHasNoPareto) {
  const std::vector<metrics::ArmData> arms = {Arm("rbs")};
  EXPECT_EQ(
      Ids(figures::ListFigures(arms, {}, 2)),
      (std::vector<std::string>{"overview-arms-1", "insights-arms-1", "decisions-arms-1", "sites", "map"}));
}

TEST(FigureListTest, AWarmupAloneIsDrawnAndEmptyArmsAreNot) {
  metrics::ArmData empty = Arm("ed3r-75");
  empty.missions.clear();
  const std::vector<figures::ArmPlan> plans = {Plan("warmup", "warmup", "random", true),
                                               Plan("online", "ed3r-75", "ed3r")};
  const auto figures = figures::ListFigures(std::vector{Arm("warmup", "warmup"), empty}, plans, 0);
  ASSERT_FALSE(figures.empty());
  for (const figures::FigureSpec& figure : figures)
    EXPECT_EQ(figure.arms, std::vector<std::size_t>{0}) << figure.id;
  EXPECT_TRUE(figures[0].warmups.empty());
  EXPECT_TRUE(figures::ListFigures(std::vector{empty}, plans, 0).empty());
}

TEST(FigureListTest, ManyArmsAreSplitAndLimited) {
  std::vector<metrics::ArmData> arms;
  for (int i = 0; i < 60; ++i) arms.push_back(Arm("mass=" + std::to_string(i)));
  std::size_t overviews = 0, drawn = 0;
  for (const figures::FigureSpec& figure : figures::ListFigures(arms, {}, 0)) {
    if (figure.kind != "overview") continue;
    ++overviews, drawn += figure.arms.size();
    EXPECT_LE(figure.arms.size(), figures::kGroupArms);
  }
  EXPECT_EQ(overviews, figures::kMostGroups);
  EXPECT_EQ(drawn, figures::kMostGroups * figures::kGroupArms);
}

TEST(FigureDataTest, EveryMissionHasEveryColumn) {
  const auto data = DataOf({Arm("ed3r-75"), Arm("mine")}, {Plan("online", "ed3r-75", "ed3r")});
  const auto& arm = data.at("arms").at(0);
  EXPECT_EQ(arm.at("eta_min_pct"), 75);
  EXPECT_EQ(arm.at("strategy"), "ed3r");
  EXPECT_TRUE(data.at("arms").at(1).at("strategy").is_null());
  EXPECT_EQ(arm.at("metrics").size(), metrics::MetricDefinitions().size());
  EXPECT_EQ(arm.at("metrics").at("msr_pct").at("paper"), 97.18);
  std::set<std::string> columns, units;
  for (const auto& [name, values] : arm.at("per_mission").items()) {
    columns.insert(name);
    EXPECT_EQ(values.size(), 5u) << name;
  }
  for (const auto& [name, unit] : data.at("units").items()) units.insert(name);
  EXPECT_EQ(columns, units);
  const auto& missions = arm.at("per_mission");
  EXPECT_EQ(missions.at("energy_kj").at(0), 7.6);
  EXPECT_EQ(missions.at("duration_min").at(3), 18);
  EXPECT_EQ(missions.at("outcome").dump(), "[0,0,1,2,0]");
  EXPECT_EQ(missions.at("scs_pct").at(1), 80);
  EXPECT_TRUE(missions.at("scs_pct").at(3).is_null());          // no reliable timestep
  EXPECT_EQ(missions.at("lf_accuracy_pct").at(0), 75);          // 1 - 0.2 / 0.8
  EXPECT_EQ(missions.at("lf_accuracy_pct").at(3), 0);           // the worst
  EXPECT_TRUE(missions.at("lf_accuracy_pct").at(4).is_null());  // nothing predicted
}

TEST(FigureDataTest, FiguresNameArmsThatAreThere) {
  const auto data = DataOf({Arm("rbs", "one"), Arm("rbs", "two"), Arm("ecd2r", "two")}, {});
  std::set<std::string> keys;
  for (const auto& arm : data.at("arms")) keys.insert(arm.at("key"));
  EXPECT_EQ(keys, (std::set<std::string>{"one/rbs", "two/rbs", "ecd2r"}));
  for (const auto& figure : data.at("figures"))
    for (const auto& key : figure.at("arms")) EXPECT_TRUE(keys.contains(key)) << key;
}

TEST(FigureDataTest, SitesAddUpToTheirPools) {
  metrics::ArmData arm = Arm("rbs");
  arm.missions[1].site = 3, arm.missions[3].site = 3, arm.missions[4].site = 5;
  const auto sites = figures::SiteSuccess(arm);
  ASSERT_EQ(sites.size(), 3u);
  EXPECT_EQ(sites[1].at("site"), 3);
  EXPECT_EQ(sites[1].at("missions"), 2);
  EXPECT_EQ(sites[1].at("success_pct"), 50);
  EXPECT_EQ(sites[1].at("depleted_pct"), 50);
  EXPECT_EQ(figures::PooledSuccess(arm, true).at("missions"), 2);
  EXPECT_EQ(figures::PooledSuccess(arm, false).at("missions"), 3);
  for (mission::MissionRecord& mission : arm.missions) mission.site_known = 1;
  EXPECT_TRUE(figures::PooledSuccess(arm, false).is_null());
}

// With the luck of training: two networks that disagree make intervals wider than missions alone do.
TEST(FigureDataTest, PoolsAreTheReportsGeneralisation) {
  metrics::ArmData arm = Arm("ed3r-75");
  const mission::MissionRecord success = arm.missions[0], depleted = arm.missions[3];
  arm.missions.clear();
  for (int i = 0; i < 40; ++i) {
    arm.missions.push_back(i % 4 == 3 || (i % 4 == 1 && i < 20) ? depleted : success);
    arm.missions.back().site_known = i % 8 < 4;
    arm.missions.back().network = i % 2;
  }
  const tables::Generalisation expected = tables::ComputeGeneralisation(arm);
  for (const bool known : {true, false}) {
    const auto pooled = figures::PooledSuccess(arm, known);
    const metrics::ArmMetrics& metrics = known ? expected.known_sites : expected.unseen_sites;
    EXPECT_EQ(pooled.at("missions"), metrics.missions);
    EXPECT_EQ(pooled.at("success_pct"), figures::Rounded(metrics["msr_pct"].value));
    EXPECT_EQ(pooled.at("lo"), figures::Rounded(metrics["msr_pct"].lo));
    EXPECT_EQ(pooled.at("hi"), figures::Rounded(metrics["msr_pct"].hi));
    EXPECT_EQ(pooled.at("depleted_pct"), figures::Rounded(metrics["bd_pct"].value));
    metrics::ArmData alone = known ? metrics::Split(arm, metrics::SplitBy::kSite).known
                                   : metrics::Split(arm, metrics::SplitBy::kSite).unseen;
    for (mission::MissionRecord& mission : alone.missions) mission.network = 0;
    EXPECT_LT(pooled.at("lo").get<double>(), metrics::ComputeMetrics(alone)["msr_pct"].lo);
  }
}

TEST(FigureDataTest, ConvergenceIsOfItsArm) {
  const std::vector<claims::ConvergencePoint> points = {{"online", "rbs", "msr_pct", 50, 0, 70, 12.5, 12.5},
                                                        {"online", "ecd2r", "msr_pct", 50, 0, 70, 9, 9},
                                                        {"online", "rbs", "msr_pct", 100, 2, 70, 11, 8.25}};
  EXPECT_EQ(figures::ConvergenceJson(Arm("rbs"), points).dump(),
            R"({"msr_pct":{"missions":[50,100],"half_width":[12.5,11],"half_width_missions":[12.5,8.25]}})");
  EXPECT_TRUE(figures::ConvergenceJson(Arm("mine"), points).empty());
}

TEST(FigureListTest, ConvergenceNeedsMissions) {
  metrics::ArmData arm = Arm("rbs");
  while (arm.missions.size() < figures::kConvergenceStart) arm.missions.push_back(arm.missions[0]);
  EXPECT_EQ(Ids(figures::ListFigures(std::vector{arm}, {}, 0)).back(), "convergence");
  arm.missions.pop_back();
  EXPECT_EQ(Ids(figures::ListFigures(std::vector{arm}, {}, 0)).back(), "sites");
}

TEST(FigureDataTest, ShownMissionsCarryTheirPathAndWorld) {
  figures::ShownMission shown{
      .stage = "online", .arm = "rbs", .number = 4, .record = FiveMissions().missions[0]};
  shown.record.start_x_m = 1.26;
  shown.record.steps.resize(2);
  shown.record.steps[1].x_m = 7, shown.record.steps[1].scs = 0.914;
  world::Scene::Parts parts;
  parts.name = "flat", parts.size_m = {40, 20, 50};
  parts.terrain = {.columns = 5, .rows = 3, .cell_m = 10, .height_m = std::vector<float>(15, 2.0F)};
  parts.sites = {{"here", {5, 6, 2}, true}};
  const auto data = DataOf({Arm("rbs")}, {}, {shown}, std::make_shared<world::Scene>(std::move(parts)));
  const auto& mission = data.at("missions_shown").at(0);
  EXPECT_EQ(mission.at("x_m").dump(), "[1.3,0,7]");
  EXPECT_EQ(mission.at("scs_pct").dump(), "[null,0,91.4]");
  EXPECT_EQ(mission.at("outcome"), "success");
  EXPECT_EQ(data.at("world").at("height_m").size(), 3u);
  EXPECT_EQ(data.at("world").at("height_m").at(0).size(), 5u);
  EXPECT_EQ(data.at("world").at("sites").at(0).at("name"), "here");
  EXPECT_TRUE(DataOf({Arm("rbs")}, {}, {shown}).at("world").is_null());
}

TEST(RoundedTest, KeepsWhatAFigureCanShow) {
  EXPECT_EQ(figures::Rounded(1.0 / 3).dump(), "0.3333");
  EXPECT_EQ(figures::Rounded(-2.00001).dump(), "-2");
  EXPECT_TRUE(figures::Rounded(std::numeric_limits<double>::quiet_NaN()).is_null());
}

TEST(FigureDataTest, VariantsHaveAFigureOfTheirOwn) {
  std::vector<metrics::ArmData> both = variants::AsVariant({Arm("rbs")}, "base");
  both.push_back(variants::AsVariant({Arm("rbs")}, "heavy").front());
  for (metrics::ArmData& arm : both)
    for (std::size_t i = 0; i < arm.missions.size(); ++i)
      arm.missions[i].scenario = static_cast<std::int64_t>(i);
  for (mission::MissionRecord& mission : both[1].missions)
    mission.total_j += 2000, mission.movement_j += 2000;
  const variants::VariantStudy study = variants::CompareVariants(both, variants::Verdicts::kJudged);
  const std::vector<metrics::ArmData> arms = {Arm("rbs")};
  const std::vector<metrics::ArmMetrics> metrics = {metrics::ComputeMetrics(arms[0])};
  figures::FigureInputs inputs;
  inputs.name = "test", inputs.arms = arms, inputs.metrics = metrics, inputs.variants = &study;
  const auto data = figures::MakeFigureData(inputs);
  EXPECT_EQ(data.at("figures").back().at("id"), "variants");
  EXPECT_EQ(data.at("variants").at("base"), "base");
  EXPECT_EQ(data.at("variants").at("names"), (nlohmann::ordered_json{"heavy"}));
  const auto& energy = data.at("variants").at("differences").at(0);
  EXPECT_EQ(energy.at("metric"), "total_energy_kj");
  EXPECT_EQ(energy.at("difference"), 2);
  EXPECT_EQ(energy.at("certain"), true);
  EXPECT_TRUE(DataOf({Arm("rbs")}, {}).at("variants").is_null());
}

}  // namespace
}  // namespace ed3r
