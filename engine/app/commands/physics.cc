#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "engine/app/commands.h"
#include "engine/app/settings.h"
#include "engine/radio/link.h"
#include "engine/robot/airframe.h"
#include "engine/robot/energy.h"

namespace ed3r::app {
namespace {

struct Row {
  const char* name;
  double value;
  const char* unit;
  const char* meaning;
};

struct Options {
  std::vector<std::string> settings;
  bool json = false;
};

std::vector<Row> ClosedForms(const Config& c) {
  const robot::MovementPower power = robot::MovementPowerOf(c.robot, c.environment, c.energy);
  const radio::Link link = radio::EvaluateLink(c.radio, c.point.radio_distance_m, c.point.radio_bandwidth_hz,
                                               c.point.radio_shadowing_db);
  const double payload_byte = robot::PayloadByte(c.sensing);
  const robot::ComputationCost full =
      robot::Computation(c.cpu, c.sensing, c.cpu.full_gflop, c.point.cpu_frequency_hz);
  const robot::ComputationCost quantized =
      robot::Computation(c.cpu, c.sensing, c.cpu.quantized_gflop, c.point.cpu_frequency_hz);
  return {
      {"hover_power_w", power.hover_w, "W", "P_hov (R1)"},
      {"horizontal_power_w", power.horizontal_w, "W",
       robot::BillsWind(c.environment, c.energy) ? "P_hor across the wind; other courses draw otherwise"
                                                 : "P_hor (R2)"},
      {"ascent_power_w", power.ascent_w, "W", "P_ver upwards (R3)"},
      {"descent_power_w", power.descent_w, "W", "P_ver downwards (R3)"},
      {"sensing_energy_j", robot::SensingEnergyJ(c.sensing), "J",
       "E_sensing of one sensing period (Eq. 3, R6)"},
      {"battery_j", c.robot.BatteryJ(), "J", "beta_max (R8)"},
      {"transmit_power_dbm", link.transmit_power_dbm, "dBm", "p_k (R10)"},
      {"rate_bps", link.rate_bps, "bit/s", "d_k (R11)"},
      {"transmission_time_s", radio::TransmissionTimeS(payload_byte, link), "s", "T_transmission (Eq. 8)"},
      {"transmission_energy_j", radio::TransmissionEnergyJ(payload_byte, link), "J",
       "E_transmission (Eq. 9)"},
      {"full_time_s", full.time_s, "s", "T_computation, Full CNN (Eq. 5)"},
      {"full_energy_j", full.energy_j, "J", "E_computation, Full CNN (Eq. 6)"},
      {"quantized_time_s", quantized.time_s, "s", "T_computation, Quantized CNN (Eq. 5)"},
      {"quantized_energy_j", quantized.energy_j, "J", "E_computation, Quantized CNN (Eq. 6)"},
  };
}

int Print(const Options& options) {
  Config config;
  ApplySettings(options.settings, Scope::kPhysicsOnly, config);
  const std::vector<Row> rows = ClosedForms(config);
  if (options.json) {
    nlohmann::ordered_json object;
    for (const Row& row : rows) object[row.name] = row.value;
    fmt::print("{}\n", object.dump(2));
    return kDone;
  }
  fmt::print("At f = {:g} GHz, {:g} m from the RC, {:g} MHz, shadowing {:g} dB:\n\n",
             config.point.cpu_frequency_hz / 1e9, config.point.radio_distance_m,
             config.point.radio_bandwidth_hz / 1e6, config.point.radio_shadowing_db);
  for (const Row& row : rows)
    fmt::print("  {:<22} {:>14.6g} {:<6} {}\n", row.name, row.value, row.unit, row.meaning);
  for (const std::string& problem : {robot::CheckFlyable(config), robot::CheckBilledPower(config)})
    if (!problem.empty()) fmt::print("\nno mission flies with this: {}\n", problem);
  return kDone;
}

}  // namespace

Command AddPhysics(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser =
      program.AddCommand("physics", "Closed-form powers, times, energies and link budget at given values");
  parser.Option("--set", options->settings, "KEY=VALUE; any key of 'ed3r params'").OneValue();
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] { return Print(*options); }};
}

}  // namespace ed3r::app
