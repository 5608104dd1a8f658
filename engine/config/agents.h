// Decisions of the two agents and the mechanisms (paper: Table ED3R configuration; the Algorithm; R17-R25).
#pragma once

#include <string>

#include "engine/config/field.h"

namespace ed3r {

// Epsilon where the Algorithm resets to normal operation (line 14).
enum class ElseBranch { kDecayed, kZero };
template <>
struct EnumNames<ElseBranch> {
  static constexpr EnumName<ElseBranch> kNames[] = {{ElseBranch::kDecayed, "decayed"},
                                                    {ElseBranch::kZero, "zero"}};
};

// How the fixed values fv act on the ranges: divide by 3, 10, 10, or shrink by 3, 10, 10 percent.
enum class RangeRule { kDivide, kPercent };
template <>
struct EnumNames<RangeRule> {
  static constexpr EnumName<RangeRule> kNames[] = {{RangeRule::kDivide, "divide"},
                                                   {RangeRule::kPercent, "percent"}};
};

// Camera tilt command: an absolute set-point, or a change of the present tilt.
enum class TiltCommand { kAbsolute, kRelative };
template <>
struct EnumNames<TiltCommand> {
  static constexpr EnumName<TiltCommand> kNames[] = {{TiltCommand::kAbsolute, "absolute"},
                                                     {TiltCommand::kRelative, "relative"}};
};

// Random choices of where to detect: offload, Full and Quantized alike, or a coin between offloading and on board first.
enum class RandomExecution { kEqual, kCoin };
template <>
struct EnumNames<RandomExecution> {
  static constexpr EnumName<RandomExecution> kNames[] = {{RandomExecution::kEqual, "equal"},
                                                         {RandomExecution::kCoin, "coin"}};
};

struct AgentsConfig {
  double eta_min = 0.75;
  double eta_int = 0.20;
  int completion_patience = 2;
  int low_confidence_patience = 2;
  double axis_range_m = 20.0;
  double yaw_range_deg = 90.0;
  double tilt_range_deg = 90.0;
  TiltCommand tilt_command = TiltCommand::kAbsolute;
  RangeRule range_rule = RangeRule::kDivide;
  double decrease_axes = 3.0;
  double decrease_yaw = 10.0;
  double decrease_tilt = 10.0;
  int candidates = 1000;
  double lambda1 = 1.0;
  double lambda2 = 1.0;
  double mu1 = 1.0;
  double mu2 = 2.0;
  double energy_scale_j = 10000.0;
  double epsilon_min = 0.01;
  double epsilon_decay = 0.95;
  int epsilon_missions = 850;
  ElseBranch else_branch = ElseBranch::kDecayed;
  RandomExecution random_execution = RandomExecution::kCoin;
  double region_size_m = 60.0;
  int region_visits = 20;
  bool early_completion = true;
  bool region_avoidance = true;
  bool obstacle_avoidance = true;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    constexpr std::string_view kTable = "Table ED3R configuration";
    visit("eta_min", self.eta_min,
          {.min = 0.05, .max = 1, .source = "Eq. 12; Result 1", .meaning = "required detection confidence"});
    visit("eta_int", self.eta_int,
          {.min = 0, .max = 1, .source = kTable, .meaning = "intermediate confidence threshold"});
    visit("completion_patience", self.completion_patience,
          {.min = 1,
           .max = 50,
           .source = "Table ED3R configuration, R22",
           .meaning = "consecutive reliable timesteps that complete a mission, esp"});
    visit("low_confidence_patience", self.low_confidence_patience,
          {.min = 1,
           .max = 50,
           .source = "Table ED3R configuration, R21",
           .meaning = "consecutive intermediate timesteps before ranges grow again, c_thr"});
    visit("axis_range_m", self.axis_range_m,
          {.unit = "m",
           .min = 0.5,
           .max = 200,
           .source = kTable,
           .meaning = "largest move on each axis per timestep"});
    visit("yaw_range_deg", self.yaw_range_deg,
          {.unit = "deg",
           .min = 1,
           .max = 180,
           .source = "Table ED3R configuration, R14",
           .meaning = "largest turn per timestep"});
    visit("tilt_range_deg", self.tilt_range_deg,
          {.unit = "deg",
           .min = 1,
           .max = 90,
           .source = "Table ED3R configuration, R14",
           .meaning = "camera tilt lies in [0, this]; 0 level, 90 straight down"});
    visit("tilt_command", self.tilt_command,
          {.source = "R14, calibrated", .meaning = "tilt commands are set-points or changes"});
    visit("range_rule", self.range_rule,
          {.source = "R21", .meaning = "fixed values divide the ranges, or are percentages"});
    visit("decrease_axes", self.decrease_axes,
          {.min = 1, .max = 99, .source = "Table ED3R configuration, R21", .meaning = "fv of the axes"});
    visit("decrease_yaw", self.decrease_yaw,
          {.min = 1,
           .max = 99,
           .source = "Table ED3R configuration, R21",
           .meaning = "fv of the body rotation"});
    visit("decrease_tilt", self.decrease_tilt,
          {.min = 1, .max = 99, .source = "Table ED3R configuration, R21", .meaning = "fv of the camera"});
    visit("candidates", self.candidates,
          {.min = 1,
           .max = 100000,
           .source = "Table ED3R configuration, R19",
           .meaning = "candidate actions N of the RC"});
    visit("lambda1", self.lambda1,
          {.min = 0, .max = 100, .source = kTable, .meaning = "weight of the constraint penalty (Eq. 17)"});
    visit("lambda2", self.lambda2,
          {.min = 0, .max = 100, .source = kTable, .meaning = "weight of the detection penalty (Eq. 17)"});
    visit("mu1", self.mu1,
          {.min = 0, .max = 100, .source = kTable, .meaning = "weight of the energy (Eq. 18)"});
    visit("mu2", self.mu2,
          {.min = 0, .max = 100, .source = kTable, .meaning = "weight of the penalty (Eq. 18)"});
    visit("energy_scale_j", self.energy_scale_j,
          {.unit = "J",
           .min = 1,
           .max = 1e6,
           .source = "Eq. 21, R32",
           .meaning = "energy that counts as 1 in the reward: the largest a timestep takes"});
    visit("epsilon_min", self.epsilon_min,
          {.min = 0, .max = 1, .source = "Table ED3R configuration, R20", .meaning = "least exploration"});
    visit("epsilon_decay", self.epsilon_decay,
          {.min = 0,
           .max = 1,
           .source = "Table ED3R configuration, R20",
           .meaning = "decay of epsilon per mission"});
    visit("epsilon_missions", self.epsilon_missions,
          {.min = 0,
           .max = 1e6,
           .source = "R20, the paper's 850",
           .meaning = "length of the online phase over which epsilon decays; missions are drawn from it "
                      "evenly, so that few "
                      "explore as much as many. 0: they are its first ones"});
    visit("else_branch", self.else_branch,
          {.source = "R20", .meaning = "epsilon in normal operation: decayed, or the Algorithm's 0"});
    visit("random_execution", self.random_execution,
          {.source = "R36, calibrated",
           .meaning = "random choices of the robot: offload, Full, Quantized alike, or a coin between "
                      "offloading and on board first"});
    visit("region_size_m", self.region_size_m,
          {.unit = "m", .min = 5, .max = 500, .source = kTable, .meaning = "edge of a cubic region, crs"});
    visit("region_visits", self.region_visits,
          {.min = 1,
           .max = 10000,
           .source = "Table ED3R configuration, R23",
           .meaning = "more visits of an uninformative region mean stuck, as_thr"});
    visit("early_completion", self.early_completion,
          {.source = "the Algorithm",
           .meaning = "adaptive early mission completion, where the strategy has it"});
    visit("region_avoidance", self.region_avoidance,
          {.source = "Region Avoidance Mechanism", .meaning = "region avoidance, where the strategy has it"});
    visit("obstacle_avoidance", self.obstacle_avoidance,
          {.source = "Obstacle Avoidance Mechanism", .meaning = "the LiDAR safety rule"});
  }
};

