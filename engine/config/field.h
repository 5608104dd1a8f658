// How a plain struct says what it is: each parameter struct has one static Describe() that names every field
// with its unit, allowed range and source, and that is the whole schema. Reading a sweep file, `--set`,
// `ed3r params`, the stored recipe and the error messages all walk the same description.
//
//   struct Propeller {
//     double radius_m = 0.1;
//     template <class Self, class Visitor>
//     static void Describe(Self& self, Visitor&& visit) {
//       visit("radius_m", self.radius_m, {.unit = "m", .min = 0.01, .max = 2, .source = "Table UAV (c)",
//       .meaning = "..."});
//     }
//   };
//
// Fields are double, int, bool, std::string, or an enum with an EnumNames specialisation.
#pragma once

#include <limits>
#include <span>
#include <string_view>

namespace ed3r {

// Where a parameter counts. `ed3r physics` evaluates the closed forms at one operating point, whose values
// are drawn per timestep in a mission; a sweep may not set them.
enum class Scope { kMission, kPhysicsOnly };

struct FieldInfo {
  std::string_view unit = {};  // empty for none
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string_view source = {};  // table, equation or reading
  std::string_view meaning = {};
  Scope scope = Scope::kMission;
  bool is_file = false;           // text: the path of a file, from the folder of the sweep file
  std::string_view or_else = {};  // the word that stands for none in a file's place
};

template <class Enum>
struct EnumName {
  Enum value;
  std::string_view name;
};

// Specialise with `static constexpr EnumName<E> kNames[] = {{E::kA, "a"}, ...};`
template <class Enum>
struct EnumNames;

template <class Enum>
std::string_view NameOf(Enum value) {
  for (const EnumName<Enum>& entry : EnumNames<Enum>::kNames)
    if (entry.value == value) return entry.name;
  return "?";
}

}  // namespace ed3r
