// Logs that people have, from which a fit would be a silently wrong number: each kind with what it must say.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/core/files/file.h"
#include "studies/fit/fit.h"
#include "studies/fit/fit_text.h"
#include "tests/flight_logs/complaint.h"

namespace ed3r::fit {
namespace {

// One row of a made log, in SI units; a test changes what it is about before the row is written.
struct Row {
  int index;
  std::string time, power, voltage, current, speed, climb, altitude, payload, state;
};

struct Names {
  std::string time = "t", power = "p", speed = "v", climb = "w", altitude = "h", payload = "load";
};

// 600 rows at 0.5 s: hovering, climbing at 1.5 m/s, cruising at up to 8 m/s, descending, over and over; 2 kg, about 300 W.
std::string LogText(const std::function<void(Row&)>& change = {}, const Names& names = {}) {
  std::string text = fmt::format("{},{},{},{},{},{},load_v,load_a,state\n", names.time, names.power,
                                 names.speed, names.climb, names.altitude, names.payload);
  double altitude = 20.0;
  for (int i = 0; i < 600; ++i) {
    const int phase = i / 30 % 4;
    const double climb = phase == 1 ? 1.5 : phase == 3 ? -1.5 : 0.0;
    const double speed = phase == 2 ? 2.0 + i / 100 : 0.2;
    const double power =
        300.0 + 25.0 * climb + 0.4 * speed * speed + 6.0 * std::sin(1.7 * i) + 3.0 * std::cos(0.31 * i);
    altitude += 0.5 * climb;
    Row row{.index = i,
            .time = fmt::format("{}", 0.5 * i),
            .power = fmt::format("{:.3f}", power),
            .voltage = "15",
            .current = fmt::format("{:.4f}", power / 15.0),
            .speed = fmt::format("{:.2f}", speed),
            .climb = fmt::format("{:.2f}", climb),
            .altitude = fmt::format("{:.2f}", altitude),
            .payload = "0",
            .state = phase == 0 && i < 30 ? "Landed" : "In Air"};
    if (change) change(row);
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n", row.time, row.power, row.speed, row.climb,
                        row.altitude, row.payload, row.voltage, row.current, row.state);
  }
  return text;
}

std::string FormatText(const Names& names = {}, const std::string& more = "") {
  return fmt::format(
      "columns: {{time_s: {}, power_w: {}, airspeed_mps: {}, climb_mps: {}, altitude_m: {}, payload_kg: "
      "{}}}\n"
      "robot: {{mass_kg: 2, propellers: 4, propeller_radius_m: 0.12}}\n{}",
      names.time, names.power, names.speed, names.climb, names.altitude, names.payload, more);
}

const std::string kCurrentFormat =
    "columns: {time_s: t, voltage_v: load_v, current_a: load_a, airspeed_mps: v, climb_mps: w, altitude_m: "
    "h}\n"
    "robot: {mass_kg: 2, propellers: 4, propeller_radius_m: 0.12}\n";

class RefusalsTest : public ::testing::Test {
 protected:
  FitReport Fit(const std::string& log, const std::string& format = FormatText(),
                bool skip_bad = false) const {
    WriteFile(folder_ + "log.csv", log);
    WriteFile(folder_ + "format.yaml", format);
    FitOptions options{.logs = {folder_ + "log.csv"}, .format = folder_ + "format.yaml"};
    options.reading.skip_bad = skip_bad;
    return RunFit(options);
  }

  // Without the folder.
  std::string Says(const std::string& log, const std::string& format = FormatText()) const {
    std::string message = flight_logs::Complaint([&] { Fit(log, format); });
    for (std::size_t at; (at = message.find(folder_)) != std::string::npos;)
      message.erase(at, folder_.size());
    return message;
  }

  // The words that a message must have, one after the other.
  static void Expect(const std::string& message, const std::vector<std::string>& words) {
    std::size_t at = 0;
    for (const std::string& word : words) {
      at = message.find(word, at);
      ASSERT_NE(at, std::string::npos) << "'" << word << "' in: " << message;
    }
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }

