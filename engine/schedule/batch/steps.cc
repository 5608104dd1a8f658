#include "engine/schedule/batch/steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/core/check.h"

namespace ed3r::schedule {
namespace {

bool BuiltUpon(const sweep::SweepPlan& plan, const std::string& name) {
  return std::any_of(plan.stages.begin(), plan.stages.end(), [&](const sweep::Stage& stage) {
    return std::find(stage.after.begin(), stage.after.end(), name) != stage.after.end();
  });
}

}  // namespace

std::vector<BatchStep> StepsOf(const sweep::SweepPlan& plan, std::int64_t shards, std::int64_t networks,
                               const std::vector<double>& expected_core_s) {
  ED3R_CHECK(shards > 0 && expected_core_s.size() == plan.stages.size(), fmt::format("{} shards", shards));
  std::vector<BatchStep> steps;
  const auto add = [&](BatchStep::Kind kind, const std::string& stage,
                       const std::string& label) -> BatchStep& {
    BatchStep& step = steps.emplace_back();
    step.kind = kind;
    step.stage = stage;
    step.name = fmt::format("{}-{}", steps.size(), label);
    return step;
  };
  for (std::size_t i = 0; i < plan.stages.size(); ++i) {
    const sweep::Stage& stage = plan.stages[i];
    if (stage.kind == sweep::StageKind::kTrain) {
      if (networks > 0) {
        BatchStep& train = add(BatchStep::Kind::kTrain, stage.name, stage.name);
        train.tasks = networks;
        train.expected_core_s = expected_core_s[i];
      }
      add(BatchStep::Kind::kCollect, stage.name, stage.name + "-collect");
      continue;
    }
    const auto missions = static_cast<std::int64_t>(stage.arms.size()) * stage.missions;
    BatchStep& fly = add(BatchStep::Kind::kFly, stage.name, stage.name);
    fly.tasks = std::min(shards, missions);
    fly.in_rounds = stage.precision.has_value();
    fly.expected_core_s = expected_core_s[i];
    BatchStep& merge = add(BatchStep::Kind::kMerge, stage.name, stage.name + "-merge");
    merge.in_rounds = stage.precision.has_value();
    merge.built_upon = BuiltUpon(plan, stage.name);
  }
  add(BatchStep::Kind::kReport, "", "report");
  return steps;
}

std::string TaskList(const std::vector<std::int64_t>& tasks) {
  std::string text;
  for (std::size_t first = 0; first < tasks.size();) {
    std::size_t last = first;
    while (last + 1 < tasks.size() && tasks[last + 1] == tasks[last] + 1) ++last;
    if (!text.empty()) text += ',';
    text += last == first ? fmt::format("{}", tasks[first]) : fmt::format("{}-{}", tasks[first], tasks[last]);
    first = last + 1;
  }
  return text;
}

std::vector<std::string> ArraysOf(const std::vector<std::int64_t>& tasks, std::int64_t limit) {
  ED3R_CHECK(limit > 0, fmt::format("{}", limit));
  std::map<std::int64_t, std::vector<std::int64_t>> by_offset;
  for (const std::int64_t task : tasks) {
    const std::int64_t offset = (task - 1) / limit * limit;
    by_offset[offset].push_back(task - offset);
  }
  std::vector<std::string> arrays;
  for (const auto& [offset, indices] : by_offset)
    arrays.push_back(fmt::format("{}+{}", TaskList(indices), offset));
  return arrays;
}

}  // namespace ed3r::schedule
