// 95 % intervals and correlations of an estimate.
//
// Two answers, because the residuals of real flights are not independent: gusts last for seconds, and a
// flight's battery and wind shift all of its rows.
//   rows      as if every row were independent: (J'J)^-1 of ceres::Covariance times Huber's factor
//             s^2 n/(n-p) mean(psi^2) / mean(psi')^2. Right for synthetic noise, far too narrow for real
//             logs.
//   flights   sandwich A^-1 M A^-1, M summing the outer products of each flight's whole score: right for any
//             correlation within a flight, as long as flights are independent of each other. The headline.
//             Small-sample factor G/(G-1) (n-1)/(n-p) and Student's t with G-1 degrees of freedom, G the
//             number of flights.
// A parameter at a bound is held there and has no interval. Where the data do not determine the free
// parameters (singular J'J), none has.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "studies/fit/estimate.h"

namespace ed3r::fit {

struct Interval {
  double standard_error, low, high;  // NaN where there is none
};

struct Uncertainty {
  std::vector<Interval> flights, rows;  // one per parameter
  Eigen::MatrixXd correlation;  // between the estimates, from ceres::Covariance; 0 for held parameters
  int groups = 0;
  bool determined = false;
};

Uncertainty EstimateUncertainty(const EnergyModel& model, const std::vector<Flight>& flights,
                                const Estimate& estimate);

// Two-sided 95 % quantile of Student's t (relative error below 1e-3 from 3 degrees of freedom on).
double StudentT95(int degrees_of_freedom);

}  // namespace ed3r::fit
