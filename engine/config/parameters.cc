#include "engine/config/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "engine/core/check.h"
#include "engine/core/parse_number.h"
#include "engine/core/suggest.h"

namespace ed3r {
namespace {

template <class T>
std::string Allowed(const FieldInfo& info) {
  if constexpr (std::is_same_v<T, bool>) {
    return "true | false";
  } else if constexpr (std::is_enum_v<T>) {
    std::string names;
    for (const auto& entry : EnumNames<T>::kNames)
      names += (names.empty() ? "" : " | ") + std::string(entry.name);
    return names;
  } else if constexpr (std::is_same_v<T, std::string>) {
    return "text";
  } else {
    return fmt::format("{:g} .. {:g}", info.min, info.max);
  }
}

template <class T>
std::string ToText(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return std::string(NameOf(value));
  } else {
    return fmt::format("{}", value);  // shortest text that reads back to the same bits
  }
}

template <class T>
std::optional<T> FromText(std::string_view text, const FieldInfo& info) {
  if constexpr (std::is_same_v<T, bool>) {
    if (text == "true") return true;
    if (text == "false") return false;
    return std::nullopt;
  } else if constexpr (std::is_enum_v<T>) {
    for (const auto& entry : EnumNames<T>::kNames)
      if (entry.name == text) return entry.value;
    return std::nullopt;
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (text.empty() || text.find('\n') != std::string_view::npos) return std::nullopt;
    return std::string(text);
  } else {
    const std::optional<T> value = ParseNumber<T>(WithoutPlus(text));
    if (!value) return std::nullopt;
    const double number = static_cast<double>(*value);
    if (!std::isfinite(number) || number < info.min || number > info.max) return std::nullopt;
    return value;
  }
}

// Walks a description with the dotted prefix of nested structs; Action is called with (key, field, info).
template <class Action>
class Walker {
 public:
  explicit Walker(Action action) : action_(action) {}

  template <class T>
  void operator()(std::string_view name, T& field, const FieldInfo& info) {
    action_(prefix_ + std::string(name), field, info);
  }

  template <class T>
  void Nested(std::string_view name, T& subject) {
    const std::size_t length = prefix_.size();
    prefix_ += std::string(name) + ".";
    std::remove_const_t<T>::Describe(subject, *this);
    prefix_.resize(length);
  }

 private:
  Action action_;
  std::string prefix_;
};

template <class ConfigType, class Action>
void ForEachField(ConfigType& config, Action action) {
  Walker<Action> walker(action);
  Config::Describe(config, walker);
}

std::vector<ParameterInfo> ListParameters() {
  std::vector<ParameterInfo> list;
  const Config defaults;
  ForEachField(defaults, [&](const std::string& key, const auto& field, const FieldInfo& info) {
    list.push_back({key, std::string(info.unit), ToText(field), Allowed<std::decay_t<decltype(field)>>(info),
                    std::string(info.source), std::string(info.meaning), info.scope, info.is_file,
                    std::string(info.or_else), info.min, info.max});
  });
  return list;
}

}  // namespace

const std::vector<ParameterInfo>& Parameters() {
  static const std::vector<ParameterInfo> list = ListParameters();
  return list;
}

const std::vector<std::string>& ParameterKeys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> result;
    for (const ParameterInfo& parameter : Parameters()) result.push_back(parameter.key);
    return result;
  }();
  return keys;
}

const ParameterInfo& ParameterOf(std::string_view key) {
  const std::vector<ParameterInfo>& all = Parameters();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const ParameterInfo& info) { return info.key == key; });
  ED3R_CHECK(found != all.end(), std::string(key));
  return *found;
}

std::string SetParameter(Config& config, std::string_view key, std::string_view value, Scope scope) {
  std::optional<std::string> problem;
  ForEachField(config, [&](const std::string& name, auto& field, const FieldInfo& info) {
    if (name != key) return;
    using T = std::decay_t<decltype(field)>;
    if (info.scope == Scope::kPhysicsOnly && scope != Scope::kPhysicsOnly) {
      problem =
          fmt::format("{}: is a value of 'ed3r physics' only; in a mission it is drawn per timestep", name);
      return;
    }
    if (const std::optional<T> parsed = FromText<T>(value, info)) {
      field = *parsed;
      problem = "";
    } else {
      problem = fmt::format("{}: '{}' is not allowed; allowed: {}{}{}", name, value, Allowed<T>(info),
                            info.unit.empty() ? "" : " ", info.unit);
    }
  });
  if (problem) return *problem;
  const std::string nearest = NearestWord(key, ParameterKeys());
  return nearest.empty() ? fmt::format("{}: unknown key; 'ed3r params' lists all", key)
                         : fmt::format("{}: unknown key; did you mean {}?", key, nearest);
}

std::string GetParameter(const Config& config, std::string_view key) {
  std::optional<std::string> text;
  ForEachField(config, [&](const std::string& name, const auto& field, const FieldInfo&) {
    if (name == key) text = ToText(field);
  });
  ED3R_CHECK(text.has_value(), std::string(key));
  return *text;
}

std::string CheckParameters(const Config& c) {
  const auto ordered = [](std::string_view low_key, double low, std::string_view high_key, double high) {
    return low <= high
               ? std::string()
               : fmt::format("{}: '{}' is not allowed; at most {} = {}", low_key, low, high_key, high);
  };
  for (const std::string& problem :
       {ordered("cpu.frequency_min_hz", c.cpu.frequency_min_hz, "cpu.frequency_max_hz",
                c.cpu.frequency_max_hz),
        ordered("radio.bandwidth_min_hz", c.radio.bandwidth_min_hz, "radio.bandwidth_max_hz",
                c.radio.bandwidth_max_hz),
        ordered("radio.efficiency_min", c.radio.efficiency_min, "radio.efficiency_max",
                c.radio.efficiency_max),
        ordered("radio.power_min_dbm", c.radio.power_min_dbm, "radio.power_max_dbm", c.radio.power_max_dbm),
        ordered("sensing.lidar_rate_hz", c.sensing.lidar_rate_hz, "mission.physics_hz", c.mission.physics_hz),
        ordered("agents.eta_int", c.agents.eta_int, "agents.eta_min", c.agents.eta_min)}) {
    if (!problem.empty()) return problem;
  }
  if (c.sensing.Frames() < 2)
    return fmt::format(
        "sensing.camera_fps: '{}' is not allowed; with sensing.period_s = {} it gives {} frames, at least 2",
        c.sensing.camera_fps, c.sensing.period_s, c.sensing.Frames());
  return "";
}

std::string CanonicalText(const Config& config) {
  std::string text;
  ForEachField(config, [&](const std::string& key, const auto& field, const FieldInfo& info) {
    if (info.scope == Scope::kMission) text += fmt::format("{}={}\n", key, ToText(field));
  });
  return text;
}

}  // namespace ed3r
