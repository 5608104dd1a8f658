// How well a fitted profile says what the networks said: the figures of a ProfileFit.
#pragma once

#include <span>

#include "studies/perception/profile_fit.h"

namespace ed3r::perception_fit {

// Fills everything in `fit` but the parameters, from those; `configured`: the profile that was in force.
void JudgeFit(std::span<const PeriodLook> looks, const PerceptionConfig& configured, ProfileFit& fit);

}  // namespace ed3r::perception_fit
