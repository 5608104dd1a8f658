// The results of a run directory, as the report needs them.
#pragma once

#include <string>

#include "studies/report/provenance.h"
#include "studies/report/report.h"

namespace ed3r::report {

// Every arm of the flying stages of the store, in plan order, with its missions (without timesteps)
// and how many failed or are missing; training stages are left out. The run may still be going on: all is of one moment.
// Throws UserError where the store is damaged.
RunResults LoadRun(store::ResultReader& reader);

// The same with what made it and the digest of just these missions, for what is kept: everything is compared with its
// checksums on the way, and UserError names the first damaged mission. `called`: how the run is named in it, which is read from
// elsewhere where its shards were joined.
struct WholeRun {
  RunResults results;
  Provenance provenance;
};
WholeRun LoadWhole(store::ResultReader& reader, const std::string& called);

// Half of the width of a metric's 95 % interval over the first `missions` missions of an arm; NaN where they give none
// or are not all stored. For stages with a precision (engine/sweep/plan.h).
double HalfWidth(const std::string& dir, int stage, const std::string& arm, int missions,
                 const std::string& metric);

}  // namespace ed3r::report
