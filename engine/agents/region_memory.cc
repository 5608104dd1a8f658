#include "engine/agents/region_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ed3r::agents {

RegionMemory::RegionMemory(const AgentsConfig& agents, const Eigen::Vector3d& size_m)
    : edge_m_(agents.region_size_m), visits_threshold_(agents.region_visits) {
  for (int axis = 0; axis < 3; ++axis)
    counts_[axis] = std::max(1, static_cast<int>(std::ceil(size_m[axis] / edge_m_)));
  regions_.resize(static_cast<std::size_t>(counts_.prod()));
}

std::size_t RegionMemory::IndexOf(const Eigen::Vector3d& position_m) const {
  Eigen::Vector3i cell;
  for (int axis = 0; axis < 3; ++axis)
    cell[axis] = std::clamp(static_cast<int>(std::floor(position_m[axis] / edge_m_)), 0, counts_[axis] - 1);
  const int index = (cell.z() * counts_.y() + cell.y()) * counts_.x() + cell.x();
  return static_cast<std::size_t>(index);
}

void RegionMemory::Visit(const Eigen::Vector3d& position_m, double scs) {
  Region& region = regions_[IndexOf(position_m)];
  ++region.visits;
  region.scs_sum += scs;
}

bool RegionMemory::Stuck(const Eigen::Vector3d& position_m) const {
  const Region& region = regions_[IndexOf(position_m)];
  return region.visits > visits_threshold_ && region.scs_sum == 0.0;
}

RegionMemory::Selection RegionMemory::Select(std::span<const Eigen::Vector3d> ends_m) const {
  Selection promising{.rule = MotionRule::kRegionPromising, .candidates = {}};
  Selection unexplored{.rule = MotionRule::kRegionUnexplored, .candidates = {}};
  double best_mean = 0.0;
  for (std::size_t i = 0; i < ends_m.size(); ++i) {
    const Region& region = regions_[IndexOf(ends_m[i])];
    const double mean = region.MeanScs();
    if (mean > best_mean) {
      best_mean = mean;
      promising.candidates.clear();
    }
    if (mean > 0.0 && mean == best_mean) promising.candidates.push_back(static_cast<int>(i));
    if (region.visits == 0) unexplored.candidates.push_back(static_cast<int>(i));
  }
  if (!promising.candidates.empty()) return promising;
  if (!unexplored.candidates.empty()) return unexplored;
  return Nearest(ends_m);
}

RegionMemory::Selection RegionMemory::Nearest(std::span<const Eigen::Vector3d> ends_m) const {
  // The paper sends the robot towards the unexplored when nothing promising is within reach.
  const bool any_unexplored =
      std::any_of(regions_.begin(), regions_.end(), [](const Region& region) { return region.visits == 0; });
  double best_m = std::numeric_limits<double>::infinity();
  int best = -1;
  for (std::size_t region = 0; region < regions_.size(); ++region) {
    const bool wanted = any_unexplored ? regions_[region].visits == 0 : regions_[region].scs_sum > 0.0;
    if (!wanted) continue;
    for (std::size_t i = 0; i < ends_m.size(); ++i) {
      const double distance_m = DistanceToRegionM(region, ends_m[i]);
      if (distance_m < best_m || (distance_m == best_m && static_cast<int>(i) < best)) {
        best_m = distance_m;
        best = static_cast<int>(i);
      }
    }
  }
  if (best < 0) return {};
  return {.rule = MotionRule::kRegionNearest, .candidates = {best}};
}

double RegionMemory::DistanceToRegionM(std::size_t region, const Eigen::Vector3d& position_m) const {
  const int index = static_cast<int>(region);
  const Eigen::Vector3i cell(index % counts_.x(), index / counts_.x() % counts_.y(),
                             index / (counts_.x() * counts_.y()));
  const Eigen::Vector3d low_m = cell.cast<double>() * edge_m_;
  const Eigen::Vector3d inside_m =
      position_m.cwiseMax(low_m).cwiseMin(low_m + Eigen::Vector3d::Constant(edge_m_));
  return (position_m - inside_m).norm();
}

}  // namespace ed3r::agents
