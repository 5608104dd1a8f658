// Parts of the figures' data that come from the missions of one arm; layout in figure_data.h.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "studies/claims/convergence.h"
#include "studies/metrics/arm.h"

namespace ed3r::figures {

nlohmann::ordered_json ColumnUnits();
nlohmann::ordered_json MissionColumns(const metrics::ArmData& arm);

// One entry per site that was flown, by number; known ones as the missions say.
nlohmann::ordered_json SiteSuccess(const metrics::ArmData& arm);

// The missions of all known (or all unseen) sites as one, equal to the report's generalisation; null without any.
nlohmann::ordered_json PooledSuccess(const metrics::ArmData& arm, bool known);

// The points of this arm.
nlohmann::ordered_json ConvergenceJson(const metrics::ArmData& arm,
                                       std::span<const claims::ConvergencePoint> points);

// `value` with this many decimals; null for NaN.
nlohmann::ordered_json Rounded(double value, int decimals = 4);

}  // namespace ed3r::figures
