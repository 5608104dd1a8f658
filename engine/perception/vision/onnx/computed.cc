#include <algorithm>
#include <cmath>

#include "engine/perception/vision/onnx/shape_step.h"

namespace ed3r::perception {
namespace {

class Computed : public ShapeStep {
 public:
  explicit Computed(const ShapeStep& step) : ShapeStep(step) {}

  std::vector<OnnxSides> Sides(OnnxRule rule) const {
    switch (rule) {
      case OnnxRule::kConv:
      case OnnxRule::kConvTranspose:
      case OnnxRule::kPool:
        return {Window(rule)};
      case OnnxRule::kOfChannels:
        return {OfChannels()};
      case OnnxRule::kGlobal:
        return {Global()};
      case OnnxRule::kSpread:
        return {Spread()};
      case OnnxRule::kPRelu:
        return {PRelu()};
      case OnnxRule::kSoftmax:
        return {Softmax()};
      case OnnxRule::kGemm:
      case OnnxRule::kMatMul:
        return {Product(rule)};
      case OnnxRule::kSame:
        return {X()};
      default:
        return {};
    }
  }

 private:
  OnnxSides OfChannels() const {
    const bool only_maps = node_.op != "BatchNormalization";
    AskRank(X(), only_maps ? 4 : 2, 4);
    for (std::size_t i = 1; i < node_.inputs.size(); ++i)
      if (X(i) != OnnxSides{X()[1]})
        Refuse(fmt::format("takes {} for {}", Text(X(i)), Text(X())), fmt::format("[{}]", X()[1]));
    return X();
  }

  OnnxSides Global() const {
    AskRank(X(), 3, 4);
    OnnxSides out = X();
    std::fill(out.begin() + 2, out.end(), 1);
    return out;
  }

  std::vector<std::int64_t> Two(const std::string& attribute, std::int64_t otherwise,
                                std::size_t count = 2) const {
    const std::vector<std::int64_t> found = node_.Numbers(attribute);
    if (!found.empty() && found.size() != count)
      Refuse(fmt::format("has {} of {} numbers", attribute, found.size()), std::to_string(count));
    return found.empty() ? std::vector<std::int64_t>(count, otherwise) : found;
  }

  // Convolutions and pools, of maps.
  OnnxSides Window(OnnxRule rule) const {
    AskRank(X(), 4, 4);
    const bool pool = rule == OnnxRule::kPool, transposed = rule == OnnxRule::kConvTranspose;
    const auto kernel = Two("kernel_shape", 1), strides = Two("strides", 1), dilations = Two("dilations", 1),
               pads = Two("pads", 0, 4), more = Two("output_padding", 0);
    const std::string pad = node_.Word("auto_pad", "NOTSET");
    const bool same = pad == "SAME_UPPER", ceil = node_.Number("ceil_mode", 0) != 0;
    const auto is_one = [](std::int64_t number) { return number == 1; };
    if (pad != "NOTSET" && pads != std::vector<std::int64_t>(4, 0))
      Refuse("has pads beside auto_pad = " + pad, "one of them");
    if (same && !std::all_of(dilations.begin(), dilations.end(), is_one))
      Refuse("has dilations beside auto_pad", "pads in numbers");
    if (pad != "NOTSET" && ceil) Refuse("has ceil_mode beside auto_pad", "pads in numbers");
    OnnxSides out = {X()[0], pool ? X()[1] : CheckWeights(kernel, transposed), 0, 0};
    for (std::size_t i = 0; i < 2; ++i) {
      const std::int64_t side = X()[2 + i], padded = side + pads[i] + pads[2 + i];
      const std::int64_t left = padded - dilations[i] * (kernel[i] - 1) - 1;
      out[2 + i] = transposed ? (side - 1) * strides[i] + kernel[i] + more[i] - pads[i] - pads[2 + i]
                   : same     ? (side + strides[i] - 1) / strides[i]
                              : (ceil ? left + strides[i] - 1 : left) / strides[i] + 1;
      if (out[2 + i] < 1 || (!transposed && !same && left < 0))
        Refuse("has a window that is larger than " + Text(X()), "smaller ones");
      const bool beyond = ceil && (out[2 + i] - 1) * strides[i] >= side + pads[i];
      if (beyond && pads[i] > 0 && pads[i] == pads[2 + i])
        --out[2 + i];
      else if (beyond)
        Refuse("has ceil_mode = 1 and a last window that begins beyond " + Text(X()),
               "ceil_mode = 0, or other strides");
    }
    return out;
  }

  // The channels that come out.
  std::int64_t CheckWeights(const std::vector<std::int64_t>& kernel, bool transposed) const {
    const OnnxSides& weights = X(1);
    const auto group = static_cast<std::int64_t>(node_.Number("group", 1));
    AskRank(weights, 4, 4);
    const std::int64_t in = transposed ? weights[0] : weights[1] * group,
                       out = transposed ? weights[1] * group : weights[0];
    if (group < 1 || in != X()[1] || out % group != 0 || in % group != 0 || weights[2] != kernel[0] ||
        weights[3] != kernel[1])
      Refuse(fmt::format("has weights {} in {} groups for {}", Text(weights), group, Text(X())),
             "as many channels, and kernel_shape");
    if (node_.HasInput(2) && X(2) != OnnxSides{out})
      Refuse(fmt::format("adds {}", Text(X(2))), fmt::format("[{}]", out));
    return out;
  }

