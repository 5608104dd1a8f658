// What tables and figures call an arm.
#pragma once

#include <string>
#include <string_view>

namespace ed3r::tables {

// "ed3r-75" -> "ED³R-75", "rbs-p85" -> "RBS, P85"; the paper's names for the paper's arms (its P85 group of ED³R is
// that of the 75 % threshold), any other name as it is. UTF-8.
std::string ArmLabel(std::string_view name);

}  // namespace ed3r::tables
