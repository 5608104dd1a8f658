// Region Avoidance Mechanism at the RC (paper section "Region Avoidance Mechanism"; R23).
//
// The area is cut into cubes of edge crs. Per mission the RC counts, per timestep, where the robot was and
// the mean SCS seen there. More than as_thr visits of a cube whose mean is 0 is a local region stuck; while
// it lasts, only candidates that end in the best promising cube count, else those that end in an unexplored
// one, else the one that gets nearest to such a cube.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/agents/decisions.h"
#include "engine/config/agents.h"

namespace ed3r::agents {

class RegionMemory {
 public:
  RegionMemory(const AgentsConfig& agents, const Eigen::Vector3d& size_m);

  void Visit(const Eigen::Vector3d& position_m, double scs);

  bool Stuck(const Eigen::Vector3d& position_m) const;

  // Candidates that count while stuck, by index, in ascending order, and the rule that chose them. Empty,
  // with kGreedy, when no cube is promising or unexplored: then all count. ends_m: where each candidate would
  // end.
  struct Selection {
    MotionRule rule = MotionRule::kGreedy;
    std::vector<int> candidates;
  };
  Selection Select(std::span<const Eigen::Vector3d> ends_m) const;

 private:
  struct Region {
    int visits = 0;
    double scs_sum = 0.0;
    double MeanScs() const { return visits > 0 ? scs_sum / visits : 0.0; }
  };
  std::size_t IndexOf(const Eigen::Vector3d& position_m) const;
  double DistanceToRegionM(std::size_t region, const Eigen::Vector3d& position_m) const;
  Selection Nearest(std::span<const Eigen::Vector3d> ends_m) const;

  double edge_m_;
  int visits_threshold_;
  Eigen::Vector3i counts_;
  std::vector<Region> regions_;
};

}  // namespace ed3r::agents
