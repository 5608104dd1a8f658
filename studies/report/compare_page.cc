#include "studies/report/compare_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "engine/core/check.h"
#include "studies/figures/figure_data.h"
#include "studies/report/page_data.h"
#include "studies/tables/names.h"

namespace ed3r::report {
namespace {

using Json = nlohmann::ordered_json;

// All runs as one: stages bear the label of their run.
struct Together {
  std::vector<metrics::ArmMetrics> metrics;
  std::vector<figures::ArmPlan> plans;
  PageMissions missions;
  struct Origin {
    std::string run, dir, stored_name;
  };
  std::vector<Origin> origins;  // of the arms
};

void Add(const ComparedRun& run, const std::string& letter, Together& together) {
  Report report;
  for (const metrics::ArmData& arm : run.results.arms) report.told.push_back(metrics::ComputeMetrics(arm));
  PageMissions missions = PageMissionsOf(report, run.results);
  for (std::size_t a = 0; a < report.told.size(); ++a) {
    together.origins.push_back(
        {letter, run.provenance.dir, report.told[a].stage + '/' + report.told[a].name});
    report.told[a].stage = missions.arms[a].stage = run.label + '/' + report.told[a].stage;
  }
  std::move(report.told.begin(), report.told.end(), std::back_inserter(together.metrics));
  std::move(missions.arms.begin(), missions.arms.end(), std::back_inserter(together.missions.arms));
  std::move(missions.numbers.begin(), missions.numbers.end(), std::back_inserter(together.missions.numbers));
  for (figures::ArmPlan plan : run.plans) {
    plan.stage = run.label + '/' + plan.stage;
    together.plans.push_back(std::move(plan));
  }
}

// Short names for the pictures: A, B, ...
std::string Letter(std::size_t run) {
  return run < 26 ? std::string(1, static_cast<char>('A' + run)) : fmt::format("#{}", run + 1);
}

std::string Names(const std::vector<ComparedRun>& runs) {
  std::string names = runs.front().label;
  for (std::size_t r = 1; r < runs.size(); ++r)
    names += (r + 1 == runs.size() ? " and " : ", ") + runs[r].label;
  return names;
}

}  // namespace

figures::FoundScene SceneOf(store::ResultReader& reader, std::span<const figures::ArmPlan> plans) {
  for (const figures::ArmPlan& plan : plans)
    if (const std::string world = plan.Setting("mission.world"); !world.empty())
      return figures::FindScene(reader, world);
  return {nullptr, "the plan names no world"};
}

std::vector<std::string> ComparisonSentences(const variants::VariantStudy& study) {
  std::vector<std::string> sentences;
  for (std::size_t v = 1; v < study.variants.size(); ++v) {
    const std::string& name = study.variants[v];
    int all = 0, certain = 0;
    for (const variants::VariantDifference& d : study.differences)
      if (d.variant == name) ++all, certain += d.Certain();
    int changed = 0, contradict = 0;
    for (const variants::VerdictChange& change : study.changes)
      if (change.variant == name) ++changed, contradict += change.Contradicts();
    std::string sentence = fmt::format(
        "{} against {}: {} of {} differences of arms in energy, success and duration are certain (95 %, {})",
        name, study.variants.front(), certain, all,
        study.same_draws ? "paired by scenario" : "other draws at the same places");
    if (!study.verdicts.empty())
      sentence +=
          fmt::format("; {} verdicts on the paper's claims change, {} of them from one side to the other",
                      changed, contradict);
    sentences.push_back(sentence + '.');
  }
  return sentences;
}

Json ComparePageData(const std::vector<ComparedRun>& runs, const variants::VariantStudy& study,
                     const std::vector<std::string>& departures, const std::string& command) {
  ED3R_CHECK(runs.size() > 1, "runs to compare");
  Together together;
  for (std::size_t r = 0; r < runs.size(); ++r) Add(runs[r], Letter(r), together);
  const figures::FoundScene& found = runs.front().scene;
  Json figures = figures::MakeFigureData({.name = Names(runs),
                                          .arms = together.missions.arms,
                                          .metrics = together.metrics,
                                          .plans = together.plans,
                                          .missions = {},
                                          .scene = found.scene,
                                          .scene_note = found.why_not,
                                          .variants = &study});
  figures["figures"] = Json::array();
  Report report;
  report.name = Names(runs);
  report.told = together.metrics;
  if (!study.verdicts.empty()) report.claims = study.verdicts.front();
  const Provenance& provenance = runs.front().provenance;
  Json data = MakePageData({.report = report,
                            .provenance = provenance,
                            .missions = together.missions,
                            .figures = figures,
                            .question = "What differs between " + Names(runs) + "?",
                            .report_command = command,
                            .figures_note = ""});
  data["answer"] = ComparisonSentences(study);
  data["departures"] = departures;
  data["compared"] = study.variants;
  data["run_letters"] = Json::array();
  for (std::size_t r = 0; r < runs.size(); ++r)
    data["run_letters"].push_back({{"letter", Letter(r)}, {"run", runs[r].label}});
  for (std::size_t a = 0; a < together.origins.size(); ++a) {
    const Together::Origin& origin = together.origins[a];
    Json& arm = data["arms"][a];
    arm["label"] = fmt::format("{} · {}", tables::ArmLabel(together.metrics[a].name), origin.run);
    arm["run"] = origin.run;
    arm["stored_name"] = origin.stored_name;
    arm["dir"] = origin.dir;
  }
  return data;
}

}  // namespace ed3r::report
