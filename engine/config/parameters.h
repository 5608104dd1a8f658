// Parameters by key, on top of the structs' own descriptions (field.h).
// Keys are "subject.field", e.g. robot.mass_kg. Thread-safe: nothing is shared.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "engine/config/config.h"

namespace ed3r {

struct ParameterInfo {
  std::string key;
  std::string unit;           // "" for none
  std::string default_value;  // as it would stand in a sweep file
  std::string allowed;        // "0.05 .. 50", "physical | printed", "true | false", "text"
  std::string source;
  std::string meaning;
  Scope scope = Scope::kMission;
  bool is_file = false;  // a world, a detector, a network
  std::string or_else;   // the word that stands for none in a file's place; "" where none does
  double min =
      -std::numeric_limits<double>::infinity();  // what a number may be; infinite where nothing binds it
  double max = std::numeric_limits<double>::infinity();
};

// Every parameter, in the order of the structs.
const std::vector<ParameterInfo>& Parameters();
const std::vector<std::string>& ParameterKeys();
// Throws InternalError for an unknown key.
const ParameterInfo& ParameterOf(std::string_view key);

// Why a value was refused: a clause that starts with the key and holds the value, the allowed range and, for
// an unknown key, the nearest known one. The caller puts file:line:column in front. Sets `key` from text.
// Returns "" when done, else the clause; the config is then unchanged.
[[nodiscard]] std::string SetParameter(Config& config, std::string_view key, std::string_view value,
                                       Scope scope = Scope::kMission);

// The value as text that SetParameter reads back to the same bits. Throws InternalError for an unknown key.
std::string GetParameter(const Config& config, std::string_view key);

// Rules between parameters (f_min <= f_max, eta_int <= eta_min, ...): "" or a clause like SetParameter's.
[[nodiscard]] std::string CheckParameters(const Config& config);

// "key=value\n" for every mission parameter, in order: the recipe of a run; equal configs give equal text.
std::string CanonicalText(const Config& config);

}  // namespace ed3r
