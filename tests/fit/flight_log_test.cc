#include "studies/fit/flight_log.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "engine/core/check.h"
#include "studies/flight_logs/read_log.h"
#include "tests/flight_logs/complaint.h"

namespace ed3r::fit {
namespace {

constexpr const char* kFormat = R"(columns: {time_s: t, power_w: p, airspeed_mps: v, climb_mps: w, flight: id}
robot: {mass_kg: 2}
)";

// One flight of 250 rows: 100 hovering, the rest cruising. change(row, cells) edits a row's text before it is
// written.
std::string LogText(const std::function<void(int, std::vector<std::string>&)>& change = {}) {
  std::string text = "t,p,v,w,id\n";
  for (int i = 0; i < 250; ++i) {
    std::vector<std::string> cells = {fmt::format("{}", 0.5 * i), "400", i < 100 ? "0.2" : "8", "0.1", "a"};
    if (change) change(i, cells);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (k > 0) text += ',';
      text += cells[k];
    }
    text += "\n";
  }
  return text;
}

FlightLog Read(const std::string& text, const std::string& format = kFormat) {
  std::vector<flight_logs::LogTable> tables;
  tables.push_back(CsvTable::Parse("log.csv", text));
  return MakeFlightLog(tables, ParseLogFormat("test.yaml", format));
}

std::string LogComplaint(const std::string& text, const std::string& format = kFormat) {
  return flight_logs::Complaint([&] { Read(text, format); });
}

TEST(FlightLogTest, ReadsRowsUnitsAndMass) {
  const FlightLog log = Read(LogText(), std::string(kFormat) + "units: {climb_mps: 0.01}\n");
  ASSERT_EQ(log.flights.size(), 1u);
  EXPECT_EQ(log.flights[0].id, "log.csv#a");
  EXPECT_EQ(log.rows, 250);
  EXPECT_EQ(log.hover_rows, 100);
  EXPECT_DOUBLE_EQ(log.flights[0].rows[3].time_s, 1.5);
  EXPECT_DOUBLE_EQ(log.flights[0].rows[3].climb_mps, 0.001);
  EXPECT_DOUBLE_EQ(log.flights[0].rows[3].mass_kg, 2.0);
  EXPECT_DOUBLE_EQ(log.flights[0].rows[3].density_kgm3, 1.225);
}

TEST(FlightLogTest, AcceptsByteOrderMarkAndCrLf) {
  std::string text = "\xEF\xBB\xBF";
  text += LogText();
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  EXPECT_EQ(Read(text + "\r\n").rows, 250);
}

TEST(FlightLogTest, NamesFileLineAndColumnOfBadCells) {
  const auto with = [](int row, std::size_t cell, const std::string& value) {
    return LogText([=](int i, std::vector<std::string>& cells) {
      if (i == row) cells[cell] = value;
    });
  };
  EXPECT_EQ(LogComplaint(with(3, 1, "4oo")),
            "log.csv:5:5: p: '4oo' is not a number; --skip-bad leaves such rows out");
  EXPECT_EQ(LogComplaint(with(3, 1, "")),
            "log.csv:5:5: p: '' is not a number; --skip-bad leaves such rows out");
  EXPECT_EQ(LogComplaint(with(3, 1, "nan")),
            "log.csv:5:5: p: 'nan' is not a number; --skip-bad leaves such rows out");
  EXPECT_EQ(LogComplaint(with(0, 2, "-1")),
            "log.csv:2:7: v: -1 is out of range; allowed: 0 .. 60; --skip-bad leaves such rows out");
  EXPECT_EQ(LogComplaint(with(4, 0, "1.5")),
            "log.csv:6:1: t: 1.5 does not come after 1.5; time must increase within a flight; --skip-bad "
            "leaves such rows out");
  EXPECT_EQ(LogComplaint(with(4, 1, "1,2")), "log.csv:6:16: 6 cells, but the header names 5 columns");
  EXPECT_EQ(LogComplaint(with(120, 4, "b")),
            "log.csv:123:16: id: flight 'a' goes on after another flight; rows of a flight must be together");
}

TEST(FlightLogTest, NamesMissingColumnsWithTheNearest) {
  std::string text = LogText();
  text.replace(0, 10, "time,power,v,w,id");
  EXPECT_EQ(LogComplaint(text, R"(columns: {time_s: time, power_w: powr, airspeed_mps: v, climb_mps: w})"),
            "log.csv:1:1: no column 'powr' (power_w); did you mean 'power'? columns: time, power, v, w, id");
  EXPECT_EQ(LogComplaint("", kFormat), "log.csv:1:1: empty file; a header line was expected");
  EXPECT_EQ(LogComplaint("t,t\n1,2\n"), "log.csv:1:3: column 't' is there twice");
  EXPECT_EQ(flight_logs::Complaint([] { flight_logs::ReadLog("no/such.csv", {}); }),
            "no/such.csv: cannot be read: No such file or directory");
}

