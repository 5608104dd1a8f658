// The decisions of a timestep in words, the same wherever the program tells them.
#pragma once

#include <cstdint>
#include <string_view>

namespace ed3r::app {

// What a stored code stands for ("hover" for 2 in column motion_rule); "" for columns that hold no codes.
std::string_view CodeName(std::string_view column, std::int64_t code);

// The name of a confidence band and what the Algorithm orders in it.
std::string_view BandText(std::int64_t band);

}  // namespace ed3r::app
