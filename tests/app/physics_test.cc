// `ed3r physics --json` against the closed forms written down here a second time, at random legal values.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine/core/random.h"
#include "tests/app/command.h"

namespace ed3r::app {
namespace {

using Values = std::map<std::string, double>;

Values Defaults() {
  return {{"robot.mass_kg", 1.816},         {"robot.propeller_radius_m", 0.1},
          {"robot.propellers", 4},          {"robot.speed_mps", 5},
          {"robot.drag_horizontal", 0.55},  {"robot.drag_vertical", 0.35},
          {"robot.battery_mah", 3500},      {"robot.battery_v", 11.1},
          {"cpu.frequency_hz", 3.2e9},      {"cpu.cores", 6},
          {"cpu.flops_per_cycle", 8},       {"cpu.capacitance", 1e-28},
          {"radio.distance_m", 60},         {"radio.bandwidth_hz", 22.5e6},
          {"radio.shadowing_db", 0},        {"environment.air_density_kgm3", 1.225},
          {"environment.gravity_mps2", 9.8}};
}

// Written from the paper and the readings, not from the program.
Values Expected(Values v) {
  Values e;
  const double area = std::numbers::pi * v["robot.propeller_radius_m"] * v["robot.propeller_radius_m"];
  const double m = v["robot.mass_kg"], g = v["environment.gravity_mps2"],
               rho = v["environment.air_density_kgm3"];
  const double speed3 = v["robot.speed_mps"] * v["robot.speed_mps"] * v["robot.speed_mps"];
  e["hover_power_w"] = std::sqrt(m * m * m * g * g * g / (2 * rho * v["robot.propellers"] * area));
  e["horizontal_power_w"] = e["hover_power_w"] + rho * 0.23 * 0.47 * speed3 * v["robot.drag_horizontal"] / 2;
  e["ascent_power_w"] = m * g + rho * 0.47 * 0.47 * speed3 * v["robot.drag_vertical"] / 2;
  e["descent_power_w"] = m * g - rho * 0.47 * 0.47 * speed3 * v["robot.drag_vertical"] / 2;
  e["sensing_energy_j"] = 3 * (2 + 6 * 0.9);
  e["battery_j"] = v["robot.battery_mah"] * 3.6 * v["robot.battery_v"];
  const double loss = 20 * std::log10(4 * std::numbers::pi * 2.4e9 / 299792458.0) +
                      38 * std::log10(std::max(1.0, v["radio.distance_m"]));
  const double power_dbm = std::min(33.0, std::max(14.0, loss - 80));
  const double noise_dbm = -158 + 10 * std::log10(v["radio.bandwidth_hz"]);
  const double snr = std::pow(10, (power_dbm - loss - v["radio.shadowing_db"] - noise_dbm) / 10);
  e["transmit_power_dbm"] = power_dbm;
  e["rate_bps"] =
      v["radio.bandwidth_hz"] * std::min(4.0, std::max(0.12, std::log1p(snr) / std::numbers::ln2));
  e["transmission_time_s"] = 33 * 519e3 * 8 / e["rate_bps"];
  e["transmission_energy_j"] = e["transmission_time_s"] * std::pow(10, power_dbm / 10) / 1000;
  for (const auto& [model, gflop] : {std::pair{"full", 20.23}, std::pair{"quantized", 5.05}}) {
    const double cycles = 33 * gflop * 1e9 / v["cpu.flops_per_cycle"];
    e[fmt::format("{}_time_s", model)] = cycles / v["cpu.cores"] / v["cpu.frequency_hz"];
    e[fmt::format("{}_energy_j", model)] = v["cpu.capacitance"] * cycles * std::pow(v["cpu.frequency_hz"], 2);
  }
  return e;
}

void ExpectAgreement(const Values& values) {
  std::string arguments = "physics --json";
  for (const auto& [key, value] : values) arguments += fmt::format(" --set {}={}", key, value);
  const CommandResult result = Ed3r(arguments);
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const Values expected = Expected(values);
  EXPECT_EQ(json.size(), expected.size());
  for (const auto& [name, value] : expected) {
    const double found = json.at(name).get<double>();
    EXPECT_NEAR(found, value, 1e-9 * std::max(std::abs(value), 1e-9)) << name << " for " << arguments;
  }
}

TEST(PhysicsCommandTest, PaperValues) {
  ExpectAgreement(Defaults());
  const auto json = nlohmann::json::parse(Ed3r("physics --json").out);
  EXPECT_NEAR(json["hover_power_w"].get<double>(), 135.3, 0.05);
  EXPECT_NEAR(json["full_time_s"].get<double>(), 4.35, 0.005);
  EXPECT_NEAR(json["battery_j"].get<double>(), 139860, 1e-6);
  EXPECT_NEAR(json["sensing_energy_j"].get<double>(), 22.2, 1e-9);
}

TEST(PhysicsCommandTest, RandomLegalValues) {
  Stream stream(11, 0, Purpose::kScenario);
  for (int i = 0; i < 60; ++i) {
    Values v = Defaults();
    v["robot.mass_kg"] = stream.Uniform(0.05, 50);
    v["robot.propeller_radius_m"] = stream.Uniform(0.01, 1);
    v["robot.propellers"] = 3 + stream.Below(14);
    v["robot.speed_mps"] = stream.Uniform(0.5, 15);
    v["robot.drag_horizontal"] = stream.Uniform(0, 5);
    v["robot.drag_vertical"] = stream.Uniform(0, 5);
    v["robot.battery_mah"] = stream.Uniform(100, 1e5);
    v["robot.battery_v"] = stream.Uniform(3, 60);
    v["cpu.frequency_hz"] = stream.Uniform(1e8, 1e10);
    v["cpu.cores"] = 1 + stream.Below(256);
    v["cpu.flops_per_cycle"] = stream.Uniform(0.5, 1024);
    v["cpu.capacitance"] = stream.Uniform(1e-30, 1e-25);
    v["radio.distance_m"] = stream.Uniform(0, 500);
    v["radio.bandwidth_hz"] = stream.Uniform(1e5, 1e9);
    v["radio.shadowing_db"] = stream.Uniform(-60, 60);
    v["environment.air_density_kgm3"] = stream.Uniform(0.3, 2);
    v["environment.gravity_mps2"] = stream.Uniform(1, 30);
    ExpectAgreement(v);
  }
}

// The airframe that `ed3r fit` made of the Matrice 100's flights: in still air it hovers at the ideal power of its four
// 0.17 m rotors times (induced factor + profile share) / efficiency. (Its logged hovers, in wind, took 480 W.)
TEST(PhysicsCommandTest, AnAirframeFileIsIncluded) {
  const std::string file = ED3R_SOURCE_DIR "/sweeps/data/flight/m100_fitted.yaml";
  const CommandResult result = Ed3r("physics --json --set robot=" + file);
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const double discs_m2 = 4 * std::numbers::pi * 0.17 * 0.17;
  const double ideal_w = std::sqrt(std::pow(3.68 * 9.8, 3) / (2 * 1.225 * discs_m2));
  EXPECT_NEAR(json["hover_power_w"].get<double>(), ideal_w * (1.45593 + 0) / 0.713262, 1e-6);
  EXPECT_GT(json["ascent_power_w"].get<double>(), json["hover_power_w"].get<double>());
  EXPECT_LT(json["descent_power_w"].get<double>(), json["hover_power_w"].get<double>());
  const CommandResult missing = Ed3r("physics --set robot=none.yaml");
  EXPECT_EQ(missing.status, 2);
  EXPECT_EQ(missing.err,
            "--set robot=none.yaml: robot: 'none.yaml' is not a file; allowed: an airframe file as 'ed3r fit "
            "--out' writes it\n");
}

TEST(PhysicsCommandTest, BadInputIsOneLineAndExitTwo) {
  const std::pair<const char*, const char*> cases[] = {
      {"physics --set robot.mass_kg=-1",
       "--set robot.mass_kg=-1: robot.mass_kg: '-1' is not allowed; allowed: 0.05 .. 50 kg\n"},
      {"physics --set robot.mas_kg=1",
       "--set robot.mas_kg=1: robot.mas_kg: unknown key; did you mean robot.mass_kg?\n"},
      {"physics --set robot.mass_kg", "--set robot.mass_kg: expected KEY=VALUE, e.g. robot.mass_kg=2.1\n"},
      {"physics --set radio.distance_m=inf",
       "--set radio.distance_m=inf: radio.distance_m: 'inf' is not allowed; allowed: 0 .. 100000 m\n"},
  };
  for (const auto& [arguments, message] : cases) {
    const CommandResult result = Ed3r(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(result.err, message);
    EXPECT_EQ(result.out, "");
  }
}

}  // namespace
}  // namespace ed3r::app
