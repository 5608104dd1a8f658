// What a flying stage of a run still needs, as batch scripts ask it.
#pragma once

#include <string>

namespace ed3r::app {

// Prints one line. kDone when all that the stage needs is stored in `dir` or in shards beside it; kMissionsFailed when missions failed or are
// missing; kRequeue when a stage with a precision is due another round. UserError for a stage that the run does not have.
int TellStage(const std::string& dir, const std::string& stage);

}  // namespace ed3r::app
