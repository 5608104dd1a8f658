// Networks on disk: one sealed file with design, shape, scaling, weights, provenance, loss curve and scores.
#pragma once

#include <string>

#include "engine/rfnn/model.h"

namespace ed3r {

// Atomic: see sealed_file.h. Throws UserError where the disk refuses.
void WriteModel(const std::string& path, const Model& model);

// The network in `path`, which must be of this design: same name, features, states and hidden layers.
// Throws UserError, one line that starts with the path, for a file that is missing, damaged, of another
// version, of another design, or with weights or scales that cannot be used.
Model ReadModel(const std::string& path, const NetworkDesign& design);

}  // namespace ed3r
