// What counts as the paper's study, and what is named as another.
#include "studies/report/departures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "engine/config/parameters.h"
#include "engine/core/files/file.h"
#include "engine/core/sha256.h"
#include "engine/sweep/sweep_file.h"
#include "engine/world/world_file.h"
#include "studies/paper/arms.h"
#include "studies/paper/world.h"
#include "studies/report/report.h"
#include "tests/claims/synthetic_run.h"

namespace ed3r {
namespace {

const std::set<std::string> kPaperWorld = {"worlds/paper.yaml"};

std::string PlanOfSweep(const std::string& name) {
  return sweep::LoadSweep(fmt::format("{}/sweeps/{}.yaml", ED3R_SOURCE_DIR, name), {}).CanonicalText();
}

report::Departures Of(const std::string& plan, const std::string& variant = "") {
  return report::DeparturesOf(plan, variant, kPaperWorld);
}

// `text` with the first line that begins with "KEY=" after `after` replaced.
std::string With(std::string text, const std::string& after, const std::string& key,
                 const std::string& value) {
  const std::size_t from = text.find('\n' + after), line = text.find('\n' + key + '=', from) + 1;
  return text.replace(line, text.find('\n', line) - line, key + '=' + value);
}

TEST(DeparturesTest, SweepsOfThePaperFlyThePaper) {
  for (const char* sweep : {"paper", "default_world", "smoke", "thresholds", "ablations", "baselines", "rbs",
                            "warmup", "look_level"}) {
    const report::Departures found = Of(PlanOfSweep(sweep));
    EXPECT_TRUE(found.PaperFlown()) << sweep << ": " << report::DepartureText(found.results);
    EXPECT_TRUE(found.aside.empty()) << sweep << ": " << report::DepartureText(found.aside);
  }
  EXPECT_TRUE(Of(PlanOfSweep("paper")).effort.empty());
  EXPECT_EQ(report::DepartureText(Of(PlanOfSweep("smoke")).effort),
            "60 missions of warmup (paper 2040); 56 missions of online (paper 850); learning rate 0.0001 "
            "(paper 5e-06); training epochs 40 (paper 2000)");
}

TEST(DeparturesTest, ThePaperHasNoStepOfThePhysics) {
  const report::Departures found = Of(With(PlanOfSweep("paper"), "arm=ed3r-75", "mission.physics_hz", "240"));
  EXPECT_TRUE(found.PaperFlown());
  EXPECT_TRUE(found.effort.empty());
}

bool OfPixels(const std::string& key) {
  return key.starts_with("perception.render.") || key.starts_with("perception.detector.");
}

// A run of before the detectors changed is still the paper's where it looked at no pixels.
TEST(DeparturesTest, WhatLooksAtFramesMattersWhereThereAreSome) {
  const std::string profile = With(PlanOfSweep("paper"), "arm=ed3r-75", "perception.render.width_px", "96");
  EXPECT_TRUE(Of(profile).PaperFlown());
  const report::Departures found = Of(With(profile, "arm=ed3r-75", "perception.tier", "pixels"));
  EXPECT_EQ(found.results.size(), 2u) << report::DepartureText(found.results);
}

TEST(DeparturesTest, EveryParameterThatIsNotEffortDoes) {
  const std::string paper = PlanOfSweep("paper");
  for (const ParameterInfo& parameter : Parameters()) {
    if (parameter.scope != Scope::kMission || parameter.key == "mission.physics_hz" ||
        OfPixels(parameter.key))
      continue;
    const report::Departures found = Of(With(paper, "arm=ed3r-75", parameter.key, "another"));
    const bool effort = parameter.key.starts_with("training.") || parameter.key == "mission.first_scenario";
    const std::vector<report::Departure>& list = effort ? found.effort : found.results;
    EXPECT_EQ(found.results.size() + found.aside.size() + found.effort.size(), 1u) << parameter.key;
    ASSERT_EQ(list.size(), 1u) << parameter.key;
    EXPECT_EQ(list[0].key, parameter.key);
    EXPECT_EQ(list[0].values, std::vector<std::string>{"another"});
    EXPECT_EQ(list[0].arms, std::vector<std::string>{"ed3r-75"});
  }
}

TEST(DeparturesTest, TheNameOfAnArmPromisesItsStrategyThresholdAndSites) {
  const std::string paper = PlanOfSweep("paper");
  EXPECT_EQ(report::DepartureText(Of(With(paper, "arm=ed3r-85", "agents.eta_min", "0.75")).results),
            "agents.eta_min 0.75 (paper 0.85) in ed3r-85");
  EXPECT_EQ(report::DepartureText(Of(With(paper, "arm=rbs", "mission.strategy", "look-level")).results),
            "mission.strategy look-level (paper rbs) in rbs");
  EXPECT_EQ(report::DepartureText(Of(With(paper, "arm=rbs", "mission.sites", "known")).results),
            "mission.sites known (paper all) in rbs");
  EXPECT_EQ(report::DepartureText(Of(With(paper, "arm=warmup", "mission.sites", "all")).results),
            "mission.sites all (paper known) in warmup");
}

TEST(DeparturesTest, AnArmOfOnesOwnKeepsNothingFromBeingJudged) {
  std::string plan = PlanOfSweep("look_level");
  plan = With(plan, "arm=look-level", "robot.mass_kg", "2.4");
  const report::Departures found = Of(plan);
  EXPECT_TRUE(found.PaperFlown());
  EXPECT_EQ(report::DepartureText(found.aside), "robot.mass_kg 2.4 (paper 1.816)");
}

TEST(DeparturesTest, AWarmUpOfAnotherNameIsWhatNetworksLearnFrom) {
  std::string plan = With(PlanOfSweep("paper"), "arm=warmup", "robot.mass_kg", "2.4");
  plan.replace(plan.find("arm=warmup\n"), 10, "arm=mine");
  EXPECT_EQ(report::DepartureText(Of(plan).results), "robot.mass_kg 2.4 (paper 1.816) in mine");
}

TEST(DeparturesTest, AWorldIsWhatIsInItsFiles) {
  const std::string paper = PlanOfSweep("rbs");
  EXPECT_EQ(report::DepartureText(report::DeparturesOf(paper, "", {}).results),
            "mission.world worlds/paper.yaml of other content (paper worlds/paper.yaml)");
  const std::string elsewhere = With(paper, "arm=rbs", "mission.world", "../copy.yaml");
  EXPECT_EQ(report::DepartureText(Of(elsewhere).results),
            "mission.world ../copy.yaml (paper worlds/paper.yaml)");
  EXPECT_TRUE(report::DeparturesOf(elsewhere, "", {"../copy.yaml"}).PaperFlown());
}

TEST(DeparturesTest, ThePaperWorldIsAllThatItsFileReads) {
  const std::string folder = std::string(ED3R_SOURCE_DIR) + "/sweeps/worlds/";
  const world::WorldSpec spec = world::ReadWorldFile(folder + "paper.yaml");
  std::vector<std::string> read = {folder + "paper.yaml"};
  read.insert(read.end(), spec.bases.begin(), spec.bases.end());
  EXPECT_FALSE(spec.grid) << "then it belongs to the list, too";
  EXPECT_FALSE(spec.forest && spec.forest->stem_map);
  ASSERT_EQ(read.size(), paper::PaperWorldFiles().size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(std::filesystem::path(read[i]).filename(), paper::PaperWorldFiles()[i].name);
    Sha256 sha;
    sha.Update(ReadFile(read[i], kMaxTextBytes));
    EXPECT_EQ(sha.Hex(), paper::PaperWorldFiles()[i].sha256);
  }
}

TEST(DeparturesTest, EachVariantIsComparedByItself) {
  const std::string plan = PlanOfSweep("sensitivity");
  EXPECT_TRUE(Of(plan, "base").PaperFlown());
  EXPECT_TRUE(Of(plan, "other-networks").PaperFlown());
  EXPECT_EQ(report::DepartureText(Of(plan, "R8-battery-4S").results), "robot.battery_v 14.8 (paper 11.1)");
  EXPECT_EQ(report::DepartureText(Of(PlanOfSweep("tiers"), "pixels").results),
            "perception.tier pixels (paper profile)");
  EXPECT_FALSE(Of(PlanOfSweep("matched"), "m01").PaperFlown());
  EXPECT_TRUE(Of(PlanOfSweep("matched"), "paper").PaperFlown());
}

report::RunDepartures Heavy() {
  return {{"", Of(With(PlanOfSweep("rbs"), "arm=rbs", "robot.mass_kg", "2.4"))}};
}

TEST(DeparturesTest, AReportThatDepartsHasNoVerdictsUnlessTheyAreAskedFor) {
  const report::RunResults run{.name = "mine", .arms = {claims::MakeArm({"rbs", 34})}};
  const report::Report judged = report::MakeReport(run, {}), left_out = report::MakeReport(run, Heavy());
  const report::Report asked = report::MakeReport(run, Heavy(), report::Judging::kEverything);
  ASSERT_TRUE(judged.claims.HasArms());
  EXPECT_EQ(report::ReportText(judged).find("Not as in the paper"), std::string::npos);
  EXPECT_TRUE(report::ReportJson(judged).at("paper").at("paper_flown"));
  EXPECT_FALSE(report::ReportJson(judged).at("claims").empty());

  EXPECT_FALSE(left_out.claims.HasArms());
  EXPECT_NE(report::ReportText(left_out).find(
                "\nNot as in the paper: robot.mass_kg 2.4 (paper 1.816). So its claims are not "
                "judged; 'ed3r report DIR"),
            std::string::npos)
      << report::ReportText(left_out).substr(0, 400);
  EXPECT_TRUE(report::ReportJson(left_out).at("claims").empty());
  EXPECT_FALSE(report::ReportJson(left_out).at("paper").at("claims_judged"));
  EXPECT_EQ(report::ReportJson(left_out).at("paper").at("results").at(0).at("parameter"), "robot.mass_kg");
  EXPECT_EQ(report::ReportJson(left_out).at("arms"), report::ReportJson(judged).at("arms"));

  EXPECT_EQ(report::ReportJson(asked).at("claims"), report::ReportJson(judged).at("claims"));
  EXPECT_NE(report::ReportText(asked).find("judged all the same (--claims)"), std::string::npos);
}

TEST(DeparturesTest, OfVariantsTheOneThatIsThePapersIsJudgedAlone) {
  const report::RunResults run{
      .name = "mine", .arms = {claims::MakeArm({"rbs@base", 34}), claims::MakeArm({"rbs@heavy", 44})}};
  const report::RunDepartures departures = {{"base", {}}, {"heavy", Heavy().at("")}};
  const report::Report report = report::MakeReport(run, departures);
  EXPECT_TRUE(report.claims.HasArms());
  EXPECT_TRUE(report.variants.verdicts.empty());
  EXPECT_FALSE(report.variants.differences.empty());
  EXPECT_EQ(variants::VariantText(report.variants).find("Claims of the paper"), std::string::npos);
  ASSERT_EQ(report.DepartureNotes().size(), 1u);
  EXPECT_TRUE(report.DepartureNotes()[0].starts_with("1 of 2 variants are not as in the paper (heavy)"));
  const report::Report asked = report::MakeReport(run, departures, report::Judging::kEverything);
  EXPECT_EQ(asked.variants.verdicts.size(), 2u);
  EXPECT_NE(variants::VariantText(asked.variants).find("Claims of the paper"), std::string::npos);
}

}  // namespace
}  // namespace ed3r
