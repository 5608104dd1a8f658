#include <algorithm>
#include <cmath>

#include "engine/perception/vision/onnx/shape_step.h"

namespace ed3r::perception {
namespace {

class Arranged : public ShapeStep {
 public:
  explicit Arranged(const ShapeStep& step) : ShapeStep(step) {}

  std::vector<OnnxSides> Sides(OnnxRule rule) const {
    switch (rule) {
      case OnnxRule::kConcat:
        return {Concat()};
      case OnnxRule::kFlatten:
        return {Flatten()};
      case OnnxRule::kReshape:
        return {Reshape()};
      case OnnxRule::kSqueeze:
        return {Squeeze()};
      case OnnxRule::kUnsqueeze:
        return {Unsqueeze()};
      case OnnxRule::kTranspose:
        return {Transpose()};
      case OnnxRule::kPad:
        return {Pad()};
      case OnnxRule::kSplit:
        return Split();
      case OnnxRule::kSlice:
        return {Slice()};
      case OnnxRule::kGather:
        return {Gather()};
      case OnnxRule::kReduce:
        return {Reduce()};
      case OnnxRule::kResize:
        return {Resize()};
      default:
        return {};
    }
  }

 private:
  OnnxSides Concat() const {
    OnnxSides out = X();
    AskRank(out, 2, 4);
    const std::size_t axis = Axis(static_cast<std::int64_t>(node_.Number("axis", 1)), out.size());
    for (std::size_t i = 1; i < node_.inputs.size(); ++i) {
      OnnxSides like = X(i);
      if (like.size() == out.size()) like[axis] = out[axis];
      if (like != out)
        Refuse(fmt::format("joins {} to {}", Text(X(i)), Text(X())), "equal sides but that of the axis");
      out[axis] += X(i)[axis];
    }
    return out;
  }

  OnnxSides Flatten() const {
    const std::size_t axis = Axis(static_cast<std::int64_t>(node_.Number("axis", 1)), X().size());
    return {Count(X(), 0, axis), Count(X(), axis, X().size())};
  }