  const std::string folder_ = ::testing::TempDir() + "ed3r_refusals_";
};

TEST_F(RefusalsTest, TheLogAsItIsIsFitted) {
  const FitReport report = Fit(LogText());
  EXPECT_EQ(report.log.rows, 600);
  EXPECT_LT(report.models[report.best].held_out.median_error_pct, 5.0);
}

TEST_F(RefusalsTest, PowerThatWasNotMeasured) {
  const std::string dead = LogText([](Row& row) { row.current = "-1"; });
  Expect(Says(dead, kCurrentFormat),
         {"log.csv:2:",
          "load_a: power was not measured in 600 of 600 rows in flight: the first is -1 A at -15 W"});
  const std::string zero = LogText([](Row& row) { row.power = "0"; });
  Expect(Says(zero), {"log.csv:2:", "p: power was not measured in 600 of 600 rows", "0 W"});
  const std::string half = LogText([](Row& row) {
    if (row.index % 2 == 1) row.current = "-1";
  });
  Expect(Says(half, kCurrentFormat), {"log.csv:3:", "power was not measured in 300 of 600 rows"});
  const std::string constant = LogText([](Row& row) { row.power = "500"; });
  EXPECT_EQ(Says(constant),
            "log.csv:2:1: power was not measured: it is 500 W in 600 of 600 rows in flight, and a flying "
            "multirotor's power varies");
  const std::string some = LogText([](Row& row) {
    if (row.index % 40 == 7) row.power = "-3";
  });
  EXPECT_EQ(Fit(some).log.drop_outs, 15) << "single drop-outs are what they were";
}

TEST_F(RefusalsTest, TimesThatCannotBeSeconds) {
  const auto scaled = [](double factor) {
    return LogText([=](Row& row) { row.time = fmt::format("{}", 0.5 * row.index * factor); });
  };
  Expect(Says(scaled(1e6)), {"log.csv:1:1: time_s ('t'): the median step is 500000 s", "microseconds",
                             "units: {time_s: 1e-06}"});
  Expect(Says(scaled(1e3)), {"the median step is 500 s", "milliseconds", "units: {time_s: 0.001}"});
  Expect(Says(scaled(1.0 / 60.0)), {"minutes", "units: {time_s: 60}"});
  const FitReport mended = Fit(scaled(1e6), FormatText({}, "units: {time_s: 1e-6}\n"));
  EXPECT_NEAR(mended.log.flights[0].rows.back().time_s, 299.5, 1e-6)
      << "the line that the message names mends it";
}

TEST_F(RefusalsTest, SizesThatCannotBe) {
  const std::string grams = LogText([](Row& row) { row.payload = "250"; });
  Expect(Says(grams),
         {"payload_kg ('load')", "250 kg on an airframe of 2 kg", "like g", "units: {payload_kg: 0.001}"});
  EXPECT_NEAR(Fit(grams, FormatText({}, "units: {payload_kg: 0.001}\n")).log.flights[0].MassKg(), 2.25,
              1e-12);
  const std::string kilowatts =
      LogText([](Row& row) { row.power = fmt::format("{:.6f}", std::stod(row.power) / 1000.0); });
  Expect(Says(kilowatts), {"hover power is 0.", "below the ideal induced power",
                           "for 2 kg on 4 propellers of radius 0.12 m", "kW", "units: {power_w: 1000}"});
  const std::string hundredths =
      LogText([](Row& row) { row.current = fmt::format("{:.2f}", std::stod(row.current) * 100.0); });
  Expect(Says(hundredths, kCurrentFormat),
         {"current_a ('load_a')", "hundredths of an ampere", "units: {current_a: 0.01}"});
  const std::string fast =
      LogText([](Row& row) { row.speed = fmt::format("{:.2f}", std::stod(row.speed) * 3.6); });
  Expect(Says(fast), {"airspeed_mps ('v')", "km/h", "units: {airspeed_mps: 0.277778}", "mph"});
  const std::string heavy = FormatText({}, "");
  std::string robot = heavy;
  robot.replace(robot.find("mass_kg: 2,"), 11, "mass_kg: 9,");
  Expect(Says(LogText(), robot), {"below the ideal induced power", "for 9 kg", "check robot.mass_kg"});
}

TEST_F(RefusalsTest, NamesThatSayAnotherUnit) {
  for (const auto& [name, unit] :
       {std::pair{"speed_kmh", "kmh"}, {"Speed (km/h)", "kmh"}, {"speed[mph]", "mph"}}) {
    const Names names{.speed = name};
    std::string format = FormatText(names);
    const std::string quoted = fmt::format("\"{}\"", name);
    format.replace(format.find(name), std::string(name).size(), quoted);
    Expect(Says(LogText({}, names), format),
           {fmt::format("the name says {}", unit), "units: {airspeed_mps: "});
  }
  EXPECT_EQ(Says(LogText({}, {.speed = "speed_kmh"}),
                 FormatText({.speed = "speed_kmh"}, "units: {airspeed_mps: 1}\n")),
            "")
      << "a units line is believed";
}

TEST_F(RefusalsTest, ClimbRatesThatTheAltitudeContradicts) {
  const auto times = [](double factor) {
    return LogText([=](Row& row) { row.climb = fmt::format("{:.3f}", std::stod(row.climb) * factor); });
  };
  Expect(Says(times(-1.0)),
         {"climb_mps ('w') runs against the altitude ('h'): correlation -", "units: {climb_mps: -1}"});
  EXPECT_EQ(Says(times(-1.0), FormatText({}, "units: {climb_mps: -1}\n")), "");
  Expect(Says(times(-1.0), FormatText({}, "units: {climb_mps: 1}\n")), {"runs against the altitude"});
  Expect(Says(times(3.6)),
         {"climb_mps ('w')", "changes 0.2", "a climb rate in km/h", "units: {climb_mps: 0.277778}"});
  const std::string feet =
      LogText([](Row& row) { row.altitude = fmt::format("{:.2f}", std::stod(row.altitude) / 0.3048); });
  Expect(Says(feet), {"changes 3.", "an altitude in feet", "units: {altitude_m: 0.3048}"});
}

TEST_F(RefusalsTest, ASpeedThatThePathContradicts) {
  // Latitude and longitude that go as the speed says, which is then written in mph: too slow to be seen by its size.
  std::string text = "t,p,v,w,lat_deg,lon_deg\n";
  double lon = 149.0;
  for (int i = 0; i < 600; ++i) {
    const double speed_mps = i % 60 < 30 ? 0.2 : 5.0;
    lon += 0.5 * speed_mps / (6.371e6 * std::cos(-35.0 * M_PI / 180.0)) * 180.0 / M_PI;
    text += fmt::format("{},{},{:.3f},0,-35,{:.9f}\n", 0.5 * i, 300 + 5 * (i % 7), speed_mps / 0.44704, lon);
  }
  const std::string format =
      "columns: {time_s: t, power_w: p, ground_speed_mps: v, climb_mps: w}\n"
      "robot: {mass_kg: 2, propellers: 4, propeller_radius_m: 0.12}\n";
  Expect(Says(text, format),
         {"ground_speed_mps ('v'): 'lat_deg' and 'lon_deg' go", "mph", "units: {ground_speed_mps: 0.44704}"});
}

TEST_F(RefusalsTest, AnAirframeThatNobodyNamed) {
  std::string format = FormatText();
  format.erase(format.find("robot:"));
  Expect(Says(LogText(), format), {"the airframe that flew is not known: robot.mass_kg, robot.propellers, "
                                   "robot.propeller_radius_m are needed",
                                   "--set robot.mass_kg="});
  Expect(Says(LogText(), format + "robot: {mass_kg: 2}\n"),
         {"not known: robot.propellers, robot.propeller_radius_m are needed"});
}

TEST_F(RefusalsTest, BadRowsAreNamedOrCounted) {
  const std::string text = LogText([](Row& row) {
    if (row.index == 100) row.power = "";
    if (row.index == 200) row.power = "n/a";
    if (row.index == 300) row.time = "149.5";
    if (row.index == 400) row.time = "10";
  });
  EXPECT_EQ(Says(text), "log.csv:102:4: p: '' is not a number; --skip-bad leaves such rows out");
  const FitReport report = Fit(text, FormatText(), true);
  EXPECT_EQ(report.log.bad_rows, 4);
  EXPECT_EQ(report.log.rows, 596);
  EXPECT_NE(report.log.first_bad.find("log.csv:102:4: p: '' is not a number"), std::string::npos);
  EXPECT_EQ(ToJson(report)["log"]["bad_rows"], 4);
  const std::string many = LogText([](Row& row) {
    if (row.index % 5 == 0) row.power = "x";
  });
  Expect(flight_logs::Complaint([&] { Fit(many, FormatText(), true); }),
         {"--skip-bad would leave out 120 of 600 rows, at most 10 % are allowed"});
}

TEST_F(RefusalsTest, ACurrentThatCountsDischargeAsNegativeIsNamed) {
  const std::string log = LogText([](Row& row) { row.current = "-" + row.current; });
  Expect(Says(log, kCurrentFormat),
         {"log.csv:2:", "load_a: current_a is negative in 600 of 600 rows in flight",
          "put 'units: {current_a: -1}' into the format file"});
  EXPECT_EQ(Says(log, kCurrentFormat + "units: {current_a: -1}\n"), Says(LogText(), kCurrentFormat));
}

TEST_F(RefusalsTest, AClimbRateThatWasNotMeasuredIsNamed) {
  Expect(Says(LogText([](Row& row) { row.climb = "0"; })),
         {"log.csv:2:1: climb_mps ('w') is 0 m/s on average", "while the altitude ('h') changes by",
          "put 'climb_from: altitude' into the format file"});
}

TEST_F(RefusalsTest, ASpeedThatNeverChangesIsSaid) {
  const FitReport report = Fit(LogText([](Row& row) { row.speed = "0"; }));
  ASSERT_FALSE(report.log.notes.empty());
  EXPECT_EQ(report.log.notes.back(), "the speed is 0 m/s in all 600 rows in flight: was it measured?");
}

TEST_F(RefusalsTest, WhyNoRowIsInFlightIsSaid) {
  Expect(Says(LogText(), FormatText({}, "in_flight: {state: [flying, landing]}\n")),
         {"log.csv:2:1: no flight: 600 rows are on the ground by the format's in_flight ('state' one of: "
          "flying, "
          "landing, and row 1 has 'Landed')"});
}

TEST_F(RefusalsTest, RowsInFlightAreToldByWords) {
  EXPECT_EQ(Fit(LogText(), FormatText({}, "in_flight: {state: [in air, Landing]}\n")).log.rows_on_ground, 30);
  EXPECT_EQ(Fit(LogText(), FormatText({}, "in_flight: {state: In Air}\n")).log.rows_on_ground, 30);
}

// Its rows were ground without a word.
TEST_F(RefusalsTest, AWordThatNoRowHasIsSaid) {
  const FitReport report = Fit(LogText(), FormatText({}, "in_flight: {state: [In air, Landign]}\n"));
  EXPECT_NE(std::find(report.log.notes.begin(), report.log.notes.end(),
                      "in_flight: no row has 'Landign' in 'state'; there are: in air, landed"),
            report.log.notes.end());
}

// Armed and waiting for the first minute: 120 of 600 rows.
void Idles(Row& row) {
  if (row.index >= 120) return;
  row.power = fmt::format("{:.3f}", 6.0 + 0.2 * std::sin(1.7 * row.index));
  row.speed = row.climb = row.altitude = "0";
  row.state = "Landed";
}

TEST_F(RefusalsTest, RowsOnTheGroundThatNobodyLeftOutAreNamed) {
  const std::string log = LogText(Idles);
  EXPECT_EQ(Says(log),
            "log.csv:2:1: 120 of 600 rows look like the ground: they rest for 5 s and more on less than "
            "79.4 W, a quarter of what this log takes in flight; say which rows are in flight: put "
            "'in_flight: {h: 1}', or the words of a state, into the format file (sweeps/OWN_DATA.md, "
            "\"A drone's log\")");
  EXPECT_EQ(Fit(log, FormatText({}, "in_flight: {h: 1}\n")).log.rows_on_ground, 120);
  EXPECT_EQ(Fit(log, FormatText({}, "in_flight: {state: In Air}\n")).log.rows_on_ground, 120);
  const std::string no_altitude =
      "columns: {time_s: t, power_w: p, airspeed_mps: v, climb_mps: w}\n"
      "robot: {mass_kg: 2, propellers: 4, propeller_radius_m: 0.12}\n";
  Expect(Says(log, no_altitude), {"120 of 600 rows look like the ground", "'in_flight: {COLUMN: [WORD]}'"});
}

// 600 rows of an AirData export, the first fifth idling a metre above where it took off.
std::string AirDataText(bool with_state) {
  std::string text = fmt::format(
      "time(millisecond),voltage(v),current(A),speed(m/s), zSpeed(m/s),height_above_takeoff(meters){}\n",
      with_state ? ",flycState" : "");
  double altitude = 20.0;
  for (int i = 0; i < 600; ++i) {
    const bool idle = i < 120;
    const int phase = i / 30 % 4;
    const double climb = idle ? 0.0 : phase == 1 ? 1.5 : phase == 3 ? -1.5 : 0.0;
    const double speed = phase == 2 ? 2.0 + i / 100 : 0.2;
    const double power = 300.0 + 25.0 * climb + 0.4 * speed * speed + 6.0 * std::sin(1.7 * i);
    altitude += 0.5 * climb;
    text += fmt::format("{},15,{:.4f},{:.2f},{:.2f},{:.2f}{}\n", 500 * i, (idle ? 8.0 : power) / 15.0,
                        idle ? 0.0 : speed, -climb, idle ? 1.0 : altitude,
                        !with_state ? ""
                        : idle      ? ",Motors_Started"
                                    : ",GPS_Atti");
  }
  return text;
}

// Half a metre above take-off is a guess; what an autopilot says is not.
TEST_F(RefusalsTest, AnAirDataLogThatDoesNotTellTheGroundIsLookedAt) {
  const auto fit = [&](bool with_state, const std::string& format) {
    WriteFile(folder_ + "air.csv", AirDataText(with_state));
    return RunFit(
        {.logs = {folder_ + "air.csv"},
         .format = format,
         .robot = {{"robot.mass_kg", "2"}, {"robot.propellers", "4"}, {"robot.propeller_radius_m", "0.12"}}});
  };
  EXPECT_EQ(fit(true, "").log.rows_on_ground, 120);
  Expect(flight_logs::Complaint([&] { fit(false, ""); }),
         {"air.csv:2:1: 120 of 600 rows look like the ground", "put 'in_flight: {altitude_m: 2}'"});
  WriteFile(folder_ + "air.yaml",
            "columns: {time_s: time_s, voltage_v: battery_voltage_v, current_a: battery_current_a, "
            "ground_speed_mps: "
            "ground_speed_mps, climb_mps: climb_mps, altitude_m: altitude_m}\nin_flight: {altitude_m: 2}\n");
  EXPECT_EQ(fit(false, folder_ + "air.yaml").log.rows_on_ground, 120);
}

TEST_F(RefusalsTest, AFlightCountsOnce) {
  const std::string log = folder_ + "log.csv", copy = folder_ + "copy.csv", part = folder_ + "part.csv";
  Fit(LogText());
  WriteFile(copy, LogText());
  const std::string text = LogText();
  WriteFile(part, text.substr(0, text.find("\n200,") + 1));
  const auto says = [&](const std::vector<std::string>& logs, const std::vector<std::string>& evaluate) {
    std::string message = flight_logs::Complaint(
        [&] { RunFit({.logs = logs, .format = folder_ + "format.yaml", .evaluate = evaluate}); });
    for (std::size_t at; (at = message.find(folder_)) != std::string::npos;)
      message.erase(at, folder_.size());
    return message;
  };
  EXPECT_EQ(says({log, log}, {}),
            "log.csv: flight 'ed3r_refusals_log.csv' has the rows of flight 'ed3r_refusals_log.csv' of "
            "log.csv: a flight "
            "counts once; leave one of them out");
  Expect(says({log, copy}, {}), {"copy.csv: flight ", " of log.csv: a flight counts once"});
  Expect(says({log, part}, {}), {"part.csv: flight ", " of log.csv: a flight counts once"});
  Expect(says({log}, {copy}),
         {"--evaluate copy.csv: flight ", " of log.csv: only flights that the fit has not seen judge it"});
  Expect(says({log}, {part}),
         {"--evaluate part.csv: flight ", " of log.csv: only flights that the fit has not seen"});
  WriteFile(copy, LogText([](Row& row) { row.power = fmt::format("{:.3f}", 1.01 * std::stod(row.power)); }));
  EXPECT_EQ(RunFit({.logs = {log}, .format = folder_ + "format.yaml", .evaluate = {copy}}).evaluate_log->rows,
            600);
}

TEST_F(RefusalsTest, NotesTellOfTheAirframeThatStandsInOnlyWhereItDoes) {
  FitOptions options{.logs = {ED3R_SOURCE_DIR "/sweeps/data/flight/ardupilot_quad_log.csv"}};
  const std::string other = "ground speed stands in for airspeed";
  EXPECT_EQ(
      RunFit(options).log.format.notes,
      (std::vector<std::string>{"mass and airframe are not recorded; the paper's Iris stands in, and the "
                                "efficiency scales with it",
                                other}));
  options.robot = {{"robot.mass_kg", "1.4"}, {"robot.propellers", "4"}, {"robot.propeller_radius_m", "0.12"}};
  EXPECT_EQ(RunFit(options).log.format.notes, std::vector<std::string>{other});
}

TEST_F(RefusalsTest, ABatteryIsChosenOfRawLogsAlone) {
  Fit(LogText());
  FitOptions options{.logs = {folder_ + "log.csv"}, .format = folder_ + "format.yaml"};
  options.reading.battery = 7;
  EXPECT_EQ(flight_logs::Complaint([&] { RunFit(options); }),
            "--battery: is not allowed for '" + folder_ +
                "log.csv', whose columns are of one battery; allowed: for PX4 and ArduPilot logs");
}

TEST_F(RefusalsTest, WhatOnlyResemblesTheGroundIsFitted) {
  // Drop-outs of a sensor come on the move, too; a short rest is nothing that a robust fit minds.
  const std::string moving = LogText([](Row& row) {
    if (row.index < 120 && row.index % 15 < 4) row.power = "6";
  });
  EXPECT_EQ(Fit(moving).log.drop_outs, 32);
  const std::string shortly = LogText([](Row& row) {
    if (row.index < 10) row.power = "6";
  });
  EXPECT_EQ(Fit(shortly).log.drop_outs, 10);
}

TEST_F(RefusalsTest, WhatTheDataDoNotDetermineIsNotWritten) {
  // Hovering alone says nothing of drag, climbing or interference.
  const std::string hover = LogText([](Row& row) {
    row.power =
        fmt::format("{:.3f}", 300.0 + 6.0 * std::sin(1.7 * row.index) + 3.0 * std::cos(0.31 * row.index));
    row.speed = "0.2";
    row.climb = "0";
    row.altitude = "20";
  });
  const FitReport report = Fit(hover);
  const std::string yaml = FittedYaml(report);
  for (const char* key :
       {"\n  drag_horizontal:", "\n  drag_vertical:", "\n  drag_area_m2:", "\n  interference:"})
    EXPECT_EQ(yaml.find(key), std::string::npos) << key << " in:\n" << yaml;
  EXPECT_NE(yaml.find("# drag_horizontal: "), std::string::npos) << yaml;
  EXPECT_NE(yaml.find("not determined"), std::string::npos);
  // What is written hovers as the log does, with the defaults that it leaves.
  const ModelReport& paper = report.models.front();
  EXPECT_TRUE(paper.determination.Usable());
  EXPECT_NEAR(report.models.front().held_out.hover[0].measured_w, 300.0, 5.0);
  FlightRow row{.density_kgm3 = 1.225, .mass_kg = 2.0};
  for (const auto& model : MakeEnergyModels(report.log.format.robot, 9.8))
    for (const ModelReport& fitted : report.models)
      if (fitted.name == model->name() && fitted.determination.Usable()) {
        EXPECT_NEAR(model->PowerW(row, fitted.determination.values.data()), 300.0, 6.0) << fitted.name;
      }
}

}  // namespace
}  // namespace ed3r::fit
