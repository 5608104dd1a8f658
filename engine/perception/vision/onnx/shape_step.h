// What the steps of OnnxShapes have in common: one step among values whose shapes are known.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/perception/vision/onnx/fields.h"
#include "engine/perception/vision/onnx/forms.h"
#include "engine/perception/vision/onnx/shapes.h"

namespace ed3r::perception {

inline std::int64_t Count(const OnnxSides& sides, std::size_t from, std::size_t to) {
  return std::accumulate(sides.begin() + static_cast<std::ptrdiff_t>(from),
                         sides.begin() + static_cast<std::ptrdiff_t>(to), std::int64_t{1},
                         std::multiplies<>());
}
inline std::int64_t Count(const OnnxSides& sides) { return Count(sides, 0, sides.size()); }

inline std::string Text(const OnnxSides& sides) { return fmt::format("[{}]", fmt::join(sides, ", ")); }

class ShapeStep {
 public:
  ShapeStep(const OnnxNode& node, const OnnxSurroundings& around,
            const std::map<std::string, OnnxSides>& sides,
            const std::map<std::string, std::vector<std::int64_t>>& whole, const std::string& name)
      : node_(node), around_(around), sides_(sides), whole_(whole), name_(name) {}

  // A letter for each input, as RuleOf takes them. Refuses what no step before gives.
  std::string Kinds() const {
    std::string kinds;
    for (const std::string& input : node_.inputs) {
      if (input.empty())
        kinds += '-';
      else if (const auto constant = around_.constants.find(input); constant != around_.constants.end())
        kinds += KindOf(constant->second.type);
      else if (whole_.contains(input))
        kinds += 'n';
      else if (sides_.contains(input))
        kinds += 'x';
      else
        Refuse(fmt::format("takes '{}', which is neither a constant nor the first output of a step", input),
               "those");
    }
    return kinds;
  }

  void CheckSize(const OnnxSides& sides) const {
    std::int64_t elements = 1;
    for (const std::int64_t side : sides)
      if (side < 1 || side > onnx::kMostElements || (elements *= side) > onnx::kMostElements)
        Refuse(fmt::format("gives {}", Text(sides)), fmt::format("at most {} elements", onnx::kMostElements));
  }

 protected:
  static char KindOf(std::uint64_t type) {
    if (type == onnx::kFloat) return 'c';
    return type == onnx::kInt64 || type == onnx::kInt32 ? 'i' : 'o';
  }

  [[noreturn]] void Refuse(const std::string& found, const std::string& allowed) const {
    throw UserError(fmt::format("{}: operator {} {}; allowed: {}", name_, node_.Text(), found, allowed));
  }

  const OnnxConstant* Constant(std::size_t input) const {
    if (!node_.HasInput(input)) return nullptr;
    const auto found = around_.constants.find(node_.inputs[input]);
    return found == around_.constants.end() ? nullptr : &found->second;
  }

  const OnnxSides& X(std::size_t input = 0) const {
    const auto found = sides_.find(node_.inputs.at(input));
    return found != sides_.end() ? found->second : around_.constants.at(node_.inputs[input]).sides;
  }

  // Files may hold any number; beyond the largest tensor all are alike, and their sums and products stay in 64 bits.
  static std::vector<std::int64_t> Bounded(std::vector<std::int64_t> numbers) {
    for (std::int64_t& number : numbers)
      number = std::clamp(number, -2 * onnx::kMostElements, 2 * onnx::kMostElements);
    return numbers;
  }

  // Of an attribute, or of an input of whole numbers; nothing where neither is told.
  std::vector<std::int64_t> Numbers(std::size_t input, const std::string& attribute) const {
    if (!node_.HasInput(input)) return Bounded(node_.Numbers(attribute));
    const auto made = whole_.find(node_.inputs[input]);
    if (made != whole_.end()) return Bounded(made->second);
    const OnnxConstant* constant = Constant(input);
    if (constant == nullptr || (constant->whole.empty() && Count(constant->sides) != 0))
      Refuse(fmt::format("takes '{}', which are no constant whole numbers", node_.inputs[input]),
             "up to 64 of int64 or int32");
    return Bounded(constant->whole);
  }

  std::size_t Axis(std::int64_t told, std::size_t rank) const {
    const auto sides = static_cast<std::int64_t>(rank);
    if (told < -sides || told >= sides)
      Refuse(fmt::format("has the axis {} of {} sides", told, rank), "one of them");
    return static_cast<std::size_t>(told < 0 ? told + sides : told);
  }

  void AskRank(const OnnxSides& sides, std::size_t least, std::size_t most) const {
    if (sides.size() < least || sides.size() > most)
      Refuse(fmt::format("takes {}", Text(sides)),
             least == most ? fmt::format("{} sides", least) : fmt::format("{} to {} sides", least, most));
  }

  const OnnxNode& node_;
  const OnnxSurroundings& around_;
  const std::map<std::string, OnnxSides>& sides_;
  const std::map<std::string, std::vector<std::int64_t>>& whole_;
  const std::string& name_;
};

// The shapes of the outputs by these rules; each throws UserError for shapes with which OpenCV reads the step otherwise.
std::vector<OnnxSides> ComputedSides(const ShapeStep& step, OnnxRule rule);  // convolutions to products
std::vector<OnnxSides> ArrangedSides(const ShapeStep& step,
                                     OnnxRule rule);  // what only puts values elsewhere
// What is made of shapes and whole numbers.
std::vector<std::int64_t> WholeNumbers(const ShapeStep& step);

}  // namespace ed3r::perception
