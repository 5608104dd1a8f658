#include "studies/flight_logs/ardupilot_log.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "studies/flight_logs/read_log.h"
#include "tests/flight_logs/complaint.h"
#include "tests/flight_logs/log_writers.h"

namespace ed3r::flight_logs {
namespace {

struct Made {
  bool gps = true, events = true, second_battery = false;
  float current_a = 10.0F;
};

// 40 s at 10 Hz by the format of 2016 on: armed at 5 s, in the air from 10 s to 35 s; the GPS at 5 Hz, its first two
// seconds without a fix.
std::string NewLog(const Made& made = {}) {
  DataFlashWriter log;
  log.Format(10, 3 + 8 + 1 + 4 + 4, "BAT", "QBff", "TimeUS,Inst,Volt,Curr");
  log.Format(11, 3 + 8 + 1 + 4 + 4, "GPS", "QBff", "TimeUS,Status,Spd,VZ");
  log.Format(12, 3 + 8 + 4 + 4, "CTUN", "Qff", "TimeUS,Alt,ThO");
  log.Format(13, 3 + 8 + 4 + 4 + 4, "XKF1", "Qfff", "TimeUS,VN,VE,VD");
  log.Format(14, 3 + 8 + 1, "EV", "QB", "TimeUS,Id");
  for (int i = 0; i < 400; ++i) {
    const auto us = static_cast<std::uint64_t>(100000 * i);
    const auto event = [&](std::uint8_t id) { log.Message(14, Bytes().Put(us).Put(id)); };
    if (made.events && i == 50) event(10);
    if (made.events && i == 100) event(28);
    if (made.events && i == 350) event(18);
    log.Message(10, Bytes().Put(us).Put(std::uint8_t{0}).Put(15.0F).Put(made.current_a));
    if (made.second_battery) log.Message(10, Bytes().Put(us).Put(std::uint8_t{1}).Put(14.0F).Put(5.0F));
    if (made.gps && i % 2 == 0)
      log.Message(11, Bytes()
                          .Put(us + 30000)
                          .Put(static_cast<std::uint8_t>(i < 20 ? 1 : 3))
                          .Put(static_cast<float>(i))
                          .Put(-0.5F));
    log.Message(12, Bytes().Put(us).Put(20.0F).Put(0.4F));
    log.Message(13, Bytes().Put(us).Put(3.0F).Put(4.0F).Put(0.25F));
  }
  return log.log;
}

double At(const LogTable& log, std::size_t row, const std::string& column) {
  return log.Number(row, log.Column(column, "test"), -1e9, 1e9);
}

TEST(ArduPilotLogTest, JoinsMessagesOfDifferentRatesByTheNearestInTime) {
  const LogTable log = ParseLog("new.bin", NewLog(), {});
  EXPECT_EQ(log.kind(), LogKind::kArduPilot);
  // The first fix is at 2.03 s, so the first row with a GPS value within a second is that of 1.1 s.
  EXPECT_DOUBLE_EQ(At(log, 0, "time_s"), 1.1);
  EXPECT_EQ(log.rows(), 389u);
  EXPECT_DOUBLE_EQ(At(log, 100, "time_s"), 11.1);
  EXPECT_DOUBLE_EQ(At(log, 100, "ground_speed_mps"), 110.0) << "11.03 s is nearer to 11.1 than 11.23";
  EXPECT_DOUBLE_EQ(At(log, 101, "ground_speed_mps"), 112.0) << "11.23 s is nearer to 11.2 than 11.03";
  EXPECT_DOUBLE_EQ(At(log, 100, "gps_climb_mps"), 0.5) << "upwards";
  EXPECT_DOUBLE_EQ(At(log, 100, "estimator_speed_mps"), 5.0);
  EXPECT_DOUBLE_EQ(At(log, 100, "estimator_climb_mps"), -0.25);
  EXPECT_DOUBLE_EQ(At(log, 100, "throttle_0_1000"), 400.0) << "the float 0.4 is 0.4";
}

// The second flight was passed over without a word, or mixed into the first where it lasted longer.
TEST(ArduPilotLogTest, RefusesAClockThatStartsAgain) {
  EXPECT_EQ(Complaint([] { ParseLog("two.bin", NewLog() + NewLog(), {}); }),
            "two.bin: the clock of BAT instance 0 runs back from 39.900 to 0.000 s: a restart, or two logs "
            "in one file; "
            "give each log as a file of its own");
}

TEST(ArduPilotLogTest, TellsRowsOnTheGroundByItsEvents) {
  const LogTable log = ParseLog("new.bin", NewLog(), {});
  int flown = 0;
  for (std::size_t row = 0; row < log.rows(); ++row) flown += log.OnGround(row) ? 0 : 1;
  EXPECT_EQ(flown, 250);
  EXPECT_TRUE(log.OnGround(88)) << "9.9 s: armed, not yet in the air";
  EXPECT_FALSE(log.OnGround(89));
}

TEST(ArduPilotLogTest, TakesTheEstimatorWhereThereIsNoFix) {
  const LogTable log = ParseLog("new.bin", NewLog({.gps = false}), {});
  EXPECT_DOUBLE_EQ(At(log, 100, "ground_speed_mps"), 5.0);
  EXPECT_DOUBLE_EQ(At(log, 100, "gps_climb_mps"), -0.25);
  EXPECT_NE(log.notes().back().find("estimator"), std::string::npos);
}

TEST(ArduPilotLogTest, ReadsHundredthsAndGpsTimeOfOldLogs) {
  DataFlashWriter log;
  log.Format(10, 3 + 4 + 2 + 2 + 2, "CURR", "Ihhh", "TimeMS,Throttle,Volt,Curr");
  log.Format(11, 3 + 1 + 4 + 4 + 4 + 4, "GPS", "BIEfI", "Status,TimeMS,Spd,VZ,T");
  log.Format(12, 3 + 4 + 4, "BARO", "If", "TimeMS,Alt");
  for (std::uint32_t ms = 0; ms < 1000; ms += 100) {
    log.Message(10, Bytes().Put(ms).Put(std::int16_t{500}).Put(std::int16_t{1654}).Put(std::int16_t{1234}));
    log.Message(11, Bytes().Put(std::uint8_t{3}).Put(603971600U + ms).Put(345U).Put(0.04F).Put(ms));
    log.Message(12, Bytes().Put(ms).Put(7.5F));
  }
  const LogTable table = ParseLog("old.bin", log.log, {});
  ASSERT_EQ(table.rows(), 10u);
  EXPECT_DOUBLE_EQ(At(table, 3, "time_s"), 0.3);
  EXPECT_DOUBLE_EQ(At(table, 3, "battery_voltage_v"), 16.54);
  EXPECT_DOUBLE_EQ(At(table, 3, "battery_current_a"), 12.34);
  EXPECT_DOUBLE_EQ(At(table, 3, "ground_speed_mps"), 3.45);
  EXPECT_DOUBLE_EQ(At(table, 3, "throttle_0_1000"), 500.0);
  EXPECT_DOUBLE_EQ(At(table, 3, "altitude_m"), 7.5);
  EXPECT_FALSE(table.OnGround(3)) << "such a log does not tell";
}

// Rows took the altitude of either, and 3 m between them looked like a climb of 30 m/s.
TEST(ArduPilotLogTest, TakesTheFirstBarometerAndTheFirstReceiver) {
  DataFlashWriter log;
  log.Format(10, 3 + 8 + 4 + 4, "BAT", "Qff", "TimeUS,Volt,Curr");
  log.Format(11, 3 + 8 + 1 + 1 + 4 + 4, "GPS", "QBBff", "TimeUS,I,Status,Spd,VZ");
  log.Format(12, 3 + 8 + 1 + 4, "BARO", "QBf", "TimeUS,I,Alt");
  for (std::uint64_t us = 0; us < 1000000; us += 100000) {
    for (const std::uint8_t instance : {1, 0, 1}) {
      const std::uint64_t stamp = us + (instance == 0 ? 10000 : 0);
      log.Message(
          11,
          Bytes().Put(stamp).Put(instance).Put(std::uint8_t{3}).Put(instance == 0 ? 2.0F : 5.0F).Put(0.0F));
      log.Message(12, Bytes().Put(stamp).Put(instance).Put(instance == 0 ? 20.0F : 23.0F));
    }
    log.Message(10, Bytes().Put(us).Put(15.0F).Put(10.0F));
  }
  const LogTable table = ParseLog("x.bin", log.log, {});
  ASSERT_EQ(table.rows(), 10u);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    EXPECT_DOUBLE_EQ(At(table, row, "altitude_m"), 20.0);
    EXPECT_DOUBLE_EQ(At(table, row, "ground_speed_mps"), 2.0);
  }
}

TEST(ArduPilotLogTest, RefusesLogsWithoutPower) {
  const auto complaint = [](const Made& made) {
    return Complaint([&] { ParseLog("x.bin", NewLog(made), {}); });
  };
  EXPECT_EQ(complaint({.current_a = -1.0F}),
            "x.bin: power was not measured: BAT instance 0: the current is -1 A at 0.000 s and never above 0 "
            "in 400 values; "
            "a log with a current sensor is needed");
  EXPECT_EQ(
      complaint({.second_battery = true}),
      "x.bin: 2 batteries: 0 (BAT instance 0: 15.0 V, 10.0 A on average), 1 (BAT instance 1: 14.0 V, 5.0 A "
      "on "
      "average); say which powers the drone: --battery NUMBER, or --battery all for the sum of their powers");
}

TEST(ArduPilotLogTest, TakesTheBatteryThatIsAskedFor) {
  const std::string bytes = NewLog({.second_battery = true});
  const LogTable second = ParseLog("x.bin", bytes, {.battery = 1});
  EXPECT_DOUBLE_EQ(At(second, 50, "battery_voltage_v") * At(second, 50, "battery_current_a"), 70.0);
  const LogTable all = ParseLog("x.bin", bytes, {.battery = kAllBatteries});
  EXPECT_DOUBLE_EQ(At(all, 50, "battery_voltage_v") * At(all, 50, "battery_current_a"), 220.0);
  EXPECT_NE(Complaint([&] { ParseLog("x.bin", bytes, {.battery = 7}); }).find("--battery 7: there is none"),
            std::string::npos);
}

TEST(ArduPilotLogTest, NamesTheByteOfDamage) {
  std::string bytes = NewLog();
  const auto complaint = [](const std::string& text) {
    return Complaint([&] { ParseLog("x.bin", text, {}); });
  };
  EXPECT_EQ(complaint(bytes.substr(0, bytes.size() - 5)),
            "x.bin: byte " + std::to_string(bytes.size() - 23) +
                ": the file ends inside a XKF1 message (18 of 23 bytes): it is truncated; --skip-bad reads "
                "what is whole");
  EXPECT_EQ(complaint(bytes + std::string(300, '\xFF')), "") << "flash that was never written";
  bytes.insert(bytes.size() / 2, "garbage");
  EXPECT_NE(complaint(bytes), "");
  const LogTable log = ParseLog("x.bin", bytes, {.skip_bad = true});
  EXPECT_GE(log.bad(), 1);
  EXPECT_GE(log.rows(), 387u);
}

// Messages that nothing describes took seconds a megabyte, and a hole of any size was one bad row.
TEST(ArduPilotLogTest, SkipsNoMoreThanATenthOfTheFile) {
  const std::string bytes = NewLog();
  const auto with_hole = [&](std::size_t length) {
    std::string text = bytes, hole;
    while (hole.size() < length) hole += "\xA3\x95\x63-";
    return text.insert(text.size() / 2 - 3, hole.substr(0, length));
  };
  const std::size_t few = bytes.size() / 20, many = bytes.size() / 4;
  const LogTable log = ParseLog("x.bin", with_hole(few), {.skip_bad = true});
  EXPECT_GE(log.rows(), 388u);
  EXPECT_NE(log.notes().end()[-2].find("bytes could not be read, the first is byte"), std::string::npos);
  const std::string message = Complaint([&] { ParseLog("x.bin", with_hole(many), {.skip_bad = true}); });
  EXPECT_NE(message.find(fmt::format(" of {} bytes, at most 10 % are allowed", bytes.size() + many)),
            std::string::npos)
      << message;
  EXPECT_EQ(Complaint([&] {
              ParseLog("x.bin", bytes.substr(0, bytes.size() - 5) + std::string(bytes.size(), '\xFF'),
                       {.skip_bad = true});
            }),
            "")
      << "cut off before flash that was never written";
}

TEST(ArduPilotLogTest, RefusesDescriptionsThatDoNotAddUp) {
  DataFlashWriter log;
  log.Format(10, 200, "BAT", "QBff", "TimeUS,Inst,Volt,Curr");
  EXPECT_NE(Complaint([&] {
              ParseLog("x.bin", log.log, {});
            }).find("FMT of BAT: its fields take 20 bytes, but its length is 200"),
            std::string::npos);
  DataFlashWriter twice;
  twice.Format(10, 3 + 4, "BARO", "f", "Alt");
  twice.Format(10, 3 + 8, "BARO", "ff", "Alt,Press");
  EXPECT_NE(Complaint([&] { ParseLog("x.bin", twice.log, {}); }).find("type 10 is BARO already"),
            std::string::npos);
}

}  // namespace
}  // namespace ed3r::flight_logs
