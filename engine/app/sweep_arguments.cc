#include "engine/app/sweep_arguments.h"

#include <fmt/format.h>

#include <optional>

#include "engine/agents/strategy.h"
#include "engine/core/check.h"
#include "engine/core/parse_number.h"
#include "engine/sweep/sweep_file.h"
#include "studies/metrics/definitions.h"

namespace ed3r::app {
namespace {

template <class Integer>
std::optional<Integer> ParseOption(const char* option, const std::string& text, Integer min, Integer max) {
  if (text.empty()) return std::nullopt;
  const std::optional<Integer> value = ParseNumber<Integer>(text);
  if (!value || *value < min || *value > max)
    throw UserError(fmt::format("{}: '{}' is not allowed; allowed: {} .. {}", option, text, min, max));
  return value;
}

sweep::MissionsOverride ParseMissions(const std::string& text) {
  const std::size_t equals = text.find('=');
  const bool named = equals != std::string::npos;
  const std::string number = text.substr(named ? equals + 1 : 0);
  const auto value = ParseOption<int>("--missions", number, 1, static_cast<int>(sweep::kMaxMissions));
  if (!value || equals == 0)
    throw UserError(fmt::format("--missions: '{}' is not allowed; allowed: N or STAGE=N", text));
  return {named ? text.substr(0, equals) : "", *value};
}

}  // namespace

void SweepArguments::AddTo(CommandLine& parser) {
  parser.Option("SWEEP", file, "Sweep file (YAML)").Required();
  parser.Option("--set", set, "KEY=VALUE; wins over the file; 'ed3r params' lists the keys").OneValue();
  parser.Option("--seed", seed, "Seed in place of the file's");
  parser
      .Option("--missions", missions,
              "N or STAGE=N: missions per arm in place of the file's, in every stage or in one")
      .OneValue();
}

sweep::SweepPlan SweepArguments::Load() const {
  sweep::SweepOverrides overrides;
  overrides.set = set;
  overrides.seed = ParseOption<std::uint64_t>("--seed", seed, 0, UINT64_MAX);
  for (const std::string& text : missions) overrides.missions.push_back(ParseMissions(text));
  return sweep::LoadSweep(file, overrides, [](const std::string& key, const std::string& value) {
    if (key == "precision.metric") return metrics::CheckMetricName(value);
    return key == "mission.strategy" ? agents::CheckStrategyName(value) : std::string();
  });
}

std::string DefaultRunDir(const sweep::SweepPlan& plan) { return "results/runs/" + plan.name; }

}  // namespace ed3r::app
