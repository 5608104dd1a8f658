#include "studies/variants/pairing_notes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "studies/variants/paired.h"
#include "studies/variants/variants.h"

namespace ed3r::variants {
namespace {

const metrics::ArmData* Find(std::span<const metrics::ArmData> arms, const metrics::ArmData& like) {
  const auto found = std::find_if(arms.begin(), arms.end(), [&](const metrics::ArmData& arm) {
    return arm.stage == like.stage && arm.name == like.name;
  });
  return found == arms.end() ? nullptr : &*found;
}

std::vector<std::string> OnlyIn(std::span<const metrics::ArmData> arms,
                                std::span<const metrics::ArmData> others) {
  std::vector<std::string> names;
  for (const metrics::ArmData& arm : arms)
    if (!arm.missions.empty() && Find(others, arm) == nullptr)
      names.push_back(fmt::format("{} (stage {})", arm.name, arm.stage));
  return names;
}

// With other seeds nothing but the numbers is.
std::string CommonText(std::size_t common, std::size_t here, std::size_t there, bool same_draws) {
  const std::string what = same_draws ? "scenario" : "scenario number";
  if (common == 0) return fmt::format("no {} is in common: nothing is compared", what);
  return fmt::format("{} {}{} in common, of {} and {}", common, what, common == 1 ? " is" : "s are", here,
                     there);
}

}  // namespace

std::vector<std::string> PairingNotes(const LabelledRun& first, const LabelledRun& other, bool same_draws) {
  std::vector<std::string> notes;
  for (const auto& [has, lacks] : {std::pair(&first, &other), std::pair(&other, &first)})
    if (const std::vector<std::string> names = OnlyIn(has->arms, lacks->arms); !names.empty())
      notes.push_back(fmt::format("only {} has {}: not compared", has->label, fmt::join(names, ", ")));
  std::map<std::string, std::vector<std::string>> partly;  // by how many are in common
  std::vector<std::string> elsewhere;
  for (const metrics::ArmData& arm : first.arms) {
    const metrics::ArmData* const beside = Find(other.arms, arm);
    if (beside == nullptr || arm.missions.empty() || beside->missions.empty()) continue;
    const std::size_t common = ScenariosInCommon(arm, *beside);
    if (common < std::max(arm.missions.size(), beside->missions.size()))
      partly[CommonText(common, arm.missions.size(), beside->missions.size(), same_draws)].push_back(
          arm.name);
    if (same_draws && common > 0 && !SameScenarios(arm, *beside)) elsewhere.push_back(arm.name);
  }
  for (const auto& [what, names] : partly)
    notes.push_back(fmt::format("{} and {}, {}: {}", first.label, other.label, fmt::join(names, ", "), what));
  if (!elsewhere.empty())
    notes.push_back(
        fmt::format("{} and {}, {}: scenarios of one number begin elsewhere or look for another fire, so "
                    "that pairs have nothing "
                    "in common",
                    first.label, other.label, fmt::join(elsewhere, ", ")));
  return notes;
}

std::vector<std::string> VariantPairingNotes(std::span<const metrics::ArmData> arms) {
  const std::vector<std::string> variants = VariantsOf(arms);
  if (variants.empty()) return {};
  const std::vector<metrics::ArmData> first = ArmsOfVariant(arms, variants.front());
  std::vector<std::string> elsewhere, other_worlds, few;
  for (const std::string& variant : variants) {
    const std::vector<metrics::ArmData> own = ArmsOfVariant(arms, variant);
    const auto any = [&](auto differ) {
      return std::any_of(first.begin(), first.end(), [&](const metrics::ArmData& arm) {
        const metrics::ArmData* const beside = Find(own, arm);
        return beside != nullptr && differ(arm, *beside);
      });
    };
    if (any([](const auto& a, const auto& b) { return !SameScenarios(a, b); }))
      elsewhere.push_back(variant);
    else if (any(OtherWorlds))
      other_worlds.push_back(variant);
    if (any(FewInCommon)) few.push_back(variant);
  }
  std::vector<std::string> notes = PlaceNotes(elsewhere, other_worlds, variants.front());
  if (!few.empty())
    notes.push_back(
        fmt::format("{}: not all scenario numbers are those of '{}' (mission.first_scenario): compared are "
                    "those in common.",
                    fmt::join(few, ", "), variants.front()));
  return notes;
}

std::vector<std::string> PlaceNotes(const std::vector<std::string>& elsewhere,
                                    const std::vector<std::string>& other_worlds, const std::string& than) {
  std::vector<std::string> notes;
  if (!elsewhere.empty())
    notes.push_back(
        fmt::format("{}: scenarios of one number begin elsewhere, or look for another fire, than those of "
                    "'{}': pairs have "
                    "nothing in common.",
                    fmt::join(elsewhere, ", "), than));
  if (!other_worlds.empty())
    notes.push_back(fmt::format(
        "{}: not the world of '{}'; a place of one number may lie elsewhere ('ed3r world FILE' lists them).",
        fmt::join(other_worlds, ", "), than));
  return notes;
}

}  // namespace ed3r::variants
