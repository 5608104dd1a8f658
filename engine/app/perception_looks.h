// What the fast tier's geometry sees from every pose at which a stored run of the pixel tier looked.
#pragma once

#include <string>
#include <vector>

#include "studies/perception/profile_fit.h"

namespace ed3r::app {

struct PerceptionLooks {
  std::vector<perception_fit::PeriodLook> looks;
  PerceptionConfig configured;  // of the arms that looked at pixels
};

// Throws UserError where the run cannot be read again, none of its arms looked at pixels, or several that did were given other
// parameters of perception or camera.
PerceptionLooks LooksOfRun(const std::string& dir);

}  // namespace ed3r::app
