// Correction of p-values for asking many questions of one run.
#pragma once

#include <span>
#include <vector>

namespace ed3r::statistics {

// Holm's step-down adjustment (Scand. J. Statist. 6, 1979): rejecting where the adjusted value is below alpha
// keeps the chance of even one false rejection below alpha, whatever the dependence between the questions.
// Adjusted values in the order given, each >= its p, at most 1. p in [0, 1] (ED3R_CHECK).
std::vector<double> HolmAdjust(std::span<const double> p);

}  // namespace ed3r::statistics
