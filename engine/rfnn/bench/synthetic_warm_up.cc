#include "engine/rfnn/bench/synthetic_warm_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/core/random.h"
#include "engine/rfnn/features.h"

namespace ed3r::rfnn {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSideM = 530.0, kHeightM = 165.0;
constexpr double kFires[6][2] = {{90, 110}, {260, 70}, {430, 150}, {120, 390}, {300, 450}, {460, 380}};
constexpr double kRcM[3] = {265, 265, 15};

// The walker: pose, what it knows of the last timestep, and the fire of its mission.
struct Walk {
  double x, y, z, yaw, tilt = 0.0;
  double scs = 0.0, energy_j = 0.0, battery_j = 139860.0;
  const double* fire;
};

double Distance(const Walk& w, double x, double y, double z) {
  return std::sqrt((w.x - x) * (w.x - x) + (w.y - y) * (w.y - y) + (w.z - z) * (w.z - z));
}

double Wrap(double angle) { return std::remainder(angle, 2.0 * kPi); }

// High when the fire stands in the camera's field of view and is near; now and then hidden.
double Look(const Walk& w, bool quantized, Stream& stream) {
  const double away = std::hypot(w.fire[0] - w.x, w.fire[1] - w.y);
  const double bearing = Wrap(std::atan2(w.fire[1] - w.y, w.fire[0] - w.x) - w.yaw);
  const double below = std::atan2(w.z, away) - w.tilt;
  const double quality =
      0.95 - std::hypot(away, w.z) / 700.0 - (quantized ? 0.05 : 0.0) + 0.08 * stream.Normal();
  const bool hidden = stream.Uniform() < std::min(0.9, away / 500.0);
  if (hidden || std::abs(bearing) > 0.75 || std::abs(below) > 0.5) return 0.0;
  return std::clamp(quality, 0.0, 1.0);
}

void Step(Walk& w, std::int64_t mission, Stream& s, SyntheticWarmUp& log) {
  const double move[3] = {s.Uniform(-20, 20), s.Uniform(-20, 20), s.Uniform(-20, 20)};
  const double turn = s.Uniform(-kPi / 2, kPi / 2), tilt = s.Uniform(0, kPi / 2);
  const std::array<double, kRcInputs> rc = {
      w.x,     w.y,     w.z,     w.yaw, w.tilt, Distance(w, kRcM[0], kRcM[1], kRcM[2]), w.scs, w.energy_j,
      move[0], move[1], move[2], turn,  tilt};
  const double x = std::clamp(w.x + move[0], 0.0, kSideM), y = std::clamp(w.y + move[1], 0.0, kSideM),
               z = std::clamp(w.z + move[2], 5.0, kHeightM);
  const double move_j = 140.0 * (std::hypot(x - w.x, y - w.y) / 5.0) + 20.0 * (std::abs(z - w.z) / 5.0);
  w.x = x, w.y = y, w.z = z, w.yaw = Wrap(w.yaw + turn), w.tilt = tilt;

  const double distance = Distance(w, kRcM[0], kRcM[1], kRcM[2]);
  const double cpu = s.Uniform(1.5, 3.2) / 3.2, bandwidth = s.Uniform(15e6, 30e6);
  const double snr_db = 95.0 - 38.0 * std::log10(std::max(1.0, distance)) + 8.0 * s.Normal();
  const double rate = bandwidth * std::clamp(std::log2(1.0 + std::pow(10.0, snr_db / 10.0)), 0.12, 4.0);
  const std::uint32_t choice = s.Below(3);
  const std::array<double, kRobotInputs> robot = {w.yaw,
                                                  w.tilt,
                                                  w.battery_j / 139860.0,
                                                  cpu,
                                                  distance,
                                                  bandwidth,
                                                  rate,
                                                  w.scs,
                                                  w.energy_j,
                                                  kRobotActions[choice][0],
                                                  kRobotActions[choice][1]};
  const double busy_s = choice == 0 ? 137e6 / rate : (choice == 1 ? 5.0 : 2.0) / cpu;
  w.energy_j = move_j + 135.3 * (3.0 + busy_s) + 22.2;
  w.scs = Look(w, choice == 2, s);
  w.battery_j = std::max(0.0, w.battery_j - w.energy_j);
  const double reward = -(w.energy_j / 10000.0 + 2.0 * (std::max(0.0, 0.75 - w.scs) + 1.0 - w.scs));

  std::array<float, kRcInputs> rc_row;
  std::array<float, kRobotInputs> robot_row;
  std::transform(rc.begin(), rc.end(), rc_row.begin(), [](double v) { return static_cast<float>(v); });
  std::transform(robot.begin(), robot.end(), robot_row.begin(),
                 [](double v) { return static_cast<float>(v); });
  log.rc.Add(rc_row, static_cast<float>(reward), mission);
  log.robot.Add(robot_row, static_cast<float>(reward), mission);
}

}  // namespace

SyntheticWarmUp MakeSyntheticWarmUp(int missions, int timesteps, std::uint64_t seed) {
  SyntheticWarmUp log{DataSet(kRcInputs), DataSet(kRobotInputs)};
  for (int m = 0; m < missions; ++m) {
    Stream s(seed, static_cast<std::uint32_t>(m), Purpose::kScenario);
    Walk walk{s.Uniform(200, 330),
              s.Uniform(200, 330),
              s.Uniform(30, 60),
              s.Uniform(-kPi, kPi),
              0.0,
              0.0,
              0.0,
              139860.0,
              kFires[m % 6]};
    for (int k = 0; k < timesteps; ++k) Step(walk, m, s, log);
  }
  return log;
}

}  // namespace ed3r::rfnn
