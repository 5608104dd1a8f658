// Names of columns that say another unit than the fit's.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <utility>

#include "studies/fit/unit_check.h"
#include "tests/flight_logs/complaint.h"

namespace ed3r::fit {
namespace {

// What is said of a column of this name that is read as `meaning`; its numbers can be in any unit.
std::string Says(const std::string& meaning, const std::string& name) {
  std::map<std::string, std::string> columns = {{"time_s", "t"},       {"power_w", "p"},
                                                {"airspeed_mps", "v"}, {"climb_mps", "w"},
                                                {"altitude_m", "a"},   {"payload_kg", "load"}};
  if (meaning == "ground_speed_mps") columns.erase("airspeed_mps");
  columns[meaning] = name;
  std::string header, row, format = "columns: {";
  for (const auto& [key, column] : columns) {
    header += fmt::format("{}\"{}\"", header.empty() ? "" : ",", column);
    row += row.empty() ? "1" : ",1";
    format += fmt::format("{}: \"{}\", ", key, column);
  }
  format += "}\nrobot: {mass_kg: 2, propellers: 4, propeller_radius_m: 0.12}\n";
  return flight_logs::Complaint([&] {
    CheckUnits(flight_logs::LogTable(CsvTable::Parse("log.csv", header + "\n" + row + "\n")),
               ParseLogFormat("format.yaml", format));
  });
}

TEST(UnitNamesTest, OtherUnitsAreHeardHoweverTheyAreSpelt) {
  const std::map<std::string, std::map<std::string, std::string>> factors = {
      {"airspeed_mps",
       {{"speed_kmh", "0.277778"},
        {"speed_km_h", "0.277778"},
        {"Speed [km h-1]", "0.277778"},
        {"Speed (km/h)", "0.277778"},
        {"speed/km/h", "0.277778"},
        {"speedKmh", "0.277778"},
        {"speedkmh", "0.277778"},
        {"groundspeedkph", "0.277778"},
        {"SPEEDMPH", "0.44704"},
        {"speedknots", "0.514444"},
        {"gskts", "0.514444"},
        {"velcms", "0.01"},
        {"speedfts", "0.3048"},
        {"Kilometres per hour", "0.277778"},
        {"speed_ft_s", "0.3048"},
        {"speed ft s-1", "0.3048"},
        {"speed_fps", "0.3048"},
        {"Speed, mph", "0.44704"},
        {"v_kn", "0.514444"},
        {"speed cm s^-1", "0.01"},
        {"speed yd/s", "0.9144"},
        {"speed mm/s", "0.001"},
        {"speed_ft_min", "0.00508"},
        {"speed_ftps", "0.3048"},
        {"speed_feet_per_s", "0.3048"},
        {"speed_ftpm", "0.00508"},
        {"speed_feet/min", "0.00508"},
        {"speed_cmps", "0.01"},
        {"speed_mmps", "0.001"},
        {"speed_dmps", "0.1"},
        {"speed_miph", "0.44704"},
        {"speed miles/h", "0.44704"},
        {"speed_mpm", "0.0166667"},
        {"speed_kmperh", "0.277778"},
        {"speed km per hour", "0.277778"},
        {"speedKmPerHour", "0.277778"},
        {"speed_knts", "0.514444"},
        {"KIAS", "0.514444"},
        {"v_NM_h", "0.514444"},
        {"speed_nmph", "0.514444"},
        {"nautical miles per hour", "0.514444"}}},
      {"voltage_v", {{"battery_cV", "0.01"}}},
      {"current_a", {{"current_cA", "0.01"}}},
      {"ground_speed_mps", {{"gs (kn)", "0.514444"}}},
      {"time_s", {{"time [h]", "3600"}}},
      {"climb_mps",
       {{"vs_ft_min", "0.00508"},
        {"vs (ft/min)", "0.00508"},
        {"vs m min-1", "0.0166667"},
        {"climbratefpm", "0.00508"},
        {"varioftmin", "0.00508"}}},
      {"power_w", {{"power_kW", "1000"}, {"powerKw", "1000"}, {"powerkw", "1000"}, {"Power [mW]", "0.001"}}},
      {"altitude_m",
       {{"alt_ft", "0.3048"},
        {"AltitudeFt", "0.3048"},
        {"heightft", "0.3048"},
        {"GPSALTFEET", "0.3048"},
        {"alt (cm)", "0.01"},
        {"alt (yd)", "0.9144"},
        {"alt_fathoms", "1.8288"},
        {"alt inches", "0.0254"},
        {"alt [dm]", "0.1"},
        {"alt nmi", "1852"}}},
      {"payload_kg", {{"load (g)", "0.001"}, {"loadLbs", "0.453592"}, {"payloadlbs", "0.453592"}}}};
  for (const auto& [meaning, names] : factors)
    for (const auto& [name, factor] : names) {
      const std::string message = Says(meaning, name);
      EXPECT_TRUE(message.starts_with(fmt::format("log.csv:1:1: {} ('{}'): the name says ", meaning, name)))
          << message;
      EXPECT_NE(message.find(fmt::format("put 'units: {{{}: {}}}' into", meaning, factor)), std::string::npos)
          << message;
    }
}

// What a battery gave so far was read as what it gives.
TEST(UnitNamesTest, SumsAreNoRates) {
  EXPECT_EQ(Says("power_w", "energy_Wh"),
            "log.csv:1:1: power_w ('energy_Wh'): the name says wh; no factor makes power_w of that: name "
            "another column ('units: {power_w: 1}' if it is right)");
}

// They were decimetres.
TEST(UnitNamesTest, ARateDownwardsIsNoOtherUnit) {
  for (const auto& [name, factor] : {std::pair("vel_d_m_s", "-1"), std::pair("velD_mps", "-1"),
                                     std::pair("vel_d_ms", "-1"), std::pair("vel_d_cm_s", "-0.01")})
    EXPECT_EQ(
        Says("climb_mps", name),
        fmt::format("log.csv:1:1: climb_mps ('{}'): the name says a rate downwards; it looks like a rate "
                    "downwards: put 'units: {{climb_mps: {}}}' into the format file (climb_mps: 1 if the "
                    "values are right)",
                    name, factor));
}

// What is said of 600 rows at 0.5 s whose clock stands so at each second and half second.
std::string SaysOfTimes(const std::function<std::string(int, int)>& time) {
  std::string text = "t,p,v,w\n";
  for (int row = 0; row < 600; ++row) text += fmt::format("{},300,1,0\n", time(row / 2, row % 2 * 5));
  return flight_logs::Complaint([&] {
    CheckUnits(flight_logs::LogTable(CsvTable::Parse("log.csv", text)),
               ParseLogFormat("f.yaml", "columns: {time_s: t, power_w: p, airspeed_mps: v, climb_mps: w}\n"));
  });
}

// Each full minute was a gap, and the energies of held-out segments were others.
TEST(UnitNamesTest, ATimeOfDayIsNoTimeInSeconds) {
  const auto from = [](int start_s) {
    return SaysOfTimes([=](int s, int tenths) {
      s += start_s;
      return fmt::format("{}{:02}{:02}.{}", s / 3600, s / 60 % 60, s % 60, tenths);
    });
  };
  const std::string text =
      "log.csv:1:1: time_s ('t'): it leaps by 40 whenever it reaches 60 beyond a hundred, 5 "
      "times; it looks like a time of day, hhmmss: seconds are wanted";
  EXPECT_EQ(from(36123), text);
  EXPECT_EQ(from(43110), text);  // over the end of an hour
  EXPECT_EQ(SaysOfTimes([](int s, int tenths) { return fmt::format("{}.{}", s < 60 ? s : s + 40, tenths); }),
            "");
}

TEST(UnitNamesTest, DaysAreHeard) {
  const std::string message = SaysOfTimes(
      [](int s, int tenths) { return fmt::format("{:.9f}", 45000 + (s + 0.1 * tenths) / 86400); });
  EXPECT_NE(message.find("it looks like days: put 'units: {time_s: 86400}' into"), std::string::npos)
      << message;
}

TEST(UnitNamesTest, NamesThatMerelyHaveSuchLettersAreTaken) {
  for (const char* name : {"speed_m_s", "Speed [m s-1]", "airspeedMps", "known_speed", "speed_over_km",
                           "hkmhs", "speed_mps", "speed m/sec", "v_metres_per_second", "metersPerSecond",
                           "ins_speed", "min_speed", "speed_ms_h", "speed_m_h", "kms_speed"})
    EXPECT_EQ(Says("airspeed_mps", name), "") << name;
  for (const char* name : {"vel_d_m_s", "vel_n_m_s", "speed_3d_m_s", "vel_d_mps", "speed3D (m/s)"})
    EXPECT_EQ(Says("ground_speed_mps", name), "") << name;
  for (const char* name :
       {"V_m (m/s)", "vz_c m s-1", "veldms", "climbms", "lifts", "shifts", "driftspeed", "speedmin", "lymph"})
    EXPECT_EQ(Says("climb_mps", name), "") << name;
  for (const char* name : {"time_m_s", "Time (s)", "timestamp"}) EXPECT_EQ(Says("time_s", name), "") << name;
  for (const char* name : {"power_w", "PowerW", "maximum", "powerwatts", "powermean"})
    EXPECT_EQ(Says("power_w", name), "") << name;
  for (const char* name : {"shift", "aftAltitude", "cmd", "left", "aircraft", "draft", "soft", "lift",
                           "altmetres", "heightm", "altimeter"})
    EXPECT_EQ(Says("altitude_m", name), "") << name;
}

}  // namespace
}  // namespace ed3r::fit
