#include "studies/flight_logs/px4_log.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "studies/flight_logs/read_log.h"
#include "tests/flight_logs/complaint.h"
#include "tests/flight_logs/log_writers.h"

namespace ed3r::flight_logs {
namespace {

struct Made {
  float current_a = 12.0F;
  bool armed = true, second_battery = false, valid = true;
};

// 40 s: the battery at 5 Hz, the estimator at 10 Hz; armed from 5 s, landed until 10 s and from 35 s on. The position has a
// field of a nested type and an array before those that are read.
std::string Log(const Made& made = {}) {
  ULogWriter log;
  log.Message('F',
              "battery_status:uint64_t timestamp;float voltage_v;float current_a;bool connected;uint8_t[3] "
              "_padding0;");
  log.Message('F', "offset:float x;float y;");
  log.Message('F',
              "vehicle_local_position:uint64_t timestamp;offset origin;float[2] delta;float vx;float "
              "vy;float vz;float z;"
              "bool v_xy_valid;bool v_z_valid;");
  log.Message('F', "actuator_armed:uint64_t timestamp;bool armed;");
  log.Message('F', "vehicle_land_detected:uint64_t timestamp;bool landed;");
  log.Message('F', "unused:uint64_t timestamp;float x;");
  log.Topic(1, 0, "battery_status");
  log.Topic(2, 0, "vehicle_local_position");
  log.Topic(3, 0, "actuator_armed");
  log.Topic(4, 0, "vehicle_land_detected");
  log.Topic(5, 0, "unused");
  log.Topic(6, 1, "battery_status");
  for (int i = 0; i < 400; ++i) {
    const auto us = static_cast<std::uint64_t>(100000 * i);
    if (i % 2 == 0) log.Sample(1, Bytes().Put(us).Put(16.0F).Put(made.current_a).Put(true));
    if (i % 2 == 0 && made.second_battery) log.Sample(6, Bytes().Put(us).Put(16.0F).Put(3.0F).Put(true));
    log.Sample(2, Bytes()
                      .Put(us + 40000)
                      .Put(9.0F)
                      .Put(9.0F)
                      .Put(9.0F)
                      .Put(9.0F)
                      .Put(3.0F)
                      .Put(static_cast<float>(i))
                      .Put(0.5F)
                      .Put(-20.0F)
                      .Put(made.valid)
                      .Put(true));
    if (i % 10 == 0) log.Sample(3, Bytes().Put(us).Put(made.armed && i >= 50));
    if (i % 10 == 0) log.Sample(4, Bytes().Put(us).Put(i < 100 || i >= 350));
    log.Sample(5, Bytes().Put(us).Put(0.0F));
  }
  return log.log;
}

double At(const LogTable& log, std::size_t row, const std::string& column) {
  return log.Number(row, log.Column(column, "test"), -1e9, 1e9);
}

TEST(Px4LogTest, JoinsTopicsOnTheBatterysClock) {
  const LogTable log = ParseLog("x.ulg", Log(), {});
  EXPECT_EQ(log.kind(), LogKind::kPx4);
  ASSERT_EQ(log.rows(), 200u);
  EXPECT_DOUBLE_EQ(At(log, 2, "time_s"), 0.4);
  EXPECT_DOUBLE_EQ(At(log, 2, "ground_speed_mps"), 5.0) << "hypot(3, 4): the sample of 0.44 s";
  EXPECT_DOUBLE_EQ(At(log, 2, "climb_mps"), -0.5) << "vz is downwards";
  EXPECT_DOUBLE_EQ(At(log, 2, "altitude_m"), 20.0);
  EXPECT_DOUBLE_EQ(At(log, 2, "battery_current_a"), 12.0);
  int flown = 0;
  for (std::size_t row = 0; row < log.rows(); ++row) flown += log.OnGround(row) ? 0 : 1;
  EXPECT_EQ(flown, 125) << "10 s to 35 s";
}

TEST(Px4LogTest, SaysWhyThereIsNothingToFit) {
  const auto complaint = [](const Made& made) {
    return Complaint([&] { ParseLog("x.ulg", Log(made), {}); });
  };
  EXPECT_EQ(complaint({.current_a = -1.0F}),
            "x.ulg: power was not measured: battery_status 0: the current is -1 A at 0.000 s and never above "
            "0 in 200 values; "
            "a log with a current sensor is needed");
  EXPECT_EQ(complaint({.armed = false}),
            "x.ulg: no flight: never armed from 0.0 to 39.8 s; a log of a flight is needed");
  EXPECT_EQ(complaint({.valid = false}),
            "x.ulg: no velocity: vehicle_local_position never says that its velocities are valid");
  EXPECT_NE(complaint({.second_battery = true})
                .find("2 batteries: 0 (battery_status 0: 16.0 V, 12.0 A on average), 1 ("),
            std::string::npos);
}

TEST(Px4LogTest, NamesTheByteOfDamage) {
  const std::string bytes = Log();
  const auto complaint = [](const std::string& text) {
    return Complaint([&] { ParseLog("x.ulg", text, {}); });
  };
  EXPECT_EQ(complaint(bytes.substr(0, bytes.size() - 3)),
            "x.ulg: byte " + std::to_string(bytes.size() - 17) +
                ": the file ends inside a message of type D (11 of 14 bytes): it is truncated; --skip-bad "
                "reads what stands before");
  EXPECT_EQ(complaint(bytes.substr(0, 12)),
            "x.ulg: byte 12: the file ends inside the header: it is truncated; --skip-bad reads what stands "
            "before");
  EXPECT_NE(complaint(bytes + "garbage").find("no message begins here"), std::string::npos);
  const LogTable log = ParseLog("x.ulg", bytes + "garbage", {.skip_bad = true});
  EXPECT_EQ(log.bad(), 1);
  EXPECT_EQ(log.rows(), 200u);
}

// One bit at a third of the flight: what stands behind it was left out as "1 rows".
TEST(Px4LogTest, SkipsNoMoreThanATenthOfTheFile) {
  const std::string bytes = Log();
  const std::size_t written = bytes.size() - 8;  // zeros at the end are as flash that was never written
  const auto with_bad_type_at = [&](double share) {
    std::string text = bytes;
    const std::size_t at =
        text.find("D\x02", static_cast<std::size_t>(share * static_cast<double>(text.size())));
    text[at] = '\x04';
    return std::pair{text, at - 2};
  };
  const auto [third, third_at] = with_bad_type_at(0.33);
  for (const bool skip_bad : {true, false})
    EXPECT_EQ(
        Complaint([&, &text = third] { ParseLog("x.ulg", text, {.skip_bad = skip_bad}); }),
        fmt::format("x.ulg: byte {}: no message begins here (type 4): the file is damaged; --skip-bad would "
                    "leave out {} of {} bytes, at most 10 % are allowed",
                    third_at, written - third_at, written))
        << "it is not advised where it would be refused";
  const auto [late, late_at] = with_bad_type_at(0.95);
  const LogTable log = ParseLog("x.ulg", late, {.skip_bad = true});
  EXPECT_EQ(log.rows(), 191u);
  EXPECT_NE(std::find(log.notes().begin(), log.notes().end(),
                      fmt::format("x.ulg: {} of {} bytes could not be read, the first is byte {}",
                                  written - late_at, written, late_at)),
            log.notes().end());
}

// 100 fields of a type of 100 fields, six deep: 100^6 fields without a byte.
TEST(Px4LogTest, ReadsEachDescriptionOnce) {
  ULogWriter log;
  log.Message('F', "L0:");
  for (int level = 1; level <= 6; ++level) {
    std::string text = fmt::format("L{}:", level);
    for (int i = 0; i < 100; ++i) text += fmt::format("L{} a;", level - 1);
    log.Message('F', text);
  }
  log.Message('F', "battery_status:uint64_t timestamp;L6 x;float voltage_v;float current_a;");
  log.Topic(1, 0, "battery_status");
  for (std::uint64_t us = 0; us < 1000000; us += 100000) log.Sample(1, Bytes().Put(us).Put(16.0F).Put(12.0F));
  EXPECT_EQ(Complaint([&] { ParseLog("x.ulg", log.log, {}); }),
            "x.ulg: no velocity: vehicle_local_position is not in the log");
}

TEST(Px4LogTest, RefusesDescriptionsThatDoNotAddUp) {
  const auto complaint = [](const std::string& description) {
    ULogWriter log;
    log.Message('F', description);
    log.Topic(1, 0, "battery_status");
    return Complaint([&] { ParseLog("x.ulg", log.log, {}); });
  };
  EXPECT_NE(
      complaint("battery_status:uint64_t timestamp;battery_status inner;").find("nest more than 8 deep"),
      std::string::npos);
  const auto nested = [&](int levels) {
    ULogWriter log;
    log.Message('F', "L0:float x;");
    for (int level = 1; level <= levels; ++level)
      log.Message('F', fmt::format("L{}:L{} x;", level, level - 1));
    log.Message('F', "vehicle_air_data:L6 x;");
    log.Message('F', fmt::format("battery_status:L{} x;", levels));
    log.Topic(1, 0, "vehicle_air_data");
    log.Topic(2, 0, "battery_status");
    return Complaint([&] { ParseLog("x.ulg", log.log, {}); });
  };
  EXPECT_EQ(nested(7).find("nest more than 8 deep"), std::string::npos);
  EXPECT_NE(nested(8).find("nest more than 8 deep"), std::string::npos) << "of which six were read before";
  EXPECT_NE(complaint("battery_status:uint64_t[60000] x;").find("takes more than 65536 bytes"),
            std::string::npos);
  EXPECT_NE(complaint("battery_status:uint64_t").find("a field that is not 'type name'"), std::string::npos);
  EXPECT_NE(complaint("other:float x;").find("topic 'battery_status' is not described"), std::string::npos);
}

}  // namespace
}  // namespace ed3r::flight_logs
