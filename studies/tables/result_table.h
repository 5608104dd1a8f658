// The result tables for a terminal. UTF-8, no colour, no tabs; every line ends without spaces.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/metrics/metrics.h"
#include "studies/paper/claims.h"
#include "studies/tables/layout.h"

namespace ed3r::tables {

// Metrics down, arms across, the paper's value beside ours. Stage by stage (neighbours of one stage belong
// together); the arms of a stage in as many blocks as `width` asks for, at least one arm in each. Ends with
// the notes that explain intervals and marks. Empty without arms.
std::string ResultTable(std::span<const metrics::ArmMetrics> arms, const std::vector<paper::Claim>& claims,
                        int width = kTerminalWidth);

// The main metrics of an arm's missions at places that the warm-up had or had not seen.
struct Generalisation {
  metrics::ArmMetrics known_sites, unseen_sites, known_stations, unseen_stations;
};
Generalisation ComputeGeneralisation(const metrics::ArmData& arm);

// Four rows per arm, a few metrics across; arms without missions at unseen places are left out, as there is
// nothing to compare. Empty where that leaves nothing.
std::string GeneralisationTable(std::span<const Generalisation> arms);

}  // namespace ed3r::tables
