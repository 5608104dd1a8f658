#include "engine/sweep/kept_timesteps.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/check.h"

namespace ed3r::sweep {
namespace {

constexpr std::string_view kStageLine = "stage=", kTimestepsLine = "timesteps=";

}  // namespace

std::optional<KeptTimesteps> KeptTimestepsOf(std::string_view word) {
  for (const auto& [value, name] : EnumNames<KeptTimesteps>::kNames)
    if (name == word) return value;
  return std::nullopt;
}

std::vector<KeptTimesteps> ReadKeptTimesteps(std::string_view plan_text) {
  std::vector<KeptTimesteps> kept;
  while (!plan_text.empty()) {
    const std::string_view line = plan_text.substr(0, plan_text.find('\n'));
    plan_text.remove_prefix(std::min(plan_text.size(), line.size() + 1));
    if (line.starts_with(kStageLine)) kept.push_back(KeptTimesteps::kAll);
    if (kept.empty() || !line.starts_with(kTimestepsLine)) continue;
    const std::optional<KeptTimesteps> read = KeptTimestepsOf(line.substr(kTimestepsLine.size()));
    if (!read) throw UserError(fmt::format("the stored plan cannot be read: {}", line));
    kept.back() = *read;
  }
  return kept;
}

}  // namespace ed3r::sweep
