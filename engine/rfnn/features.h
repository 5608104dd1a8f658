// What the two networks see, in which order, and how large they are (paper: Table RFNNs; R17).
//
// A row of inputs is the state followed by the action. Angles are plain yaw and tilt in radians, yaw wrapped
// to [-pi, pi]: the paper counts 13 and 11 features, which leaves no room for a sine and a cosine. Values are
// raw, in the units of their names; the model standardises them (scaling.h).
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace ed3r::rfnn {

// Columns of the RC's rows (S_RC,k | A_RC,k). "Previous" values are 0 at k = 1.
enum RcFeature {
  kRcX,
  kRcY,
  kRcZ,
  kRcYaw,
  kRcTilt,
  kRcDistance,        // robot to RC
  kRcPreviousScs,     // eta_{k-1}
  kRcPreviousEnergy,  // E_total(k-1)
  kRcMoveX,
  kRcMoveY,
  kRcMoveZ,
  kRcTurn,
  kRcTiltCommand,  // the absolute set-point (R14)
  kRcInputs
};
inline constexpr int kRcStates = kRcMoveX;
inline constexpr std::array<std::string_view, kRcInputs> kRcFeatures = {"x_m",
                                                                        "y_m",
                                                                        "z_m",
                                                                        "yaw_rad",
                                                                        "tilt_rad",
                                                                        "rc_distance_m",
                                                                        "previous_scs",
                                                                        "previous_energy_j",
                                                                        "dx_m",
                                                                        "dy_m",
                                                                        "dz_m",
                                                                        "turn_rad",
                                                                        "tilt_command_rad"};

// Columns of the robot's rows (S_k | A_k).
enum RobotFeature {
  kRobotYaw,
  kRobotTilt,
  kRobotBattery,  // beta_k / beta_max
  kRobotCpu,      // f_k / f_max
  kRobotDistance,
  kRobotBandwidth,
  kRobotRate,
  kRobotPreviousScs,
  kRobotPreviousEnergy,
  kRobotOffload,    // o_k: 1 offloads
  kRobotQuantized,  // l_k: 1 Quantized, 0 Full; 0 with o_k = 1, where the RC runs Full
  kRobotInputs
};
inline constexpr int kRobotStates = kRobotOffload;
inline constexpr std::array<std::string_view, kRobotInputs> kRobotFeatures = {
    "yaw_rad",  "tilt_rad",     "battery_ratio",     "cpu_ratio", "rc_distance_m", "bandwidth_hz",
    "rate_bps", "previous_scs", "previous_energy_j", "offload",   "quantized"};

// The robot's three actions as its network sees them, {o, l}: offload, Full on board, Quantized on board.
inline constexpr std::array<std::array<float, 2>, 3> kRobotActions = {{{1, 0}, {0, 0}, {0, 1}}};

// One kind of network. Its spans point to constants.
struct NetworkDesign {
  std::string_view name;
  std::span<const std::string_view> features;
  int states = 0;               // leading features that are state; the rest is action
  std::span<const int> hidden;  // neurons of the hidden layers
  int decision = 0;             // values of a network that decides by itself (direct_network.h)

  int inputs() const { return static_cast<int>(features.size()); }
  int actions() const { return inputs() - states; }
};

inline constexpr std::array kRcHidden = {128, 64, 64, 32};
inline constexpr std::array kRobotHidden = {128, 64, 32};
inline constexpr NetworkDesign kRcNetwork = {"rc", kRcFeatures, kRcStates, kRcHidden, kRcInputs - kRcStates};
inline constexpr NetworkDesign kRobotNetwork = {"robot", kRobotFeatures, kRobotStates, kRobotHidden,
                                                kRobotActions.size()};

}  // namespace ed3r::rfnn
