// The body of a fire as points: what a camera looks for, and what can be hidden.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/world/scene.h"

namespace ed3r::world {

// Points of the flame, a cone whose silhouette narrows towards the tip; each stands for an equal part of it.
std::vector<Eigen::Vector3d> FlamePoints(const FireShape& fire, const Eigen::Vector3d& base_m, int count);

// Points of the smoke, from the flame's tip to the top, widening and leaning.
std::vector<Eigen::Vector3d> SmokePoints(const FireShape& fire, const Eigen::Vector3d& base_m, int count);

// Radius of the smoke where it leaves the flame.
inline double SmokeBottomRadiusM(const FireShape& fire) { return 0.5 * fire.flame_radius_m; }

}  // namespace ed3r::world
