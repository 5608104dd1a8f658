// What the codes in stored columns stand for.
#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/mission/record.h"

namespace ed3r::store {

// The codes of a column with their words; none for columns that hold no codes.
inline std::vector<std::pair<std::int64_t, std::string_view>> WordsOf(std::string_view column) {
  std::vector<std::pair<std::int64_t, std::string_view>> words;
  const auto add = [&](const auto& names) {
    for (const auto& entry : names) words.emplace_back(static_cast<std::int64_t>(entry.value), entry.name);
  };
  if (column == "outcome") add(EnumNames<mission::Outcome>::kNames);
  if (column == "motion_rule") add(EnumNames<agents::MotionRule>::kNames);
  if (column == "execution") add(EnumNames<agents::Execution>::kNames);
  return words;
}

}  // namespace ed3r::store
