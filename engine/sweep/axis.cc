#include "engine/sweep/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "engine/config/parameters.h"
#include "engine/core/parse_number.h"
#include "engine/sweep/sweep_file.h"

namespace ed3r::sweep {
namespace {

struct WrittenValue {
  std::string text;
  std::string at;
};

std::optional<double> Number(std::string_view text) {
  const std::optional<double> value = ParseNumber<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

// Decimals of a number as written: 2 for 0.25, 3 for 1e-3, 0 for 20.
int Decimals(std::string_view number) {
  const std::size_t exponent_at = std::min(number.find_first_of("eE"), number.size());
  const std::size_t point = number.substr(0, exponent_at).find('.');
  int decimals = point == std::string_view::npos ? 0 : static_cast<int>(exponent_at - point - 1);
  if (exponent_at < number.size()) {
    std::string_view digits = number.substr(exponent_at + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    int exponent = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    constexpr int kExponents = 400;  // beyond those of a double; a zero may be written with any
    decimals -= std::clamp(exponent, -kExponents, kExponents);
  }
  return std::max(decimals, 0);
}

std::vector<WrittenValue> ReadValues(const YamlNode& node, const std::string& key) {
  std::vector<WrittenValue> values;
  if (node.kind == YamlNode::Kind::kMap) {
    ExpectKeys(node, key, {"range"});
    const YamlNode* range = Find(node, "range");
    if (range == nullptr)
      FailAt(node.at, fmt::format("{}: an empty map is not an axis; allowed: range", key));
    for (const std::string& text : RangeValues(*range, key)) values.push_back({text, range->at});
    return values;
  }
  if (node.kind != YamlNode::Kind::kList)
    FailAt(node.at, fmt::format("{}: {} is not an axis; allowed: a list of values or {{range: [first, last, "
                                "step]}} (a fixed value belongs under set)",
                                key, Described(node)));
  if (node.items.empty())
    FailAt(node.at, fmt::format("{}: an empty axis is not allowed; allowed: at least one value", key));
  for (const YamlNode& item : node.items) values.push_back({TextOf(item, key), item.at});
  return values;
}

Axis ReadGrid(const YamlEntry& entry, const SettingReader& reader) {
  Axis axis{{}, entry.at};
  // The key comes first: for a misspelt one, no form of the value is right.
  const auto& keys = ParameterKeys();
  const std::string key = FullKey(entry.key);
  if (key == kAirframeKey)
    FailAt(
        entry.at,
        "robot: is no axis: an airframe file sets many parameters; allowed: points of a list (list: [{name: "
        "mine, robot: FILE}, ...]), or one of its parameters (robot.mass_kg: [1.4, 1.8])");
  if (std::find(keys.begin(), keys.end(), key) == keys.end()) reader.Read(entry.key, entry.at, "", entry.at);
  for (const WrittenValue& value : ReadValues(entry.value, key))
    axis.points.push_back({"", {reader.Read(entry.key, entry.at, value.text, value.at)}, value.at});
  return axis;
}

Axis ReadZip(const YamlEntry& entry, const SettingReader& reader) {
  if (entry.value.kind != YamlNode::Kind::kMap || entry.value.entries.empty())
    FailAt(entry.value.at,
           fmt::format("zip: {} is not allowed; allowed: a map of parameters, each with a list "
                       "of as many values",
                       entry.value.entries.empty() && entry.value.kind == YamlNode::Kind::kMap
                           ? "an empty map"
                           : Described(entry.value)));
  Axis axis{{}, entry.at};
  for (const YamlEntry& column : entry.value.entries) {
    const Axis values = ReadGrid(column, reader);
    if (axis.points.empty()) {
      axis.points = values.points;
      continue;
    }
    if (values.points.size() != axis.points.size())
      FailAt(column.value.at, fmt::format("zip: {} has {} values and {} has {}; allowed: as many of each",
                                          values.points[0].settings[0].key, values.points.size(),
                                          axis.points[0].settings[0].key, axis.points.size()));
    for (const Setting& other : axis.points[0].settings) {
      if (other.key == values.points[0].settings[0].key)
        FailAt(column.at, fmt::format("{}: duplicate key; it stands first at {}", other.key, other.at));
    }
    for (std::size_t i = 0; i < axis.points.size(); ++i)
      axis.points[i].settings.push_back(values.points[i].settings[0]);
  }
  return axis;
}

Axis ReadList(const YamlEntry& entry, const SettingReader& reader) {
  if (entry.value.kind != YamlNode::Kind::kList || entry.value.items.empty())
    FailAt(entry.value.at,
           fmt::format("list: {} is not allowed; allowed: a list of points {{name: ..., KEY: VALUE, ...}}",
                       entry.value.kind == YamlNode::Kind::kList ? "an empty list" : Described(entry.value)));
  Axis axis{{}, entry.at};
  for (const YamlNode& item : entry.value.items) {
    AxisPoint point{"", reader.ReadMap(item, "list", {"name"}), item.at};
    if (const YamlNode* name = Find(item, "name")) point.name = NameOfThing(*name, "name");
    axis.points.push_back(std::move(point));
  }
  return axis;
}

}  // namespace

std::vector<Axis> ReadAxes(const YamlNode& sweep, const SettingReader& reader) {
  if (sweep.kind != YamlNode::Kind::kMap)
    FailAt(sweep.at, fmt::format("sweep: {} is not allowed; allowed: a map of axes", Described(sweep)));
  std::vector<Axis> axes;
  for (const YamlEntry& entry : sweep.entries) {
    if (entry.key == "zip") {
      axes.push_back(ReadZip(entry, reader));
    } else if (entry.key == "list") {
      axes.push_back(ReadList(entry, reader));
    } else {
      axes.push_back(ReadGrid(entry, reader));
    }
  }
  return axes;
}

std::vector<std::string> RangeValues(const YamlNode& range, const std::string& key) {
  const auto refuse = [&](const std::string& problem) {
    FailAt(range.at, fmt::format("{}: {}; allowed: range: [first, last, step], three numbers", key, problem));
  };
  if (range.kind != YamlNode::Kind::kList) refuse(Described(range) + " is not a range");
  if (range.items.size() != 3) refuse(fmt::format("a range of {} values is not allowed", range.items.size()));
  double numbers[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<double> number = Number(TextOf(range.items[i], key));
    if (!number) refuse(fmt::format("'{}' is not a number", range.items[i].text));
    numbers[i] = *number;
  }
  const auto [first, last, step] = numbers;
  const double steps = (last - first) / step;
  if (step == 0.0 || !(steps >= 0.0))
    refuse(fmt::format("step '{}' does not lead from {} to {}", range.items[2].text, range.items[0].text,
                       range.items[1].text));
  constexpr double kRounding = 1e-9;  // of a step; 3.0 .. 4.0 by 0.2 is 4.999... steps
  const double count = std::floor(steps * (1.0 + kRounding) + kRounding) + 1.0;
  if (count > kMaxArms)
    FailAt(range.at, fmt::format("{}: a range of {:.0f} values is not allowed; allowed: at most {}", key,
                                 count, kMaxArms));
  constexpr int kDecimalsOfDouble = 17;
  const int decimals = std::max(Decimals(range.items[0].text), Decimals(range.items[2].text));
  std::vector<std::string> values;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const double value = first + i * step;
    const std::string text =
        decimals > kDecimalsOfDouble ? fmt::format("{}", value) : fmt::format("{:.{}f}", value, decimals);
    // Rounding can leave "-0.0", which is another value than 0.
    const bool is_zero = text.find_first_of("123456789") == std::string::npos;
    values.push_back(is_zero ? std::string("0") : text);
  }
  return values;
}

const Setting* FindOnAxes(const std::vector<Axis>& axes, std::string_view key) {
  for (const Axis& axis : axes)
    for (const AxisPoint& point : axis.points)
      for (const Setting& setting : point.settings)
        if (setting.key == key) return &setting;
  return nullptr;
}

void CheckAxesDiffer(const std::vector<Axis>& axes) {
  std::map<std::string, std::string> owners;
  for (const Axis& axis : axes) {
    std::map<std::string, std::string> keys;
    for (const AxisPoint& point : axis.points)
      for (const Setting& setting : point.settings) {
        keys.emplace(setting.key, setting.at);
        if (!setting.airframe_at.empty()) keys.emplace(kAirframeKey, setting.airframe_at);
      }
    for (const auto& [key, at] : keys) {
      const auto [first, is_new] = owners.emplace(key, at);
      if (!is_new) FailAt(at, fmt::format("{}: is on another axis, too, at {}", key, first->second));
    }
  }
}

}  // namespace ed3r::sweep
