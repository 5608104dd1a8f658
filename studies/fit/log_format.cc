#include "studies/fit/log_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <sstream>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/core/suggest.h"

namespace ed3r {
namespace {

struct BuiltIn {
  const char* name;
  const char* yaml;
};

constexpr BuiltIn kBuiltIn[] = {{"m100", R"(# DJI Matrice 100, Rodrigues et al. 2021 (Scientific Data 8:155)
columns:
  flight: flight
  time_s: time
  power_w: power
  airspeed_mps: airspeed
  altitude_m: diffalt
  climb_mps: vertspd
  air_density_kgm3: density
  payload_kg: payload
climb_from: altitude
hover: {max_speed_mps: 3, max_climb_mps: 0.4}
robot:
  mass_kg: 3.68
  propellers: 4
  propeller_radius_m: 0.17
  height_m: 0.26
  width_m: 0.46
  depth_m: 0.46
  battery_mah: 4500
  battery_v: 22.2
notes:
  - climb rate is the slope of the altitude, because the recorded vertical speed drifts with airspeed
  - airframe from secondary sources (3.68 kg without payload, propellers of 0.34 m, TB47D battery); body size is approximate
)"},
                                {"ardupilot", R"(# ArduPilot quadrotor on four cells (dronekit-la-testdata)
columns:
  time_s: time_s
  voltage_v: battery_voltage_v
  current_a: battery_current_a
  ground_speed_mps: ground_speed_mps
  climb_mps: gps_climb_mps
  altitude_m: altitude_m
in_flight: {throttle_0_1000: 100, altitude_m: 2}
hover: {max_speed_mps: 1, max_climb_mps: 0.4}
notes:
  - mass and airframe are not recorded; robot.* defaults (the paper's Iris) stand in, and the efficiency scales with them
  - ground speed stands in for airspeed
)"}};

const std::vector<std::string> kMeanings = {"flight",     "time_s",           "power_w",          "voltage_v",
                                            "current_a",  "airspeed_mps",     "ground_speed_mps", "climb_mps",
                                            "altitude_m", "air_density_kgm3", "payload_kg",       "mass_kg"};
const std::vector<std::string> kKeys = {
    "columns",   "units", "climb_from", "climb_window_s", "air_density_kgm3",
    "in_flight", "hover", "robot",      "notes"};

// Reads one document and keeps its name for messages.
class FormatReader {
 public:
  FormatReader(const std::string& name, const std::string& yaml) : name_(name) {
    format_.name = name;
    try {
      root_ = YAML::Load(yaml);
    } catch (const YAML::Exception& error) {
      throw UserError(
          fmt::format("{}:{}:{}: {}", name_, error.mark.line + 1, error.mark.column + 1, error.msg));
    }
  }

  LogFormat Read() {
    if (!root_.IsMap()) Fail(root_, "a map with 'columns' was expected");
    for (const auto& entry : root_) ReadKey(entry.first, entry.second);
    CheckColumns();
    return format_;
  }

 private:
  [[noreturn]] void Fail(const YAML::Node& node, const std::string& problem) const {
    throw UserError(
        fmt::format("{}:{}:{}: {}", name_, node.Mark().line + 1, node.Mark().column + 1, problem));
  }

  void CheckKnown(const YAML::Node& key, const std::vector<std::string>& known) const {
    const std::string word = key.Scalar();
    if (std::find(known.begin(), known.end(), word) != known.end()) return;
    const std::string nearest = NearestWord(word, known);
    Fail(key, nearest.empty() ? fmt::format("{}: unknown key; known: {}", word, fmt::join(known, ", "))
                              : fmt::format("{}: unknown key; did you mean {}?", word, nearest));
  }

  const YAML::Node& Map(const YAML::Node& key, const YAML::Node& value) const {
    if (!value.IsMap()) Fail(value, fmt::format("{}: a map was expected", key.Scalar()));
    return value;
  }

  std::string Text(const YAML::Node& key, const YAML::Node& value) const {
    if (!value.IsScalar() || value.Scalar().empty())
      Fail(value, fmt::format("{}: a text was expected", key.Scalar()));
    return value.Scalar();
  }

  double Number(const YAML::Node& key, const YAML::Node& value, double min, double max) const {
    double number = 0.0;
    if (!value.IsScalar() || !YAML::convert<double>::decode(value, number) ||
        !(number >= min && number <= max))
      Fail(value, fmt::format("{}: '{}' is not allowed; allowed: {:g} .. {:g}", key.Scalar(),
                              value.IsScalar() ? value.Scalar() : "(not a number)", min, max));
    return number;
  }

  void ReadKey(const YAML::Node& key, const YAML::Node& value) {
    CheckKnown(key, kKeys);
    const std::string word = key.Scalar();
    if (word == "columns") {
      for (const auto& [meaning, column] : Pairs(key, value)) {
        CheckKnown(meaning, kMeanings);
        format_.columns[meaning.Scalar()] = Text(meaning, column);
      }
    } else if (word == "units") {
      for (const auto& [meaning, factor] : Pairs(key, value)) {
        CheckKnown(meaning, kMeanings);
        format_.units[meaning.Scalar()] = Number(meaning, factor, -1e9, 1e9);
        if (format_.units[meaning.Scalar()] == 0.0) Fail(factor, "units: a factor of 0 loses the column");
      }
    } else if (word == "climb_from") {
      const std::string source = Text(key, value);
      if (source != "column" && source != "altitude")
        Fail(value, fmt::format("climb_from: '{}' is not allowed; allowed: column | altitude", source));
      format_.climb_from = source == "altitude" ? ClimbFrom::kAltitude : ClimbFrom::kColumn;
    } else if (word == "climb_window_s") {
      format_.climb_window_s = Number(key, value, 0.05, 30);
    } else if (word == "air_density_kgm3") {
      format_.air_density_kgm3 = Number(key, value, 0.3, 2);
    } else if (word == "in_flight") {
      for (const auto& [column, least] : Pairs(key, value))
        format_.in_flight[column.Scalar()] = Number(column, least, -1e12, 1e12);
    } else if (word == "hover") {
      ReadHover(key, value);
    } else if (word == "robot") {
      ReadRobot(key, value);
    } else {
      ReadNotes(key, value);
    }
  }

  std::vector<std::pair<YAML::Node, YAML::Node>> Pairs(const YAML::Node& key, const YAML::Node& value) const {
    std::vector<std::pair<YAML::Node, YAML::Node>> pairs;
    for (const auto& entry : Map(key, value)) pairs.emplace_back(entry.first, entry.second);
    return pairs;
  }

  void ReadHover(const YAML::Node& key, const YAML::Node& value) {
    for (const auto& [limit, number] : Pairs(key, value)) {
      CheckKnown(limit, {"max_speed_mps", "max_climb_mps"});
      (limit.Scalar() == "max_speed_mps" ? format_.hover_max_speed_mps : format_.hover_max_climb_mps) =
          Number(limit, number, 0.01, 20);
    }
  }

  void ReadRobot(const YAML::Node& key, const YAML::Node& value) {
    Config config;
    config.robot = format_.robot;
    for (const auto& [field, text] : Pairs(key, value)) {
      const std::string problem = SetParameter(config, "robot." + field.Scalar(), Text(field, text));
      if (!problem.empty()) Fail(text, problem);
    }
    format_.robot = config.robot;
  }

  void ReadNotes(const YAML::Node& key, const YAML::Node& value) {
    if (!value.IsSequence()) Fail(value, "notes: a list of texts was expected");
    for (const auto& note : value) format_.notes.push_back(Text(key, note));
  }

  void CheckColumns() const {
    const auto need = [this](bool there, const char* what) {
      if (!there) Fail(root_, fmt::format("columns: {}", what));
    };
    need(format_.Has("time_s"), "time_s is missing");
    need(format_.Has("power_w") || (format_.Has("voltage_v") && format_.Has("current_a")),
         "power_w is missing, and so is voltage_v or current_a");
    need(format_.Has("airspeed_mps") || format_.Has("ground_speed_mps"),
         "airspeed_mps is missing, and so is ground_speed_mps");
    need(!(format_.Has("payload_kg") && format_.Has("mass_kg")), "payload_kg and mass_kg exclude each other");
    if (format_.climb_from == ClimbFrom::kAltitude)
      need(format_.Has("altitude_m"), "altitude_m is missing (climb_from: altitude)");
    else
      need(format_.Has("climb_mps"), "climb_mps is missing (or set climb_from: altitude)");
  }

  std::string name_;
  YAML::Node root_;
  LogFormat format_;
};

}  // namespace

LogFormat ParseLogFormat(const std::string& name, const std::string& yaml) {
  return FormatReader(name, yaml).Read();
}

LogFormat LoadLogFormat(const std::string& name_or_path) {
  for (const BuiltIn& format : kBuiltIn)
    if (format.name == name_or_path) return ParseLogFormat(format.name, format.yaml);
  std::ifstream file(name_or_path);
  if (!file) {
    const std::string nearest = NearestWord(name_or_path, BuiltInLogFormats());
    throw UserError(fmt::format("--format: '{}' is neither a file nor a built-in format ({}){}", name_or_path,
                                fmt::join(BuiltInLogFormats(), ", "),
                                nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
  }
  std::ostringstream text;
  text << file.rdbuf();
  return ParseLogFormat(name_or_path, text.str());
}

std::vector<std::string> BuiltInLogFormats() {
  std::vector<std::string> names;
  for (const BuiltIn& format : kBuiltIn) names.emplace_back(format.name);
  return names;
}

}  // namespace ed3r
