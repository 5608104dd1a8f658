// What the camera could see of fire, smoke and distractors from one pose: geometry only, the same for every model.
//
// Flame and smoke are sets of sample points, each standing for an equal part of the body's silhouette. A point counts
// when it lies inside the frame and nothing solid stands between it and the camera; its share of the image follows
// from the pinhole equation, its weight from the haze on the way.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/config/config.h"
#include "engine/robot/motion.h"
#include "engine/world/scene.h"

namespace ed3r::perception {

// A harmless thing that a detector can take for fire (R34): a disc on the ground.
struct Distractor {
  Eigen::Vector3d position_m;
  double radius_m;
};

// Drawn per mission, the same for all arms that fly the scenario.
std::vector<Distractor> DrawDistractors(const world::Scene& scene, const PerceptionConfig& perception,
                                        std::uint64_t seed, std::uint32_t scenario);

struct View {
  double fire_share = 0.0;        // visible flame as a share of the image, after haze
  double smoke_share = 0.0;       // visible smoke likewise
  double distractor_share = 0.0;  // of the distractor that misleads most, weighted by how steeply it is seen
  double visible_fraction = 0.0;  // of all flame and smoke samples
  bool fire_in_view = false;      // some flame or smoke in frame and in line of sight: the ground truth (R16)
};

// Pinhole camera: x right, y down, z forward; image coordinates are x/z and y/z.
class Camera {
 public:
  Camera(const robot::Pose& pose, const SensingConfig& sensing);

  // Share of the image that a patch of the given area covers, turned fully towards the camera; 0 outside the frame.
  double ShareOf(const Eigen::Vector3d& point_m, double area_m2) const;
  const Eigen::Vector3d& PositionM() const { return position_m_; }
  const Eigen::Vector3d& Right() const { return right_; }
  const Eigen::Vector3d& Down() const { return down_; }
  const Eigen::Vector3d& Forward() const { return forward_; }
  double HalfWidth() const { return half_width_; }
  double HalfHeight() const { return half_height_; }

 private:
  Eigen::Vector3d position_m_, right_, down_, forward_;
  double half_width_, half_height_;  // of the image plane at unit distance
};

// The fire at one site, as seen by any number of cameras. Threads: const members may be called from any thread.
class FireView {
 public:
  FireView(const world::Scene& scene, int site);

  View Look(const robot::Pose& pose, const SensingConfig& sensing, const PerceptionConfig& perception,
            const std::vector<Distractor>& distractors) const;

 private:
  struct Sample {
    Eigen::Vector3d position_m;
    double side_m2;  // silhouette seen from the side
    double top_m2;   // silhouette seen from above
  };
  double VisibleShare(const Camera& camera, const std::vector<Sample>& samples, double haze_range_m,
                      int& visible) const;

  const world::Scene& scene_;
  std::vector<Sample> flame_, smoke_;
};

}  // namespace ed3r::perception
