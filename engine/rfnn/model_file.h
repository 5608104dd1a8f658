// Networks on disk: one sealed file with design, shape, scaling, weights, provenance, loss curve and scores.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "engine/rfnn/model.h"

namespace ed3r::rfnn {

// Atomic: see sealed_file.h. Throws UserError where the disk refuses.
void WriteModel(const std::string& path, const Model& model);

// The network in `path`, which must be of this design: same name, features, states and hidden layers; and, where a
// `key` is given, made by the training of this key: a valid file in another's place is refused.
// Throws UserError, one line that starts with the path, for a file that is missing, damaged, of another
// version, of another design or training, or with weights or scales that cannot be used.
Model ReadModel(const std::string& path, const NetworkDesign& design,
                const std::optional<std::string>& key = std::nullopt);

// The same without a file: what WriteModel would write, and back; `name` stands in messages.
std::string ModelBytes(const Model& model);
Model OpenModel(std::string_view bytes, const std::string& name, const NetworkDesign& design);

// SHA-256 in hexadecimal of what decides every answer of a network: design, scaling and weights. Loss curve, key and
// provenance do not count.
std::string NetworkHash(const Model& model);

}  // namespace ed3r::rfnn