TEST(FlightLogTest, RefusesLogsThatCannotBeFitted) {
  const std::string no_hover = LogText([](int, std::vector<std::string>& cells) { cells[2] = "8"; });
  EXPECT_EQ(
      LogComplaint(no_hover),
      "log.csv:251:1: no hovering phase: 0 rows have 'v' up to 3 m/s and a climb rate ('w') within 0.4 m/s; "
      "at least 20 are needed (format: hover)");
  const std::string text = LogText();
  EXPECT_EQ(LogComplaint(text.substr(0, text.find("\n50,") + 1)),
            "log.csv:101:1: too few rows: 100 in flight, at least 200 are needed");
  const std::string fast = LogText([](int i, std::vector<std::string>& cells) {
    cells[0] = fmt::format("{}", 0.01 * i);
    cells[2] = "0.2";
  });
  EXPECT_EQ(LogComplaint(fast), "log.csv:251:1: too short: 2.5 s of flight, at least 30 s are needed");
  EXPECT_EQ(LogComplaint("t,p,v,w,id\n1,2,3,4,a\n"),
            "log.csv:2:1: too few rows: no flight of at least 20 rows");
}

TEST(FlightLogTest, LogsToEvaluateNeedNoHover) {
  std::vector<flight_logs::LogTable> tables;
  tables.push_back(
      CsvTable::Parse("log.csv", LogText([](int, std::vector<std::string>& cells) { cells[2] = "8"; })));
  EXPECT_EQ(MakeFlightLog(tables, ParseLogFormat("test.yaml", kFormat), LogUse::kEvaluate).hover_rows, 0);
}

TEST(FlightLogTest, CountsDropOutsSpikesAndRowsOnTheGround) {
  const std::string text = LogText([](int i, std::vector<std::string>& cells) {
    if (i == 50 || i == 51) cells[1] = "0.3";
    if (i == 60) cells[1] = "4000";
    if (i < 10) cells[1] = "7";
  });
  const FlightLog log = Read(text, std::string(kFormat) + "in_flight: {p: 0.2, t: 5}\n");
  EXPECT_EQ(log.drop_outs, 2);
  EXPECT_EQ(log.spikes, 1);
  EXPECT_EQ(log.rows_on_ground, 10);
  EXPECT_EQ(log.rows, 240);
  EXPECT_EQ(log.flights[0].rows[40].quality, RowQuality::kDropOut);
}

TEST(FlightLogTest, TakesClimbFromAltitudeAndReportsTheDriftOfTheRecordedOne) {
  std::string text = "t,p,v,w,h\n";
  for (int i = 0; i < 300;
       ++i)  // hovers, then climbs at 2 m/s; the recorded rate reads 1 m/s too much throughout
    text += fmt::format("{},400,1,{},{}\n", 0.5 * i, i < 150 ? 1 : 3, i < 150 ? 10 : 10 + (i - 149));
  const FlightLog log =
      Read(text, R"(columns: {time_s: t, power_w: p, airspeed_mps: v, climb_mps: w, altitude_m: h}
climb_from: altitude)");
  EXPECT_NEAR(log.flights[0].rows[50].climb_mps, 0.0, 1e-12);
  EXPECT_NEAR(log.flights[0].rows[250].climb_mps, 2.0, 1e-12);
  EXPECT_NEAR(log.climb_drift_m, 149.5 * 1.0, 1.0);
}

TEST(LogFormatTest, BuiltInFormatsAreValid) {
  for (const std::string& name : BuiltInLogFormats()) EXPECT_EQ(LoadLogFormat(name).name, name);
  EXPECT_DOUBLE_EQ(LoadLogFormat("m100").robot.mass_kg, 3.68);
}

TEST(LogFormatTest, NamesTheMistake) {
  const auto complaint = [](const std::string& yaml) {
    return flight_logs::Complaint([&] { ParseLogFormat("f.yaml", yaml); });
  };
  EXPECT_EQ(complaint("colums: {}"), "f.yaml:1:1: colums: unknown key; did you mean columns?");
  EXPECT_EQ(complaint("columns:\n  tiem_s: t"), "f.yaml:2:3: tiem_s: unknown key; did you mean time_s?");
  EXPECT_EQ(complaint("columns: {time_s: t}"),
            "f.yaml:1:1: columns: power_w is missing, and so is voltage_v or current_a");
  EXPECT_EQ(complaint("climb_from: gps"),
            "f.yaml:1:13: climb_from: 'gps' is not allowed; allowed: column | altitude");
  EXPECT_EQ(complaint("hover: {max_speed_mps: fast}"),
            "f.yaml:1:24: max_speed_mps: 'fast' is not allowed; allowed: 0.01 .. 20");
  EXPECT_EQ(complaint("robot: {mass_kg: 900}"),
            "f.yaml:1:18: robot.mass_kg: '900' is not allowed; allowed: 0.05 .. 50 kg");
  EXPECT_EQ(complaint("units: {climb_mps: +-1}"),
            "f.yaml:1:20: climb_mps: '+-1' is not allowed; allowed: -1e+09 .. 1e+09");
  EXPECT_EQ(complaint("units: {climb_mps: 0}"), "f.yaml:1:20: units: a factor of 0 loses the column");
  EXPECT_EQ(complaint("columns: {voltage_v: u, current_a: u}"),
            "f.yaml:1:36: columns: 'u' is both voltage_v and current_a; allowed: one meaning a column");
  EXPECT_EQ(
      complaint("columns: {time_s: t, power_w: p, airspeed_mps: v, climb_mps: w}\nunits: {altitude_m: 0.1}"),
      "f.yaml:2:9: units: altitude_m has no column; name it in columns, or leave its unit out");
  EXPECT_EQ(flight_logs::Complaint([] { LoadLogFormat("m10"); }),
            "--format: 'm10' is neither a file nor a built-in format (m100, ardupilot, px4, dji); did you "
            "mean m100?");
}

}  // namespace
}  // namespace ed3r::fit
