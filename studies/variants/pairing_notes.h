// What a comparison of two runs leaves out, in sentences.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/metrics/metrics.h"

namespace ed3r::variants {

struct LabelledRun {
  std::string label;
  std::span<const metrics::ArmData> arms;
};

// Arms that only one of the runs has, and arms of which not all scenario numbers are in common, or none are; where both draw
// the same scenarios (one seed), also arms whose scenarios are others under the same numbers. Empty where nothing is left out.
std::vector<std::string> PairingNotes(const LabelledRun& first, const LabelledRun& other, bool same_draws);

// Which variants did not meet the scenarios of the first one (ARM@VARIANT): they begin elsewhere, or in another world.
std::vector<std::string> VariantPairingNotes(std::span<const metrics::ArmData> arms);

// "a, b: NOTHING IN COMMON", "c: ANOTHER WORLD", of arms or variants that `than` is compared with; none where both are empty.
std::vector<std::string> PlaceNotes(const std::vector<std::string>& elsewhere,
                                    const std::vector<std::string>& other_worlds, const std::string& than);

}  // namespace ed3r::variants