  // How the sides of `small` stand to those of `large`, from the last on: = as it, 1 for one; "?" for anything else.
  static std::string Pattern(const OnnxSides& small, const OnnxSides& large) {
    std::string pattern;
    if (small.size() > large.size()) return "?";
    for (std::size_t i = 0; i < small.size(); ++i) {
      const std::int64_t side = large[large.size() - small.size() + i];
      pattern += small[i] == 1 ? '1' : small[i] == side ? '=' : '?';
    }
    return pattern;
  }

  // Operands that are not alike: OpenCV gives many the first one's shape, turns some round, and stops at others.
  OnnxSides Spread() const {
    const std::string& op = node_.op;
    const bool constant = Constant(0) != nullptr || Constant(1) != nullptr;
    const bool sum = op == "Add" || op == "Sub";
    for (std::size_t i = 2; i < node_.inputs.size(); ++i)
      if (X(i) != X(0) || X(1) != X(0)) Refuse("takes three operands that are not alike", "equal shapes");
    if (X(0) == X(1) && op != "Pow") return CheckOrder(X(0));
    const bool swapped = Constant(0) != nullptr || (!constant && op == "Mul" && Count(X(0)) < Count(X(1)));
    const OnnxSides &large = X(swapped ? 1 : 0), &small = X(swapped ? 0 : 1);
    const std::string pattern = Pattern(small, large);
    const bool one = constant && pattern.find_first_not_of('1') == std::string::npos;
    std::vector<std::string_view> allowed;
    if (op != "Pow" && op != "Max" && op != "Min" && op != "Sum") {
      if (large.size() == 4) allowed = {"1=11", "=11"};
      if (large.size() == 4 && (constant || sum)) allowed.insert(allowed.end(), {"===", "1==1"});
      if (large.size() == 4 && constant && sum) allowed.insert(allowed.end(), {"=", "=1", "=="});
      if (large.size() == 4 && !constant && !sum)
        allowed.insert(allowed.end(), {"11==", "1==1", "1=1=", "11=1", "=="});
      if (large.size() == 3 && constant) allowed.insert(allowed.end(), {"=1", "1=1", "=="});
      if (large.size() == 3 && constant && sum) allowed.insert(allowed.end(), {"="});
      if (large.size() == 2 && constant) allowed.insert(allowed.end(), {"="});
    }
    if (!one && std::find(allowed.begin(), allowed.end(), pattern) == allowed.end())
      Refuse(fmt::format("takes {} and {}", Text(X(0)), Text(X(1))),
             allowed.empty()
                 ? "equal shapes"
                 : fmt::format("equal shapes, or the second as {} of the first (= a side alike, 1 of one)",
                               fmt::join(allowed, ", ")));
    return CheckOrder(large);
  }

  const OnnxSides& CheckOrder(const OnnxSides& out) const {
    if (node_.op == "Div" && Constant(0) != nullptr && Count(X(0)) != 1)
      Refuse("divides a constant of several numbers by what is computed, which OpenCV turns round",
             "one number, or a Mul by the quotient of 1");
    return out;
  }

  OnnxSides PRelu() const {
    const OnnxSides &slopes = X(1), &sides = X();
    const std::int64_t number = Count(slopes);
    const std::string pattern = Pattern(slopes, sides);
    const bool by_channel = sides.size() == 4   ? pattern == "=11" || pattern == "1=11"
                            : sides.size() == 3 ? pattern == "=1" || pattern == "1=1"
                                                : sides.size() == 2 && (pattern == "=" || pattern == "1=");
    if (number != 1 && !by_channel)
      Refuse(fmt::format("has slopes {} for {}", Text(slopes), Text(sides)),
             "one slope, or one a channel: [channels, 1, 1] for maps");
    return sides;
  }

  // Before opset 13 the sides from the axis on counted as one.
  OnnxSides Softmax() const {
    const OnnxSides& sides = X();
    AskRank(sides, 2, 4);
    const bool flattens = around_.opset < 13;
    const std::size_t axis =
        Axis(static_cast<std::int64_t>(node_.Number("axis", flattens ? 1 : -1)), sides.size());
    if (flattens && Count(sides, axis + 1, sides.size()) != 1)
      Refuse(fmt::format("is taken of {} from side {} on as one (opset below 13), which OpenCV does not",
                         Text(sides), axis),
             "sides of 1 behind that, or a Flatten before");
    return sides;
  }

  OnnxSides Product(OnnxRule rule) const {
    const OnnxSides &left = X(0), &right = X(1);
    const bool gemm = rule == OnnxRule::kGemm, turned = gemm && node_.Number("transB", 0) == 1;
    AskRank(left, 2, gemm ? 2 : 4);
    const bool constant = Constant(1) != nullptr;
    const bool fit =
        constant ? right.size() == 2
                 : right.size() == left.size() && std::equal(left.begin(), left.end() - 2, right.begin());
    if (!fit || left.back() != right[right.size() - (turned ? 1 : 2)])
      Refuse(fmt::format("takes {} and {}", Text(left), Text(right)),
             "a matrix of constants, or alike but for the last two sides, as many rows as the first has "
             "columns");
    OnnxSides out = left;
    out.back() = right[right.size() - (turned ? 2 : 1)];
    if (gemm && node_.HasInput(2) && X(2) != OnnxSides{out.back()} && X(2) != OnnxSides{1, out.back()})
      Refuse(fmt::format("adds {}", Text(X(2))), fmt::format("[{}]", out.back()));
    return out;
  }
};

}  // namespace

std::vector<OnnxSides> ComputedSides(const ShapeStep& step, OnnxRule rule) {
  return Computed(step).Sides(rule);
}

}  // namespace ed3r::perception