// The rule-based heuristic strategy (paper: Appendix, Baselines; R25).
enum class RbsModel { kCoin, kFull, kQuantized };
template <>
struct EnumNames<RbsModel> {
  static constexpr EnumName<RbsModel> kNames[] = {
      {RbsModel::kCoin, "coin"}, {RbsModel::kFull, "full"}, {RbsModel::kQuantized, "quantized"}};
};

struct RbsConfig {
  double transmission_threshold = 0.85;
  double processing_threshold = 0.65;
  RbsModel model = RbsModel::kCoin;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    visit("transmission_threshold", self.transmission_threshold,
          {.min = 0,
           .max = 1,
           .source = "Appendix Baselines, R25",
           .meaning = "thr_1 on rate / (b_max se_max)"});
    visit("processing_threshold", self.processing_threshold,
          {.min = 0, .max = 1, .source = "Appendix Baselines, R25", .meaning = "thr_2 on f / f_max"});
    visit("model", self.model, {.source = "R25", .meaning = "model of a local execution"});
  }
};

// Networks of the user's own in place of those that a run trains.
struct NetworksConfig {
  std::string rc = "trained";
  std::string robot = "trained";

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    constexpr std::string_view kSource = "none in the paper";
    visit("rc", self.rc,
          {.source = kSource,
           .meaning = "network of the RC: trained, or an ONNX network's path from the sweep file",
           .is_file = true,
           .or_else = "trained"});
    visit("robot", self.robot,
          {.source = kSource,
           .meaning = "network of the robot: trained, or an ONNX network's path from the sweep file",
           .is_file = true,
           .or_else = "trained"});
  }
};

}  // namespace ed3r
