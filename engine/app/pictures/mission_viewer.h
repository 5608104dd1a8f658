// The data of the mission viewer (`ed3r replay --html`), as its page in studies/report/web/src/viewer reads them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/app/stored_run.h"

namespace ed3r::app {

// A stored mission flown again, with its path, every timestep as stored, and what both agents thought in it:
//   name, label, outcome, site, base_station, scenario, seed, eta_min, battery_j, camera {hfov_deg, frames, aspect}, start
//   identical     whether the flight was the stored one
//   track         {t_s, x_m, y_m, z_m, yaw_rad}: since the mission's begin, while the robot moves
//   steps         columns of TimestepRecord, and begin_s, duration_s
//   lidar         {range_m, safety_m, met: as in viewer_rays.h, at: index into track}
//   frames, distractors  as in viewer_frames.h and viewer_distractors.h
//   decisions     one per timestep: {rule, why, drawn, admitted, candidates: [[dx_m, dy_m, dz_m, predicted reward]...], the best
//                 first and some of the others, robot_rewards: [offload, full, quantized], execution_text}
// Agents are asked by flying again, some times. Throws UserError as StoredRun::Find.
nlohmann::ordered_json ViewerMission(StoredRun& run, const std::string& mission);

// {name, size_m, cell_m, height_m, trees: [[x_m, y_m, ground_m, height_m, crown_radius_m]...], sites, base_stations, fire}.
nlohmann::ordered_json ViewerWorld(const world::Scene& scene);

}  // namespace ed3r::app
