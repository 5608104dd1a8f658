#include "engine/sweep/plan_text.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/sweep/arm_id.h"
#include "engine/sweep/setting.h"

namespace ed3r::sweep {
namespace {

std::vector<std::string> SplitList(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream list(text);
  for (std::string part; std::getline(list, part, ',');) parts.push_back(part);
  return parts;
}

template <class Number>
Number NumberOf(const std::string& key, std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw UserError(fmt::format("the stored plan cannot be read: {}={}", key, text));
  return value;
}

Precision PrecisionOf(const std::string& text) {
  std::istringstream words(text);
  Precision precision;
  std::string half_width, every;
  words >> precision.metric >> half_width >> every;
  precision.half_width = NumberOf<double>("precision", half_width);
  precision.every = NumberOf<int>("precision", every);
  return precision;
}

KeptTimesteps TimestepsOf(const std::string& text) {
  const std::optional<KeptTimesteps> kept = KeptTimestepsOf(text);
  if (!kept) throw UserError(fmt::format("the stored plan cannot be read: timesteps={}", text));
  return *kept;
}

// A line of a stage, or of the plan where there is no stage yet.
void ReadLine(const std::string& key, const std::string& value, WrittenPlan& plan) {
  if (key == "sweep") plan.name = value;
  if (key == "seed") plan.seed = NumberOf<std::uint64_t>(key, value);
  if (key == "stage") plan.stages.emplace_back().name = value;
  if (plan.stages.empty()) return;
  WrittenPlan::Stage& stage = plan.stages.back();
  if (key == "kind") stage.kind = value == "train" ? StageKind::kTrain : StageKind::kFly;
  if (key == "after") stage.after = SplitList(value);
  if (key == "missions") stage.missions = NumberOf<int>(key, value);
  if (key == "precision") stage.precision = PrecisionOf(value);
  if (key == "timesteps") stage.timesteps = TimestepsOf(value);
  if (key == "arm") stage.arms.push_back({value, {}});
  if (key.find('.') != std::string::npos && !stage.arms.empty()) stage.arms.back().settings[key] = value;
}

Arm ArmOf(const WrittenPlan::Arm& written, const std::string& from) {
  Arm arm;
  arm.name = written.name;
  arm.variant = ArmId::Of(arm.name).variant;
  for (const auto& [key, value] : written.settings) {
    const std::string problem = SetParameter(arm.config, key, value);
    if (!problem.empty()) throw UserError(fmt::format("{}: arm {}: {}", from, arm.name, problem));
    if (NamesAFile(key)) arm.files[key] = value;
  }
  return arm;
}

}  // namespace

WrittenPlan ReadPlanText(std::string_view text) {
  WrittenPlan plan;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    const auto equals = line.find('=');
    if (equals != std::string::npos) ReadLine(line.substr(0, equals), line.substr(equals + 1), plan);
  }
  return plan;
}

SweepPlan PlanOf(const WrittenPlan& written, const std::string& from) {
  SweepPlan plan;
  plan.name = written.name;
  plan.file = from;
  plan.seed = written.seed;
  for (const WrittenPlan::Stage& from_stage : written.stages) {
    Stage& stage = plan.stages.emplace_back();
    stage.name = from_stage.name;
    stage.kind = from_stage.kind;
    stage.after = from_stage.after;
    stage.missions = from_stage.missions;
    stage.precision = from_stage.precision;
    stage.timesteps = from_stage.timesteps;
    for (const WrittenPlan::Arm& arm : from_stage.arms) stage.arms.push_back(ArmOf(arm, from));
  }
  return plan;
}

}  // namespace ed3r::sweep
