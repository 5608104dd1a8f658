#include "studies/flight_logs/airdata_log.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "studies/flight_logs/read_log.h"
#include "tests/flight_logs/complaint.h"

namespace ed3r::flight_logs {
namespace {

// Ten seconds at 10 Hz: motors start, climb, hover, all with text where AirData has some.
std::string Export(const std::string& length, const std::string& speed,
                   const std::string& state = "Waypoint") {
  std::string text = fmt::format(
      "time(millisecond),height_above_takeoff({0}),ground_elevation({0}),speed({1}),voltage(v), "
      "zSpeed({1}),current(A),flycState,message\n",
      length, speed);
  for (int i = 0; i < 100; ++i)
    text += fmt::format("{},{},{},10,22.2, -2,{},{},{}\n", 100 * i, i < 20 ? 0 : 30,
                        i == 0 ? "Available with a subscription" : "", i < 20 ? 0.5 : 9.0,
                        i < 20 ? "Motors_Started" : state,
                        i == 0 ? "\"Altitude zone, please fly with caution\"" : "");
  return text;
}

double At(const LogTable& log, std::size_t row, const std::string& column) {
  return log.Number(row, log.Column(column, "test"), -1e9, 1e9);
}

TEST(AirDataLogTest, ReadsImperialAndMetricExports) {
  const LogTable imperial = ParseLog("dji.csv", Export("feet", "mph"), {});
  EXPECT_EQ(imperial.kind(), LogKind::kAirData);
  EXPECT_DOUBLE_EQ(At(imperial, 50, "time_s"), 5.0);
  EXPECT_DOUBLE_EQ(At(imperial, 50, "altitude_m"), 9.144);
  EXPECT_DOUBLE_EQ(At(imperial, 50, "ground_speed_mps"), 4.4704);
  EXPECT_DOUBLE_EQ(At(imperial, 50, "climb_mps"), 0.89408) << "zSpeed is downwards";
  const LogTable metric = ParseLog("dji.csv", Export("meters", "m/s"), {});
  EXPECT_DOUBLE_EQ(At(metric, 50, "altitude_m"), 30.0);
  EXPECT_DOUBLE_EQ(At(metric, 50, "ground_speed_mps"), 10.0);
  EXPECT_DOUBLE_EQ(At(ParseLog("dji.csv", Export("ft", "knots"), {}), 50, "ground_speed_mps"), 5.14444);
  EXPECT_TRUE(
      Complaint([] { ParseLog("dji.csv", Export("cubits", "m/s"), {}); })
          .starts_with("dji.csv:1:1: column 'height_above_takeoff(cubits)': the unit 'cubits' is not known; "
                       "allowed: a | amps | feet | "));
}

TEST(AirDataLogTest, LeavesOutTheGround) {
  const LogTable log = ParseLog("dji.csv", Export("feet", "mph"), {});
  EXPECT_TRUE(log.OnGround(19));
  EXPECT_FALSE(log.OnGround(20));
  EXPECT_EQ(Complaint([] { ParseLog("dji.csv", Export("feet", "mph", "Motors_Started"), {}); }),
            "dji.csv: no flight: motors starting or less than 0.5 m above take-off in all 100 rows");
}

TEST(AirDataLogTest, RefusesAHeaderWithoutRows) {
  const std::string text = Export("feet", "mph");
  EXPECT_EQ(Complaint([&] { ParseLog("dji.csv", text.substr(0, text.find('\n')), {}); }),
            "dji.csv: power was not measured: the log has no battery voltage and current");
}

TEST(AirDataLogTest, CountsBadRowsWhereAsked) {
  std::string text = Export("feet", "mph");
  text.replace(text.find("\n3000,") + 1, 4, "none");
  EXPECT_EQ(Complaint([&] { ParseLog("dji.csv", text, {}); }),
            "dji.csv:32:1: time(millisecond): 'none' is not a number; --skip-bad leaves such rows out");
  const LogTable log = ParseLog("dji.csv", text, {.skip_bad = true});
  EXPECT_EQ(log.bad(), 1);
  EXPECT_EQ(log.rows(), 99u);
  EXPECT_EQ(log.WhereRow(50), "dji.csv:53:1: ");
}

}  // namespace
}  // namespace ed3r::flight_logs
