// Numbers in data files, where a number that does not exist (NaN, infinite) has a form of its own.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace ed3r::metrics {

// null where there is none.
inline nlohmann::ordered_json JsonNumber(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

// An empty field where there is none; read back, the others have the same bits.
inline std::string CsvNumber(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

}  // namespace ed3r::metrics
