#include "engine/app/failure_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "engine/app/words.h"
#include "engine/core/message.h"

namespace ed3r::app {
namespace {

constexpr std::size_t kShownOfAKind = 5;

using Kind = std::pair<std::string, std::vector<const store::FailedMission*>>;

std::vector<Kind> ByKind(const std::vector<store::FailedMission>& failures) {
  std::map<std::string, std::vector<const store::FailedMission*>> found;
  for (const store::FailedMission& failure : failures)
    found[failure.kind.empty() ? "unclassified" : failure.kind].push_back(&failure);
  std::vector<Kind> kinds(found.begin(), found.end());
  std::stable_sort(kinds.begin(), kinds.end(),
                   [](const Kind& a, const Kind& b) { return a.second.size() > b.second.size(); });
  return kinds;
}

}  // namespace

std::string FailuresText(const store::RunLayout& layout, const std::vector<store::FailedMission>& failures) {
  std::string text;
  for (const auto& [kind, missions] : ByKind(failures)) {
    text +=
        fmt::format("failed, {}: {}\n", kind, Counted(static_cast<std::int64_t>(missions.size()), "mission"));
    for (std::size_t i = 0; i < std::min(missions.size(), kShownOfAKind); ++i)
      text += fmt::format("  {} (scenario {}, seed {}): {}\n", layout.Describe(missions[i]->id),
                          missions[i]->scenario, missions[i]->seed, OneLine(missions[i]->message));
    if (missions.size() > kShownOfAKind)
      text += fmt::format("  and {} more; --json names all\n", missions.size() - kShownOfAKind);
  }
  return text;
}

nlohmann::ordered_json FailuresJson(const store::RunLayout& layout,
                                    const std::vector<store::FailedMission>& failures) {
  auto list = nlohmann::ordered_json::array();
  for (const store::FailedMission& failure : failures)
    list.push_back({{"mission", layout.Describe(failure.id)},
                    {"scenario", failure.scenario},
                    {"seed", failure.seed},
                    {"kind", failure.kind},
                    {"message", failure.message}});
  return list;
}

nlohmann::ordered_json FailureKindsJson(const std::vector<store::FailedMission>& failures) {
  auto kinds = nlohmann::ordered_json::object();
  for (const auto& [kind, missions] : ByKind(failures)) kinds[kind] = missions.size();
  return kinds;
}

}  // namespace ed3r::app
