// Robust estimation of one model's parameters from flight rows (Ceres).
//
// M-estimation in two stages. Huber's loss, convex and safe from far starts, gives the solution's
// neighbourhood and the noise scale s = 1.4826 median |residual|. Tukey's biweight from there gives the
// estimate: drop-outs and spikes beyond 4.685 s get no weight at all, so one-sided drop-outs do not bias it.
// Where more than a tenth of the rows lie beyond, it is the model that fails and not the sensor: Huber's
// solution is kept, so that no model looks better than it is by disowning the data that it cannot explain.
#pragma once

#include <ceres/cost_function.h>

#include <memory>
#include <optional>
#include <vector>

#include "studies/fit/energy_model.h"

namespace ed3r::fit {

enum class Loss { kHuber, kTukey };

inline constexpr double kHuberLimit = 1.345;  // both: 95 % efficiency for normal noise
inline constexpr double kTukeyLimit = 4.685;
inline constexpr double kMaxOutlierShare = 0.1;

struct Estimate {
  std::vector<double> values;
  std::vector<bool> at_lower, at_upper;  // at a bound: the data ask for more than the model may give
  Loss loss = Loss::kTukey;
  double scale_w = 0.0;  // robust standard deviation of the residuals
  int rows = 0;
  int beyond_low = 0, beyond_high = 0;  // rows more than 4.685 s below / above the prediction
  int starts = 0, starts_agreeing = 0;  // starts whose cost is within 0.1 % of the best
  int iterations = 0;                   // of all solves together
};

using Rows = std::vector<const FlightRow*>;

// From several starts (the model's own and points spread over its bounds); or, in the folds of a
// cross-validation, from the solution `near` alone: its loss and noise scale are kept, its values only start.
// Deterministic, one thread. Needs more rows than parameters. Throws InternalError when Ceres fails.
Estimate EstimateParameters(const EnergyModel& model, const Rows& rows,
                            const std::optional<Estimate>& near = {});

// Without a loss and without bounds: residual i is (predicted - measured) / scale_w of row i. For
// ceres::Covariance.
std::unique_ptr<ceres::CostFunction> RowResiduals(const EnergyModel& model, Rows rows, double scale_w);

// psi(u) and psi'(u) of the loss at the scaled residual u: weights of the score in the covariance.
double ScoreOf(Loss loss, double u);
double ScoreSlopeOf(Loss loss, double u);

}  // namespace ed3r::fit
