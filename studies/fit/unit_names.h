// What the names of columns say of their units. Pure, any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace ed3r::fit {

// The word of a name that says another unit than ours for `meaning` (speed_kmh, Speed [km h-1], speedkmh), and the factor
// from it, 0 where none makes ours of it; also of a climb rate that the name calls one downwards (vel_d_m_s: -1); or none.
std::optional<std::pair<std::string, double>> OtherUnit(std::string_view meaning, std::string_view name);

// In lower case; "" for a name without letters.
std::string FirstWord(std::string_view name);

}  // namespace ed3r::fit