  OnnxSides Reshape() const {
    OnnxSides out = Numbers(1, "shape");
    std::int64_t known = 1;
    if (node_.Number("allowzero", 0) != 0 && std::count(out.begin(), out.end(), 0) != 0)
      Refuse(fmt::format("makes {} with allowzero = 1: of nothing", Text(out)),
             "sides from 1 on, or one of -1");
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i] == 0 && i < X().size()) out[i] = X()[i];
      if (out[i] != -1) known *= out[i];
      if (known <= 0 || known > onnx::kMostElements)
        Refuse(fmt::format("makes {}", Text(out)), "as many numbers as there are");
    }
    const std::int64_t all = Count(X());
    const auto open = std::count(out.begin(), out.end(), -1);
    if (known <= 0 || open > 1 || all % known != 0 || (open == 0 && known != all))
      Refuse(fmt::format("makes {} of {}", Text(Numbers(1, "shape")), Text(X())), "as many numbers");
    std::replace(out.begin(), out.end(), std::int64_t{-1}, all / known);
    AskRank(out, 1, 5);
    return out;
  }

  OnnxSides Squeeze() const {
    OnnxSides out = X();
    const std::vector<std::int64_t> axes = Numbers(1, "axes");
    if (axes.empty()) Refuse("has no axes", "axes in numbers");
    for (const std::int64_t axis : axes) {
      std::int64_t& side = out[Axis(axis, X().size())];
      if (side != 1) Refuse(fmt::format("has the axis {} of {}", axis, Text(X())), "sides of 1");
      side = 0;
    }
    std::erase(out, 0);
    return out;
  }

  OnnxSides Unsqueeze() const {
    OnnxSides out = X();
    const std::vector<std::int64_t> axes = Numbers(1, "axes");
    if (axes.size() != 1 || axes[0] < 0 || axes[0] > std::ssize(out))
      Refuse(fmt::format("has the axes {} for {}", Text(axes), Text(out)), "one from 0 on, or a Reshape");
    out.insert(out.begin() + axes[0], 1);
    return out;
  }

  OnnxSides Transpose() const {
    OnnxSides out;
    std::vector<std::int64_t> order = node_.Numbers("perm"), sorted;
    if (order.empty())
      for (std::size_t i = X().size(); i-- > 0;) order.push_back(static_cast<std::int64_t>(i));
    for (const std::int64_t side : order) out.push_back(X()[Axis(side, X().size())]);
    sorted = order;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < sorted.size(); ++i)
      if (order.size() != X().size() || sorted[i] != static_cast<std::int64_t>(i))
        Refuse(fmt::format("has perm = {} for {}", Text(order), Text(X())), "each side once");
    return out;
  }

  OnnxSides Pad() const {
    OnnxSides out = X();
    const std::size_t rank = out.size();
    const bool constant = node_.Word("mode", "constant") == "constant";
    AskRank(out, constant ? 2 : 4, 4);
    const std::vector<std::int64_t> pads = Numbers(1, "pads");
    if (pads.size() != 2 * rank)
      Refuse(fmt::format("has {} pads for {}", pads.size(), Text(out)), "two for each side");
    for (std::size_t i = 0; i < rank; ++i) {
      const std::int64_t before = pads[i], behind = pads[rank + i];
      if (before < 0 || behind < 0) Refuse("has negative pads", "a Slice");
      if (!constant && (before + behind > 0) && (i < 2 || std::max(before, behind) >= out[i]))
        Refuse("pads channels, or by more than there is, by what stands there", "height and width");
      out[i] += before + behind;
    }
    return out;
  }

  std::vector<OnnxSides> Split() const {
    const std::size_t axis = Axis(static_cast<std::int64_t>(node_.Number("axis", 0)), X().size());
    std::vector<std::int64_t> parts = Numbers(1, "split");
    const auto count = std::ssize(node_.outputs);
    const std::int64_t side = X()[axis];
    if (parts.empty() && side % count == 0) parts.assign(static_cast<std::size_t>(count), side / count);
    if (std::ssize(parts) != count || count < 2 ||
        node_.Number("num_outputs", static_cast<double>(count)) != static_cast<double>(count) ||
        std::any_of(parts.begin(), parts.end(), [](std::int64_t part) { return part <= 0; }) ||
        std::accumulate(parts.begin(), parts.end(), std::int64_t{0}) != side)
      Refuse(fmt::format("splits side {} of {} into {} parts {}", axis, Text(X()), count, Text(parts)),
             "two or more that fill it");
    std::vector<OnnxSides> outs(parts.size(), X());
    for (std::size_t i = 0; i < parts.size(); ++i) outs[i][axis] = parts[i];
    return outs;
  }

  OnnxSides Slice() const {
    OnnxSides out = X();
    const auto starts = Numbers(1, "starts"), ends = Numbers(2, "ends"), steps = Numbers(4, "");
    auto axes = Numbers(3, "axes");
    if (axes.empty() && steps.empty())
      for (std::size_t i = 0; i < starts.size(); ++i) axes.push_back(static_cast<std::int64_t>(i));
    if (starts.empty() || starts.size() != ends.size() || starts.size() != axes.size() ||
        (!steps.empty() && steps.size() != axes.size()))
      Refuse(fmt::format("has {} starts, {} ends, {} axes and {} steps", starts.size(), ends.size(),
                         axes.size(), steps.size()),
             "equal numbers");
    std::int64_t last = -1;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const std::size_t axis = Axis(axes[i], out.size());
      const std::int64_t side = X()[axis], step = steps.empty() ? 1 : steps[i];
      if (static_cast<std::int64_t>(axis) <= last || step < 1)
        Refuse("has axes that do not ascend, or steps below 1", "ascending ones, steps from 1 on");
      last = static_cast<std::int64_t>(axis);
      const std::int64_t begin =
                             std::clamp<std::int64_t>(starts[i] < 0 ? starts[i] + side : starts[i], 0, side),
                         end = std::clamp<std::int64_t>(ends[i] < 0 ? ends[i] + side : ends[i], 0, side);
      out[axis] = (end - begin + step - 1) / step;
      if (end <= begin)
        Refuse(fmt::format("takes {} .. {} of side {} of {}", starts[i], ends[i], axis, Text(X())),
               "what is there");
    }
    return out;
  }

  OnnxSides Gather() const {
    OnnxSides out = X();
    const std::vector<std::int64_t> at = Numbers(1, "");
    const std::size_t axis = Axis(static_cast<std::int64_t>(node_.Number("axis", 0)), out.size());
    AskRank(out, 4, 4);
    if (Constant(1) == nullptr || at.size() != 1 || at[0] < 0 || at[0] >= out[axis])
      Refuse(fmt::format("takes {} of side {} of {}", Text(at), axis, Text(out)),
             "one constant index from 0 on, or a Slice");
    out[axis] = 1;
    if (X(1).empty()) out.erase(out.begin() + static_cast<std::ptrdiff_t>(axis));
    return out;
  }

  OnnxSides Reduce() const {
    OnnxSides out = X();
    AskRank(out, 2, 4);
    std::vector<std::int64_t> axes = Numbers(1, "axes");
    if (axes.empty())
      for (std::size_t i = 0; i < out.size(); ++i) axes.push_back(static_cast<std::int64_t>(i));
    for (const std::int64_t axis : axes)
      out[Axis(axis, out.size())] = node_.Number("keepdims", 1) != 0 ? 1 : 0;
    std::erase(out, 0);
    return out;
  }

  OnnxSides Resize() const {
    AskRank(X(), 4, 4);
    const std::vector<double> asked = Asked();
    OnnxSides out = X();
    for (std::size_t i = 0; i < 4; ++i) {
      if (!(asked[i] >= 1.0 && asked[i] < static_cast<double>(onnx::kMostElements)))
        Refuse(fmt::format("makes {:g} of a side", asked[i]), "1 or more");
      constexpr double kSingle = 1e-5;  // of a scale
      const bool whole = std::abs(asked[i] - std::round(asked[i])) < kSingle * asked[i];
      out[i] = static_cast<std::int64_t>(whole ? std::round(asked[i]) : std::floor(asked[i]));
      if (out[i] < 1 || (i < 2 && out[i] != X()[i]) || !IsRead(X()[i], out[i], whole))
        Refuse(fmt::format("makes {:g} of side {} of {}", asked[i], i, Text(X())),
               "scales that give whole heights and widths, with nearest whole multiples (doubled, with "
               "round_prefer_floor), with pytorch_half_pixel 2 or more");
    }
    return out;
  }

  // The sides, which scales may give in parts.
  std::vector<double> Asked() const {
    const bool of_old = node_.inputs.size() == 2;
    if (of_old && node_.op == "Resize" && around_.opset > 10) Refuse("has no scales", "scales or sizes");
    if (node_.HasInput(3)) {
      const std::vector<std::int64_t> sizes = Numbers(3, "");
      if (sizes.size() != 4) Refuse("has no four sizes", "four");
      return {sizes.begin(), sizes.end()};
    }
    const OnnxConstant* scales = Constant(of_old ? 1 : 2);
    if (scales == nullptr || scales->floats.size() != 4) Refuse("has no four scales", "four");
    std::vector<double> asked;
    for (std::size_t i = 0; i < 4; ++i)
      asked.push_back(static_cast<double>(scales->floats[i]) * static_cast<double>(X()[i]));
    return asked;
  }

  // OpenCV goes by the sizes, and always by the floor of asymmetric coordinates.
  bool IsRead(std::int64_t from, std::int64_t to, bool whole) const {
    const std::string coordinates = node_.Word("coordinate_transformation_mode", "half_pixel");
    if (coordinates == "pytorch_half_pixel" && to == 1 && from > 1)
      return false;  // the first, not the middle
    if (node_.Word("mode", "nearest") == "linear") return whole || coordinates == "align_corners";
    if (node_.inputs.size() == 2 || node_.Word("nearest_mode", "") == "floor")
      return whole && (to % from == 0 || from % to == 0);
    return whole && to % from == 0 && (coordinates == "half_pixel" || to <= 2 * from);
  }
};

}  // namespace

std::vector<OnnxSides> ArrangedSides(const ShapeStep& step, OnnxRule rule) {
  return Arranged(step).Sides(rule);
}

}  // namespace ed3r::perception
