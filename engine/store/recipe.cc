#include "engine/store/recipe.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

namespace ed3r::store {
namespace {

// Takes the first line off `text`.
std::string_view TakeLine(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(text.size(), line.size() + 1));
  return line;
}

std::string Quoted(std::string_view line) {
  constexpr std::size_t kLongest = 120;
  return line.size() <= kLongest ? fmt::format("\"{}\"", line)
                                 : fmt::format("\"{}...\"", line.substr(0, kLongest));
}

std::string PlanDifference(std::string_view there, std::string_view here) {
  for (int number = 1;; ++number) {
    const bool there_ends = there.empty(), here_ends = here.empty();
    const std::string_view a = TakeLine(there), b = TakeLine(here);
    if (a == b && !there_ends && !here_ends) continue;
    return fmt::format("the plan differs at its line {}: {} there, {} here", number,
                       there_ends ? "nothing more" : Quoted(a), here_ends ? "nothing more" : Quoted(b));
  }
}

}  // namespace

std::string CodeText(const CodeIdentities& code) {
  std::vector<std::string> parts;
  for (const auto& [subsystem, identities] : code)
    parts.push_back(fmt::format("{} {}", subsystem, fmt::join(identities, " and ")));
  return fmt::format("{}", fmt::join(parts, ", "));
}

void Join(CodeIdentities& code, const CodeIdentities& other) {
  for (const auto& [subsystem, identities] : other)
    code[subsystem].insert(identities.begin(), identities.end());
}

bool MixedCode(const CodeIdentities& code) {
  return std::any_of(code.begin(), code.end(), [](const auto& entry) { return entry.second.size() > 1; });
}

std::optional<std::string> CodeDifference(const CodeIdentities& there, const CodeIdentities& here) {
  for (const auto& [subsystem, identities] : here) {
    const auto known = there.find(subsystem);
    if (known == there.end())
      return fmt::format("its code is {} there and {} here", CodeText(there), CodeText(here));
    for (const std::string& identity : identities) {
      if (known->second.contains(identity)) continue;
      const std::string what = subsystem == kMathLibrary
                                   ? "the C library, which rounds sin, exp and the like by its version and "
                                     "the CPU's fused multiply-add,"
                                   : fmt::format("the code of {}", subsystem);
      return fmt::format("{} is {} there and {} here", what, fmt::join(known->second, " and "), identity);
    }
  }
  return std::nullopt;
}

std::optional<std::string> Difference(const Recipe& there, const Recipe& here) {
  if (there.plan_text != here.plan_text) return PlanDifference(there.plan_text, here.plan_text);
  for (const auto& [name, fingerprint] : there.inputs) {
    const auto other = here.inputs.find(name);
    if (other == here.inputs.end()) return fmt::format("{} is used there, but not here", name);
    if (other->second != fingerprint)
      return fmt::format("{} is {} there and {} here", name, fingerprint, other->second);
  }
  for (const auto& [name, fingerprint] : here.inputs)
    if (!there.inputs.contains(name)) return fmt::format("{} is used here, but not there", name);
  return std::nullopt;
}

}  // namespace ed3r::store
