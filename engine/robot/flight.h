// Flying motion commands in a mission's own Bullet world (paper: Eq. 2, Obstacle Avoidance Mechanism;
// readings R4, R14, R24, R35).
//
// A command is flown as a straight horizontal leg and a straight vertical leg (energy.move_order), each from
// rest to rest; the turn is flown together with them. A leg ends when the robot is within 5 cm of its end and
// slower than 0.1 m/s (both wider in gusts), or at the latest kSettleLimitS after its reference has come to
// rest: in gusts that the control cannot hold, the leg ends there, where the robot is.
//
// Safety rule (R24): while a leg is flown, the robot brakes when the free distance ahead of its hull is less
// than robot.safety_distance_m plus its braking distance, and comes to rest there; the rest of that leg is
// dropped, the other leg is still tried. A leg whose first 10 cm are not free is not begun. Targets are
// clamped to the scene's box, kBoxMarginM inside its faces.
//
// Between commands the robot hovers at the pose that it achieved, in balance with the wind, and is not
// stepped. Threads: one Flight per mission and thread; the Scene is shared. Determinism: the result of
// Execute depends on the pose, the command, (seed, scenario, timestep) and the parameters.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/config/config.h"
#include "engine/robot/motion.h"
#include "engine/world/scene.h"

namespace ed3r::robot {

inline constexpr double kSettleLimitS = 3.0;
inline constexpr double kBoxMarginM = 0.5;

// One sample of a flown path, for replays.
struct TraceSample {
  std::uint32_t timestep = 0;
  double time_s = 0.0;  // since the command began
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
};

class TraceSink {
 public:
  virtual ~TraceSink() = default;
  virtual void Record(const TraceSample& sample) = 0;  // kTraceHz times a second of flight, and at its end
};

inline constexpr double kTraceHz = 24.0;

class Flight {
 public:
  // Throws UserError when the airframe cannot fly (CheckFlyable).
  // The scene must outlive the flight; the configuration is copied.
  Flight(const world::Scene& scene, const Config& config, const Pose& start, std::uint64_t seed,
         std::uint32_t scenario);
  ~Flight();
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  FlownMove Execute(const MotionCommand& command, std::uint32_t timestep);

  const Pose& CurrentPose() const;

  // Follows the coming moves; nullptr ends it. The sink must outlive its use.
  void SetTrace(TraceSink* sink);

  // Work done so far, for measurements.
  std::int64_t PhysicsSteps() const;
  std::int64_t LidarScans() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ed3r::robot
