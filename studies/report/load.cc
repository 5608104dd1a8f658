#include "studies/report/load.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "engine/store/reader.h"
#include "studies/figures/run_source.h"
#include "studies/metrics/metrics.h"

namespace ed3r::report {
namespace {

struct LoadedMissions {
  std::vector<mission::MissionRecord> records;
  std::vector<int> numbers;
  std::int64_t end =
      0;  // after the last one's number: where it is more than there are, some between are missing

  // In the order of their numbers.
  void Add(int number, const mission::MissionRecord& record) {
    records.push_back(record);
    records.back().steps = {};
    numbers.push_back(number);
    end = number + 1;
  }
};

LoadedMissions LoadMissions(store::ResultReader& reader, int stage, int arm) {
  LoadedMissions missions;
  reader.ForEachMission(stage, arm, store::Steps::kSkip, [&](const store::StoredMission& mission) {
    missions.Add(mission.id.mission, mission.record);
  });
  return missions;
}

double HalfWidthOf(metrics::ArmData arm, int missions, const std::string& metric) {
  if (static_cast<int>(arm.missions.size()) < missions) return std::numeric_limits<double>::quiet_NaN();
  arm.missions.resize(static_cast<std::size_t>(missions));
  const metrics::MetricValue value = metrics::ComputeMetrics(arm)[metric];
  return 0.5 * (value.hi - value.lo);
}

std::string WorldOf(const std::vector<figures::ArmPlan>& plans,
                    const std::map<std::string, std::string>& fingerprints, const metrics::ArmData& arm) {
  const auto plan = std::find_if(plans.begin(), plans.end(), [&](const figures::ArmPlan& p) {
    return p.stage == arm.stage && p.name == arm.name;
  });
  if (plan == plans.end()) return "";
  const auto found = fingerprints.find(plan->Setting("mission.world"));
  return found == fingerprints.end() ? "" : found->second;
}

// An arm that is known well enough misses nothing.
bool KnownWellEnough(const metrics::ArmData& arm, const std::optional<sweep::Precision>& precision) {
  if (!precision) return false;
  const auto flown = static_cast<int>(arm.missions.size());
  return flown > 0 && precision->every > 0 && flown % precision->every == 0 &&
         HalfWidthOf(arm, flown, precision->metric) <= precision->half_width;
}

using MissionsOf = std::function<LoadedMissions(int stage, int arm)>;

RunResults ResultsOf(store::ResultReader& reader, const std::vector<store::ArmStatus>& status,
                     const MissionsOf& missions) {
  const store::RunLayout& layout = reader.Layout();
  RunResults results{layout.name, {}};
  if (store::MixedCode(reader.StoredRecipe().code))
    results.mixed_code = store::CodeText(reader.StoredRecipe().code);
  results.unchecked = !reader.Tables().checked();
  const std::vector<figures::ArmPlan> plans = figures::ReadArmPlans(reader.StoredRecipe().plan_text);
  for (int s = 0; s < static_cast<int>(layout.stages.size()); ++s) {
    const store::RunLayout::Stage& stage = layout.stages[s];
    if (stage.missions == 0) continue;
    const auto plan = std::find_if(plans.begin(), plans.end(),
                                   [&](const figures::ArmPlan& p) { return p.stage == stage.name; });
    const std::optional<sweep::Precision> precision = plan == plans.end() ? std::nullopt : plan->precision;
    for (int a = 0; a < static_cast<int>(stage.arms.size()); ++a) {
      LoadedMissions loaded = missions(s, a);
      metrics::ArmData arm{stage.name, stage.arms[a].name, std::move(loaded.records)};
      arm.numbers = std::move(loaded.numbers);
      arm.world = WorldOf(plans, reader.StoredRecipe().inputs, arm);
      const auto flown = static_cast<std::int64_t>(arm.missions.size());
      arm.failed = static_cast<int>(status[layout.RunIndex(s, a)].failed);
      const std::int64_t between = loaded.end - flown - arm.failed;
      if (precision && between > 0)
        arm.missing = static_cast<int>(between);
      else if (!KnownWellEnough(arm, precision))
        arm.missing = static_cast<int>(stage.missions - flown - arm.failed);
      results.arms.push_back(std::move(arm));
    }
  }
  return results;
}

}  // namespace

RunResults LoadRun(store::ResultReader& reader) {
  const store::Transaction moment = reader.Moment();
  return ResultsOf(reader, reader.Status(),
                   [&](int stage, int arm) { return LoadMissions(reader, stage, arm); });
}

WholeRun LoadWhole(store::ResultReader& reader, const std::string& called) {
  const store::Transaction moment = reader.Moment();
  const store::RunLayout& layout = reader.Layout();
  std::map<std::int64_t, LoadedMissions> by_run;
  const std::string digest =
      reader.CheckWhole([&](const sweep::RunId& id, const mission::MissionRecord& record) {
        by_run[layout.RunIndex(id)].Add(id.mission, record);
      });
  Provenance provenance = ReadProvenance(reader, digest, called);
  RunResults results = ResultsOf(reader, provenance.status, [&](int stage, int arm) {
    return std::move(by_run[layout.RunIndex(stage, arm)]);
  });
  return {std::move(results), std::move(provenance)};
}

double HalfWidth(const std::string& dir, int stage, const std::string& arm, int missions,
                 const std::string& metric) {
  store::ResultReader reader(dir);
  const store::RunLayout::Stage& flown = reader.Layout().stages.at(static_cast<std::size_t>(stage));
  metrics::ArmData data{flown.name, arm, LoadMissions(reader, stage, reader.ArmNamed(stage, arm)).records};
  return HalfWidthOf(std::move(data), missions, metric);
}

}  // namespace ed3r::report
