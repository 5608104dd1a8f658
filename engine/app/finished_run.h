// The same command on a run that is complete.
#pragma once

#include <cstdint>
#include <string>

#include "engine/store/finished.h"
#include "engine/sweep/plan.h"

namespace ed3r::app {

// Where `dir` holds all of this plan, flown by this code with the same files, and has not been touched since this very
// program found it complete: prints what the command printed then, and returns true. A run that is quickly compared with its
// checksums is, of another a note tells that it was not. Otherwise, also where anything about the directory is wrong, false:
// the run itself tells. `cache`: where its networks were found, which the print names.
bool TellFinishedRun(const sweep::SweepPlan& plan, const std::string& dir, const std::string& cache,
                     bool quiet);

// After a run that was complete: `table` and `networks` as they were printed, "" where the command was quiet; `told`: the
// state of the file from before the table was made.
void RememberFinishedRun(const sweep::SweepPlan& plan, const std::string& dir, const std::string& cache,
                         const store::FileMoment& told, std::int64_t missions, const std::string& table,
                         const std::string& networks);

}  // namespace ed3r::app
