// The result table as data.
//
// JSON: {"arms": {NAME: {"stage", "missions", "failed", "missing", METRIC: {"mean", "lo", "hi", "n",
// "paper"},
// ...}}}. "mean" is the value of the metric whatever it is (a rate, a maximum); null is "none". "paper" is
// the number that the tables show, null where there is none. An arm's NAME is its own where no other stage
// has one of that name, else "STAGE/NAME". CSV: one line per stage, arm and metric, in the order of the
// tables; numbers in full precision, none empty.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "studies/metrics/metrics.h"
#include "studies/paper/claims.h"
#include "studies/tables/result_table.h"

namespace ed3r::tables {

// Keys of `arms`, in their order: see above.
std::vector<std::string> UniqueArmNames(std::span<const metrics::ArmMetrics> arms);

nlohmann::ordered_json ResultJson(std::span<const metrics::ArmMetrics> arms,
                                  const std::vector<paper::Claim>& claims);

// Columns stage,arm,metric,value,lo,hi,n,paper; the metrics of each arm follow its counts "missions",
// "failed" and "missing".
std::string ResultCsv(std::span<const metrics::ArmMetrics> arms, const std::vector<paper::Claim>& claims);

// Columns stage,arm,place,metric,value,lo,hi,n; place is known-site, unseen-site, known-base-station or
// unseen-base-station.
std::string GeneralisationCsv(std::span<const Generalisation> arms);

// {NAME: {PLACE: {"missions", METRIC: {"mean", "lo", "hi", "n"}, ...}}}, names as in ResultJson.
nlohmann::ordered_json GeneralisationJson(std::span<const Generalisation> arms);

}  // namespace ed3r::tables
