// What the interactive page shows of missions when a reader filters: every number comes from the code that fills the
// tables, computed here once for each filter, so that the page itself does no statistics and its size does not grow with
// the number of missions.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "studies/metrics/arm.h"
#include "studies/metrics/metrics.h"

namespace ed3r::report {

// {"SITE|OUTCOME": [per arm: [missions, value, lo, hi, value, lo, hi, ...] in the order of MetricDefinitions(), or null
// where the arm has no such mission]}, null is "none". SITE is "all", "known", "unseen" or the site's number; OUTCOME is
// "all" or the record's number of it. "all|all" is `metrics` itself in full precision, the others are rounded to 4
// decimals. Look-forward accuracy is relative to the worst mission of the whole arm, so that only "all|all" has it.
// Where there are more than kMostSites sites, single sites come without outcomes.
nlohmann::ordered_json SlicesJson(std::span<const metrics::ArmData> arms,
                                  std::span<const metrics::ArmMetrics> metrics);

inline constexpr std::size_t kMostSites = 40;

// {"scales": [{"column", "label", "unit", "from", "step", "bins"}], "cells": [[arm, site, outcome, scale, first bin,
// counts...]...]}: exact counts of missions; a mission without the value (no reliable look, hence no confidence) is in no
// bin. The last bin holds its upper end.
nlohmann::ordered_json HistogramsJson(std::span<const metrics::ArmData> arms);

// One list per arm of columns of equal length: {"number", "site", "outcome", "network", "energy_kj", "duration_min",
// "scs_pct", "every"}: the missions whose number is a multiple of `every`, at most kMostPoints. `numbers` are theirs
// within their arms.
nlohmann::ordered_json PointsJson(std::span<const metrics::ArmData> arms,
                                  std::span<const std::vector<int>> numbers);

inline constexpr int kMostPoints = 1500;

// [{"arm", "cause", "outcome", "count", "known", "sites": {site: count}, "missions": [[number, site, energy_kj,
// duration_min, timesteps, reliable_timesteps]...]}]: missions that did not succeed, by arm and by what went wrong, all of
// them counted, at each site and at those known to the warm-up. Listed are the first kMostFailuresListed, and of each site,
// where there are at most kMostSites, the first kFailuresListedPerSite.
nlohmann::ordered_json FailuresJson(std::span<const metrics::ArmData> arms,
                                    std::span<const std::vector<int>> numbers);

inline constexpr std::size_t kMostFailuresListed = 60, kFailuresListedPerSite = 5;

}  // namespace ed3r::report
