#include "studies/fit/log_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/yaml_reader.h"
#include "engine/core/parse_number.h"
#include "engine/core/suggest.h"

namespace ed3r::fit {
namespace {

struct BuiltIn {
  const char* name;
  const char* yaml;
};

constexpr BuiltIn kBuiltIn[] = {
    {"m100", R"(# DJI Matrice 100, Rodrigues et al. 2021 (Scientific Data 8:155)
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
robot: {mass_kg: 1.816, propellers: 4, propeller_radius_m: 0.1}
notes:
  - mass and airframe are not recorded; the paper's Iris stands in, and the efficiency scales with it
  - ground speed stands in for airspeed
)"},
    {"px4", R"(# PX4 ULog (studies/flight_logs/px4_log.h)
columns:
  time_s: time_s
  voltage_v: battery_voltage_v
  current_a: battery_current_a
  ground_speed_mps: ground_speed_mps
  climb_mps: climb_mps
  altitude_m: altitude_m
hover: {max_speed_mps: 1, max_climb_mps: 0.4}
notes:
  - ground speed stands in for airspeed
)"},
    {"dji", R"(# DJI flight exported by AirData (studies/flight_logs/airdata_log.h)
columns:
  time_s: time_s
  voltage_v: battery_voltage_v
  current_a: battery_current_a
  ground_speed_mps: ground_speed_mps
  climb_mps: climb_mps
  altitude_m: altitude_m
hover: {max_speed_mps: 1, max_climb_mps: 0.4}
)"}};

const std::vector<std::string> kMeanings = {"flight",     "time_s",           "power_w",          "voltage_v",
                                            "current_a",  "airspeed_mps",     "ground_speed_mps", "climb_mps",
                                            "altitude_m", "air_density_kgm3", "payload_kg",       "mass_kg"};
const std::vector<std::string> kKeys = {
    "columns",   "units", "climb_from", "climb_window_s", "air_density_kgm3",
    "in_flight", "hover", "robot",      "notes"};

using Entry = YamlEntry;

class FormatReader {
 public:
  FormatReader(const std::string& name, const std::string& yaml) : root_(ParseYaml(name, yaml).root) {
    format_.name = name;
  }

  LogFormat Read() {
    if (root_.kind != YamlNode::Kind::kMap) FailAt(root_.at, "a map with 'columns' was expected");
    for (const Entry& entry : root_.entries) ReadKey(entry);
    CheckColumns();
    return format_;
  }

 private:
  static void CheckKnown(const Entry& entry, const std::vector<std::string>& known) {
    if (std::find(known.begin(), known.end(), entry.key) != known.end()) return;
    const std::string nearest = NearestWord(entry.key, known);
    FailAt(entry.at, nearest.empty()
                         ? fmt::format("{}: unknown key; known: {}", entry.key, fmt::join(known, ", "))
                         : fmt::format("{}: unknown key; did you mean {}?", entry.key, nearest));
  }

  static const std::vector<Entry>& Entries(const Entry& map) {
    if (map.value.kind != YamlNode::Kind::kMap)
      FailAt(map.value.at, fmt::format("{}: a map was expected", map.key));
    return map.value.entries;
  }

  static const std::string& Text(const std::string& key, const YamlNode& value) {
    if (value.kind != YamlNode::Kind::kScalar || value.text.empty())
      FailAt(value.at, fmt::format("{}: a text was expected", key));
    return value.text;
  }

  static double Number(const Entry& entry, double min, double max) {
    const std::string_view text = WithoutPlus(entry.value.text);
    const char* end = text.data() + text.size();
    double number = 0.0;
    const auto [stop, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc() || stop != end || !(number >= min && number <= max))
      FailAt(entry.value.at, fmt::format("{}: {} is not allowed; allowed: {:g} .. {:g}", entry.key,
                                         Described(entry.value), min, max));
    return number;
  }

  void ReadKey(const Entry& entry) {
    CheckKnown(entry, kKeys);
    const std::string& word = entry.key;
    if (word == "columns") {
      for (const Entry& column : Entries(entry)) {
        CheckKnown(column, kMeanings);
        CheckOneMeaning(column);
        format_.columns[column.key] = Text(column.key, column.value);
      }
    } else if (word == "units") {
      for (const Entry& factor : Entries(entry)) {
        CheckKnown(factor, kMeanings);
        unit_places_[factor.key] = factor.at;
        format_.units[factor.key] = Number(factor, -1e9, 1e9);
        if (format_.units[factor.key] == 0.0)
          FailAt(factor.value.at, "units: a factor of 0 loses the column");
      }
    } else if (word == "climb_from") {
      const std::string& source = Text(word, entry.value);
      if (source != "column" && source != "altitude")
        FailAt(entry.value.at,
               fmt::format("climb_from: '{}' is not allowed; allowed: column | altitude", source));
      format_.climb_from = source == "altitude" ? ClimbFrom::kAltitude : ClimbFrom::kColumn;
    } else if (word == "climb_window_s") {
      format_.climb_window_s = Number(entry, 0.05, 30);
    } else if (word == "air_density_kgm3") {
      format_.air_density_kgm3 = Number(entry, 0.3, 2);
    } else if (word == "in_flight") {
      for (const Entry& condition : Entries(entry)) format_.in_flight[condition.key] = Condition(condition);
    } else if (word == "hover") {
      ReadHover(entry);
    } else if (word == "robot") {
      ReadRobot(entry);
    } else {
      ReadNotes(entry);
    }
  }

  void CheckOneMeaning(const Entry& column) const {
    for (const auto& [meaning, name] : format_.columns)
      if (name == column.value.text)
        FailAt(column.value.at, fmt::format("columns: '{}' is both {} and {}; allowed: one meaning a column",
                                            name, meaning, column.key));
  }

  // A number is a least value; a text, or a list of texts, are words.
  static FlightCondition Condition(const Entry& entry) {
    FlightCondition condition;
    if (entry.value.kind == YamlNode::Kind::kList) {
      for (const YamlNode& word : entry.value.items) condition.words.push_back(Text(entry.key, word));
      if (condition.words.empty())
        FailAt(entry.value.at, fmt::format("{}: a list of words was expected", entry.key));
    } else if (const std::string& text = Text(entry.key, entry.value);
               text.find_first_of("0123456789") != 0 && !text.starts_with('-') && !text.starts_with('.') &&
               !text.starts_with('+')) {
      condition.words.push_back(text);
    } else {
      condition.least = Number(entry, -1e12, 1e12);
    }
    return condition;
  }

  void ReadHover(const Entry& hover) {
    for (const Entry& limit : Entries(hover)) {
      CheckKnown(limit, {"max_speed_mps", "max_climb_mps"});
      (limit.key == "max_speed_mps" ? format_.hover_max_speed_mps : format_.hover_max_climb_mps) =
          Number(limit, 0.01, 20);
    }
  }

  void ReadRobot(const Entry& robot) {
    Config config;
    config.robot = format_.robot;
    for (const Entry& field : Entries(robot)) {
      const std::string problem = SetParameter(config, "robot." + field.key, Text(field.key, field.value));
      if (!problem.empty()) FailAt(field.value.at, problem);
      format_.robot_keys.insert(field.key);
    }
    format_.robot = config.robot;
  }

  void ReadNotes(const Entry& notes) {
    if (notes.value.kind != YamlNode::Kind::kList)
      FailAt(notes.value.at, "notes: a list of texts was expected");
    for (const YamlNode& note : notes.value.items) format_.notes.push_back(Text("notes", note));
  }

  void CheckColumns() const {
    for (const auto& [meaning, place] : unit_places_)
      if (!format_.Has(meaning))
        FailAt(place,
               fmt::format("units: {} has no column; name it in columns, or leave its unit out", meaning));
    const auto need = [this](bool there, const char* what) {
      if (!there) FailAt(root_.at, fmt::format("columns: {}", what));
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

  YamlNode root_;
  LogFormat format_;
  std::map<std::string, std::string> unit_places_;
};

}  // namespace

LogFormat ParseLogFormat(const std::string& name, const std::string& yaml) {
  return FormatReader(name, yaml).Read();
}

LogFormat LoadLogFormat(const std::string& name_or_path) {
  for (const BuiltIn& format : kBuiltIn)
    if (format.name == name_or_path) return ParseLogFormat(format.name, format.yaml);
  if (!std::filesystem::exists(name_or_path)) {
    const std::string nearest = NearestWord(name_or_path, BuiltInLogFormats());
    throw UserError(fmt::format("--format: '{}' is neither a file nor a built-in format ({}){}", name_or_path,
                                fmt::join(BuiltInLogFormats(), ", "),
                                nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
  }
  const std::string yaml = ReadFile(name_or_path, kMaxYamlFileLength);
  return ParseLogFormat(name_or_path, yaml);
}

std::vector<std::string> BuiltInLogFormats() {
  std::vector<std::string> names;
  for (const BuiltIn& format : kBuiltIn) names.emplace_back(format.name);
  return names;
}

bool IsBuiltInLogFormat(const std::string& name) {
  return std::any_of(std::begin(kBuiltIn), std::end(kBuiltIn),
                     [&](const BuiltIn& format) { return name == format.name; });
}

}  // namespace ed3r::fit
