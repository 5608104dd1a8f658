// Claims about how the study was made: how many missions, places and features it rests on.
#pragma once

#include <span>

#include "studies/claims/verdicts.h"

namespace ed3r::claims {

// Of one claim of kind "setup", by its metric: missions_online, missions_warmup, samples (timesteps of the
// warm-up), sites_used, input_features. ED3R_CHECK that it is one of those.
Judgement JudgeSetup(const paper::Claim& claim, std::span<const metrics::ArmData> arms);

}  // namespace ed3r::claims
