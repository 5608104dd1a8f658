#include "studies/fit/uncertainty.h"

#include <ceres/covariance.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "engine/core/check.h"

namespace ed3r::fit {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Ceres tells a singular matrix to the terminal as well as to us.
class QuietCeres {
 public:
  QuietCeres() : before_(FLAGS_minloglevel) { FLAGS_minloglevel = google::GLOG_FATAL; }
  ~QuietCeres() { FLAGS_minloglevel = before_; }
  QuietCeres(const QuietCeres&) = delete;
  QuietCeres& operator=(const QuietCeres&) = delete;

 private:
  int before_;
};

// (J'J)^-1 of the scaled residuals without loss, bound parameters held. Zero rows for those. False when
// singular.
bool InverseNormalMatrix(const EnergyModel& model, const std::vector<Flight>& flights,
                         const Estimate& estimate, const std::vector<int>& held, Eigen::MatrixXd& inverse) {
  std::vector<double> values = estimate.values;
  ceres::Problem problem;
  problem.AddParameterBlock(values.data(), model.size());
  if (!held.empty()) problem.SetManifold(values.data(), new ceres::SubsetManifold(model.size(), held));
  for (const Flight& flight : flights) {
    Rows rows;
    for (const FlightRow& row : flight.rows) rows.push_back(&row);
    problem.AddResidualBlock(RowResiduals(model, std::move(rows), estimate.scale_w).release(), nullptr,
                             values.data());
  }
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.num_threads = 1;
  const QuietCeres quiet;
  ceres::Covariance covariance(options);
  const std::vector<std::pair<const double*, const double*>> blocks = {{values.data(), values.data()}};
  if (!covariance.Compute(blocks, &problem)) return false;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> block(model.size(), model.size());
  if (!covariance.GetCovarianceBlock(values.data(), values.data(), block.data())) return false;
  inverse = block;
  return inverse.allFinite();
}

struct Scores {
  Eigen::MatrixXd bread;  // sum of psi' g g'
  Eigen::MatrixXd meat;   // sum over flights of (sum of psi g)(sum of psi g)'
  double mean_square = 0.0, mean_slope = 0.0;
  double rows = 0.0;
};

// g: gradient of the scaled residual by the free parameters.
Scores SumScores(const EnergyModel& model, const std::vector<Flight>& flights, const Estimate& estimate,
                 const std::vector<int>& free) {
  const auto size = static_cast<Eigen::Index>(free.size());
  Scores scores{.bread = Eigen::MatrixXd::Zero(size, size), .meat = Eigen::MatrixXd::Zero(size, size)};
  std::vector<double> gradient(static_cast<std::size_t>(model.size()));
  Eigen::VectorXd g(size);
  for (const Flight& flight : flights) {
    Eigen::VectorXd flight_score = Eigen::VectorXd::Zero(size);
    for (const FlightRow& row : flight.rows) {
      const double power_w = model.PowerW(row, estimate.values.data(), gradient.data());
      const double u = (power_w - row.power_w) / estimate.scale_w;
      for (Eigen::Index i = 0; i < size; ++i)
        g[i] = gradient[static_cast<std::size_t>(free[static_cast<std::size_t>(i)])] / estimate.scale_w;
      const double score = ScoreOf(estimate.loss, u), slope = ScoreSlopeOf(estimate.loss, u);
      flight_score += score * g;
      scores.bread += slope * g * g.transpose();
      scores.mean_square += score * score;
      scores.mean_slope += slope;
      scores.rows += 1.0;
    }
    scores.meat += flight_score * flight_score.transpose();
  }
  scores.mean_square /= scores.rows;
  scores.mean_slope /= scores.rows;
  return scores;
}

Interval MakeInterval(double value, double variance, double quantile) {
  const double error = std::sqrt(variance);
  return {error, value - quantile * error, value + quantile * error};
}

}  // namespace

Uncertainty EstimateUncertainty(const EnergyModel& model, const std::vector<Flight>& flights,
                                const Estimate& estimate) {
  const auto size = static_cast<std::size_t>(model.size());
  Uncertainty result;
  result.groups = static_cast<int>(flights.size());
  result.flights.assign(size, {kNone, kNone, kNone});
  result.rows = result.flights;
  result.correlation = Eigen::MatrixXd::Zero(model.size(), model.size());
  std::vector<int> held, free;
  for (int i = 0; i < model.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    (estimate.at_lower[k] || estimate.at_upper[k] ? held : free).push_back(i);
  }
  if (free.empty() || flights.size() < 2) return result;
  Eigen::MatrixXd inverse;
  if (!InverseNormalMatrix(model, flights, estimate, held, inverse)) return result;

  const Scores scores = SumScores(model, flights, estimate, free);
  const Eigen::LDLT<Eigen::MatrixXd> bread(scores.bread);
  if (bread.info() != Eigen::Success || !bread.isPositive()) return result;
  const Eigen::MatrixXd half = bread.solve(scores.meat);
  const double n = scores.rows, p = static_cast<double>(free.size()), groups = result.groups;
  const Eigen::MatrixXd sandwich =
      bread.solve(half.transpose()) * (groups / (groups - 1.0) * (n - 1.0) / (n - p));
  const double row_factor = n / (n - p) * scores.mean_square / (scores.mean_slope * scores.mean_slope);

  for (std::size_t i = 0; i < free.size(); ++i) {
    const int k = free[i];
    const auto index = static_cast<std::size_t>(k);
    const auto at = static_cast<Eigen::Index>(i);
    result.flights[index] =
        MakeInterval(estimate.values[index], sandwich(at, at), StudentT95(result.groups - 1));
    result.rows[index] =
        MakeInterval(estimate.values[index], inverse(k, k) * row_factor, StudentT95(static_cast<int>(n - p)));
    for (const int m : free)
      result.correlation(k, m) = inverse(k, m) / std::sqrt(inverse(k, k) * inverse(m, m));
  }
  result.determined = true;
  return result;
}

double StudentT95(int degrees_of_freedom) {
  ED3R_CHECK(degrees_of_freedom >= 1, "degrees of freedom");
  // Exact where the expansion is poor, then the Cornish-Fisher expansion around the normal quantile
  // (Abramowitz and Stegun 26.7.5).
  if (degrees_of_freedom == 1) return 12.7062;
  if (degrees_of_freedom == 2) return 4.30265;
  const double z = 1.959963984540054, n = degrees_of_freedom;
  const double z2 = z * z, z3 = z2 * z, z5 = z3 * z2, z7 = z5 * z2, z9 = z7 * z2;
  return z + (z3 + z) / (4.0 * n) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n * n) +
         (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * n * n * n) +
         (79.0 * z9 + 776.0 * z7 + 1482.0 * z5 - 1920.0 * z3 - 945.0 * z) / (92160.0 * n * n * n * n);
}

}  // namespace ed3r::fit
