#include "engine/perception/vision/onnx/forms.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>

#include "engine/core/check.h"

namespace ed3r::perception {
namespace {

// Inputs: forms parted by |, a letter for each: x computed, c constant of float, i of whole numbers, n whole numbers
// (constant, or from shapes), - left out; ? behind it: may be left out; * behind it: any number of them, also none.
// Attributes: alone with any value, or = the allowed values parted by |; ! behind them: must be given.
struct Form {
  std::string_view op, inputs, attributes;
  OnnxRule rule;
};

constexpr std::int64_t kOldestOpset = 6, kNewestOpset = 23;
constexpr char kNothing[] = "";
constexpr char kReduce[] = "axes keepdims noop_with_empty_axes=0";
constexpr char kNearest[] =
    "mode=nearest! coordinate_transformation_mode=asymmetric! nearest_mode=floor|round_prefer_floor "
    "antialias=0 exclude_outside=0 cubic_coeff_a extrapolation_value";
constexpr char kNearestHalf[] =
    "mode=nearest! coordinate_transformation_mode=half_pixel nearest_mode=round_prefer_floor antialias=0 "
    "exclude_outside=0 cubic_coeff_a extrapolation_value";
constexpr char kLinear[] =
    "mode=linear! coordinate_transformation_mode=half_pixel|pytorch_half_pixel|align_corners|asymmetric "
    "nearest_mode antialias=0 exclude_outside=0 cubic_coeff_a extrapolation_value";
constexpr char kConvolution[] = "kernel_shape! strides pads dilations group auto_pad=NOTSET|VALID|SAME_UPPER";
constexpr char kPool[] =
    "kernel_shape! strides pads auto_pad=NOTSET|VALID|SAME_UPPER ceil_mode count_include_pad storage_order=0 "
    "dilations=1";

constexpr Form kForms[] = {
    {"Abs", "x", kNothing, OnnxRule::kSame},
    {"Add", "xx|xc|cx", kNothing, OnnxRule::kSpread},
    {"AveragePool", "x", kPool, OnnxRule::kPool},
    {"BatchNormalization", "xcccc", "epsilon momentum spatial=1 training_mode=0", OnnxRule::kOfChannels},
    {"Cast", "x", "to=1|10|11", OnnxRule::kSame},
    {"Cast", "n", "to=1|6|7", OnnxRule::kNumbers},
    {"Ceil", "x", kNothing, OnnxRule::kSame},
    {"Celu", "x", "alpha", OnnxRule::kSame},
    {"Clip", "xc?c?", "min max", OnnxRule::kSame},
    {"Concat", "xxx*", "axis!", OnnxRule::kConcat},
    {"Concat", "n*", "axis=0!", OnnxRule::kNumbers},
    {"Constant", kNothing, "value!", OnnxRule::kConstant},
    {"Conv", "xcc?", kConvolution, OnnxRule::kConv},
    {"ConvTranspose", "xcc?",
     "kernel_shape! strides pads output_padding group dilations=1 auto_pad=NOTSET|VALID",
     OnnxRule::kConvTranspose},
    {"Cos", "x", kNothing, OnnxRule::kSame},
    {"Div", "xx|xc|cx", kNothing, OnnxRule::kSpread},
    {"Div", "nn", kNothing, OnnxRule::kNumbers},
    {"Dropout", "xc?", "ratio seed", OnnxRule::kSame},
    {"Elu", "x", "alpha", OnnxRule::kSame},
    {"Erf", "x", kNothing, OnnxRule::kSame},
    {"Exp", "x", kNothing, OnnxRule::kSame},
    {"Flatten", "x", "axis", OnnxRule::kFlatten},
    {"Floor", "x", kNothing, OnnxRule::kSame},
    {"Gather", "xi", "axis", OnnxRule::kGather},
    {"Gather", "ni", "axis=0", OnnxRule::kNumbers},
    {"Gemm", "xcc?", "alpha=1 beta=1 transA=0 transB=0|1", OnnxRule::kGemm},
    {"GlobalAveragePool", "x", kNothing, OnnxRule::kGlobal},
    {"GlobalMaxPool", "x", kNothing, OnnxRule::kGlobal},
    {"HardSigmoid", "x", "alpha beta", OnnxRule::kSame},
    {"HardSwish", "x", kNothing, OnnxRule::kSame},
    {"Identity", "x", kNothing, OnnxRule::kSame},
    {"InstanceNormalization", "xcc", "epsilon", OnnxRule::kOfChannels},
    {"LRN", "x", "size alpha beta bias", OnnxRule::kOfChannels},
    {"LeakyRelu", "x", "alpha", OnnxRule::kSame},
    {"Log", "x", kNothing, OnnxRule::kSame},
    {"LogSoftmax", "x", "axis", OnnxRule::kSoftmax},
    {"MatMul", "xx|xc", kNothing, OnnxRule::kMatMul},
    {"Max", "xxx*", kNothing, OnnxRule::kSpread},
    {"MaxPool", "x", kPool, OnnxRule::kPool},
    {"Min", "xxx*", kNothing, OnnxRule::kSpread},
    {"Mish", "x", kNothing, OnnxRule::kSame},
    {"Mul", "xx|xc|cx", kNothing, OnnxRule::kSpread},
    {"Mul", "nn", kNothing, OnnxRule::kNumbers},
    {"Neg", "x", kNothing, OnnxRule::kSame},
    {"PRelu", "xc", kNothing, OnnxRule::kPRelu},
    {"Pad", "xi?c?", "mode=constant|reflect|edge pads value", OnnxRule::kPad},
    {"Pow", "xc|xi", kNothing, OnnxRule::kSpread},
    {"Reciprocal", "x", kNothing, OnnxRule::kSame},
    {"ReduceL1", "xi?", kReduce, OnnxRule::kReduce},
    {"ReduceL2", "xi?", kReduce, OnnxRule::kReduce},
    {"ReduceLogSum", "xi?", kReduce, OnnxRule::kReduce},
    {"ReduceLogSumExp", "xi?", kReduce, OnnxRule::kReduce},
    {"ReduceMax", "xi?", kReduce, OnnxRule::kReduce},
    {"ReduceMean", "xi?", kReduce, OnnxRule::kReduce},
    {"ReduceMin", "xi?", kReduce, OnnxRule::kReduce},
    {"ReduceSum", "xi?", kReduce, OnnxRule::kReduce},
    {"ReduceSumSquare", "xi?", kReduce, OnnxRule::kReduce},
    {"Relu", "x", kNothing, OnnxRule::kSame},
    {"Reshape", "xn", "allowzero=0|1", OnnxRule::kReshape},
    {"Resize", "xc|xc?c|xc?-i|xc?ci", kNearest, OnnxRule::kResize},
    {"Resize", "xc|xc?c|xc?-i|xc?ci", kNearestHalf, OnnxRule::kResize},
    {"Resize", "xc?c|xc?-i|xc?ci", kLinear, OnnxRule::kResize},
    {"Round", "x", kNothing, OnnxRule::kSame},
    {"Selu", "x", "alpha gamma", OnnxRule::kSame},
    {"Shape", "x", kNothing, OnnxRule::kShape},
    {"Shrink", "x", "bias lambd", OnnxRule::kSame},
    {"Sigmoid", "x", kNothing, OnnxRule::kSame},
    {"Sign", "x", kNothing, OnnxRule::kSame},
    {"Sin", "x", kNothing, OnnxRule::kSame},
    {"Slice", "x|xiii?i?", "starts ends axes", OnnxRule::kSlice},
    {"Slice", "niii?", kNothing, OnnxRule::kNumbers},
    {"Softmax", "x", "axis", OnnxRule::kSoftmax},
    {"Softplus", "x", kNothing, OnnxRule::kSame},
    {"Softsign", "x", kNothing, OnnxRule::kSame},
    {"Split", "xi?", "axis split num_outputs", OnnxRule::kSplit},
    {"Sqrt", "x", kNothing, OnnxRule::kSame},
    {"Squeeze", "xi?", "axes", OnnxRule::kSqueeze},
    {"Sub", "xx|xc|cx", kNothing, OnnxRule::kSpread},
    {"Sum", "xxx*", kNothing, OnnxRule::kSpread},
    {"Tanh", "x", kNothing, OnnxRule::kSame},
    {"ThresholdedRelu", "x", "alpha", OnnxRule::kSame},
    {"Transpose", "x", "perm", OnnxRule::kTranspose},
    {"Unsqueeze", "xi?", "axes", OnnxRule::kUnsqueeze},
    {"Unsqueeze", "ni?", "axes", OnnxRule::kNumbers},
    {"Upsample", "xc", "mode=nearest!", OnnxRule::kResize},
};

// What attributes hold by their names; whole numbers for those that are in none.
constexpr std::string_view kFloats[] = {
    "alpha", "beta", "bias",     "cubic_coeff_a", "epsilon", "extrapolation_value", "gamma", "lambd",
    "max",   "min",  "momentum", "ratio",         "value"};
constexpr std::string_view kLists[] = {"axes", "dilations", "ends",  "kernel_shape", "output_padding",
                                       "pads", "perm",      "split", "starts",       "strides"};
constexpr std::string_view kTexts[] = {"auto_pad", "coordinate_transformation_mode", "mode", "nearest_mode"};

std::vector<std::string> Parted(std::string_view text, char by) {
  std::vector<std::string> parts;
  std::istringstream in{std::string(text)};
  for (std::string part; std::getline(in, part, by);) parts.push_back(part);
  if (parts.empty()) parts.emplace_back();
  return parts;
}

bool IsKind(char kind, char wanted) { return kind == wanted || (wanted == 'n' && kind == 'i'); }

bool AreInputs(std::string_view kinds, std::string_view wanted) {
  if (wanted.empty()) return kinds.find_first_not_of('-') == std::string_view::npos;
  const char mark = wanted.size() > 1 ? wanted[1] : ' ';
  const bool fits = !kinds.empty() && IsKind(kinds.front(), wanted.front());
  if (mark == '*') return kinds.empty() || (fits && AreInputs(kinds.substr(1), wanted));
  if (mark == '?') {
    const bool left_out = kinds.empty() || kinds.front() == '-';
    if (!fits && !left_out) return AreInputs(kinds, wanted.substr(2));
    return AreInputs(kinds.substr(std::min<std::size_t>(1, kinds.size())), wanted.substr(2));
  }
  return fits && AreInputs(kinds.substr(1), wanted.substr(1));
}

std::string Words(std::string_view inputs) {
  std::vector<std::string> words;
  for (const char letter : inputs) switch (letter) {
      case 'x':
        words.emplace_back("computed");
        break;
      case 'c':
        words.emplace_back("constant floats");
        break;
      case 'i':
        words.emplace_back("constant whole numbers");
        break;
      case 'o':
        words.emplace_back("constant of another type");
        break;
      case 'n':
        words.emplace_back("whole numbers");
        break;
      case '-':
        words.emplace_back("nothing");
        break;
      case '|':
        words.emplace_back("or");
        break;
      default:
        words.emplace_back(letter == '?' ? "(or nothing)" : "(and more)");
    }
  return words.empty() ? "nothing" : fmt::format("{}", fmt::join(words, " "));
}

struct Mismatch {
  int alike = 0;  // how much stands as the form has it
  std::string why;
};

// The part of a form's attributes that tells of one: "mode=linear!"; empty for none.
std::string RuleFor(const Form& form, const std::string& attribute) {
  for (const std::string& part : Parted(form.attributes, ' '))
    if (part.substr(0, part.find_first_of("=!")) == attribute) return part;
  return "";
}

// What is wrong with what the attribute holds: OpenCV takes for 0 what it does not look for there.
std::string WrongKind(const OnnxNode& node, const std::string& name, OnnxHeld held) {
  const auto is_in = [&](const auto& names) {
    return std::find(std::begin(names), std::end(names), name) != std::end(names);
  };
  std::pair<OnnxHeld, const char*> wanted = {OnnxHeld::kInt, "a whole number"};
  if (is_in(kFloats)) wanted = {OnnxHeld::kFloat, "a float"};
  if (is_in(kLists)) wanted = {OnnxHeld::kInts, "a list of whole numbers"};
  if (is_in(kTexts)) wanted = {OnnxHeld::kText, "a text"};
  if (node.op == "Constant") wanted = {OnnxHeld::kTensor, "a tensor"};
  if (held == wanted.first || held == OnnxHeld::kNothing) return "";
  return fmt::format("has {} that is not {}; allowed: {}", name, wanted.second, wanted.second);
}

// "auto_pad = NOTSET or VALID, group".
std::string Plain(std::string_view attributes) {
  std::vector<std::string> words;
  for (std::string part : Parted(attributes, ' ')) {
    if (part.ends_with('!')) part.pop_back();
    const std::size_t equals = part.find('=');
    words.push_back(part.substr(0, equals));
    if (equals != std::string::npos)
      words.back() += fmt::format(" = {}", fmt::join(Parted(part.substr(equals + 1), '|'), " or "));
  }
  return attributes.empty() ? "none" : fmt::format("{}", fmt::join(words, ", "));
}

// Nothing if all is as the form says.
std::optional<Mismatch> MismatchOf(const Form& form, const OnnxNode& node, const std::string& kinds) {
  std::string why;
  int alike = 0;
  for (const auto& [name, attribute] : node.attributes) {
    std::string rule = RuleFor(form, name);
    if (rule.ends_with('!')) rule.pop_back();
    const std::size_t equals = rule.find('=');
    const std::vector<std::string> values = attribute.Values(),
                                   allowed = Parted(rule.substr(std::min(equals, rule.size() - 1) + 1), '|');
    const auto stray = std::find_if(values.begin(), values.end(), [&](const std::string& value) {
      return std::find(allowed.begin(), allowed.end(), value) == allowed.end();
    });
    if (rule.empty())
      why = fmt::format("has {} = {}; allowed attributes: {}", name, fmt::join(values, ", "),
                        Plain(form.attributes));
    else if (const std::string wrong = WrongKind(node, name, attribute.held); !wrong.empty())
      why = wrong;
    else if (equals != std::string::npos && stray != values.end())
      why = fmt::format("has {} = {}; allowed: {}", name, *stray, fmt::join(allowed, ", "));
    else
      ++alike;
  }
  for (const std::string& part : Parted(form.attributes, ' ')) {
    const std::string name = part.substr(0, part.find_first_of("=!"));
    if (part.ends_with('!') && !node.Has(name) && why.empty())
      why = fmt::format("has no {}; allowed: {}", name, Plain(part));
  }
  const std::vector<std::string> inputs = Parted(form.inputs, '|');
  if (std::any_of(inputs.begin(), inputs.end(),
                  [&](const std::string& wanted) { return AreInputs(kinds, wanted); }))
    alike += 100;
  else
    why = fmt::format("takes {}; allowed: {}", Words(kinds), Words(form.inputs));
  if (why.empty()) return std::nullopt;
  return Mismatch{alike, why};
}

std::string AllOperators() {
  std::set<std::string_view> names;
  for (const Form& form : kForms) names.insert(form.op);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

OnnxRule RuleOf(const OnnxNode& node, const std::string& kinds, std::int64_t opset, const std::string& name) {
  if (opset < kOldestOpset || opset > kNewestOpset)
    throw UserError(fmt::format("{}: has operators of version (opset) {}; allowed: {} .. {}", name, opset,
                                kOldestOpset, kNewestOpset));
  const bool own = node.domain.empty() || node.domain == "ai.onnx";
  Mismatch nearest{
      -1, "is not among those that OpenCV is known to read as the standard says; allowed: " + AllOperators()};
  for (const Form& form : kForms) {
    if (!own || form.op != node.op) continue;
    const std::optional<Mismatch> mismatch = MismatchOf(form, node, kinds);
    if (!mismatch) return form.rule;
    if (mismatch->alike > nearest.alike) nearest = *mismatch;
  }
  throw UserError(fmt::format("{}: operator {} {}", name, node.Text(), nearest.why));
}

}  // namespace ed3r::perception
