// Units of length by the words that rasters, projections and people use for them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r::world {

struct LengthUnit {
  double m = 1.0;         // metres in one
  std::string_view name;  // as world files write it: m, ft, us-ft, ...
};

// "m | ft | us-ft | dm | cm | mm | km"
std::string KnownLengthUnits();

// The unit of a word such as "metre", "ft", "US survey foot", "us-ft"; case, '_' and '-' do not matter.
std::optional<LengthUnit> FindLengthUnit(std::string_view word);

// The units that the words of a name say ("Height (ft)", "elevFeet", "heightft"): names of known ones, and words for others
// (yards, inches, fathoms). A word behind a number ("1.3 m") is a measure, and says none.
std::vector<std::string> LengthUnitsIn(std::string_view text);

// The unit that has so many metres, to 1 part in 10^9: the two kinds of foot are 2 in 10^6 apart.
std::optional<LengthUnit> FindLengthUnit(double metres);

}  // namespace ed3r::world
