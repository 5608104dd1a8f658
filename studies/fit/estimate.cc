#include "studies/fit/estimate.h"

#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"

namespace ed3r::fit {
namespace {

constexpr std::size_t kStartRows = 1500;  // several starts are compared on so many rows at most
constexpr int kSpreadStarts = 5;
constexpr double kSameCost = 1e-3;
constexpr double kAtBound = 1e-4;  // share of the range between the bounds

struct Solution {
  std::vector<double> values;
  double cost = 0.0;
  int iterations = 0;
};

double MedianAbsolute(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> Residuals(const EnergyModel& model, const Rows& rows, const std::vector<double>& values) {
  std::vector<double> residuals;
  residuals.reserve(rows.size());
  for (const FlightRow* row : rows) residuals.push_back(model.PowerW(*row, values.data()) - row->power_w);
  return residuals;
}

// 1.4826 median |residual|: the standard deviation if the residuals are normal. A floor keeps noise-free logs
// solvable.
double ScaleW(const EnergyModel& model, const Rows& rows, const std::vector<double>& values) {
  constexpr double kFloorW = 1e-6;
  return std::max(kFloorW, 1.4826 * MedianAbsolute(Residuals(model, rows, values)));
}

// rho(u^2) of the loss, twice its cost, and the slope of its root by u.
struct Root {
  double value, slope;
};

Root RootOfLoss(Loss loss, double u) {
  const double size = std::abs(u);
  if (loss == Loss::kHuber) {
    if (size <= kHuberLimit) return {u, 1.0};
    const double root = std::sqrt(kHuberLimit * (2.0 * size - kHuberLimit));
    return {std::copysign(root, u), kHuberLimit / root};
  }
  constexpr double kSquare = kTukeyLimit * kTukeyLimit;
  const double q = std::min(1.0, u * u / kSquare);
  // rho = a^2/3 (1 - (1 - q)^3), written so that a small q loses no digits.
  const double shrink = std::sqrt((3.0 - 3.0 * q + q * q) / 3.0);
  if (q >= 1.0) return {std::copysign(kTukeyLimit * shrink, u), 0.0};
  return {u * shrink, (1.0 - q) * (1.0 - q) / shrink};
}

// The residuals of a block of rows. The loss is inside, as the signed root of rho: the cost is that of a
// Ceres loss function per row, but Gauss-Newton then knows the flat tails of the loss (a loss function only
// reweights), and a block of rows has the overhead of one residual.
class BlockResiduals final : public ceres::CostFunction {
 public:
  BlockResiduals(const EnergyModel& model, Rows rows, std::optional<Loss> loss, double scale_w)
      : model_(model), rows_(std::move(rows)), loss_(loss), scale_w_(scale_w) {
    set_num_residuals(static_cast<int>(rows_.size()));
    mutable_parameter_block_sizes()->push_back(model.size());
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const auto size = static_cast<std::size_t>(model_.size());
    double* jacobian = jacobians != nullptr ? jacobians[0] : nullptr;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      double* gradient = jacobian != nullptr ? jacobian + i * size : nullptr;
      const FlightRow& row = *rows_[i];
      const double power_w = gradient != nullptr ? model_.PowerW(row, parameters[0], gradient)
                                                 : model_.PowerW(row, parameters[0]);
      const double u = (power_w - row.power_w) / scale_w_;
      const Root root = loss_ ? RootOfLoss(*loss_, u) : Root{u, 1.0};
      residuals[i] = root.value;
      if (gradient == nullptr) continue;
      for (std::size_t k = 0; k < size; ++k) gradient[k] *= root.slope / scale_w_;
    }
    return true;
  }

 private:
  const EnergyModel& model_;
  Rows rows_;
  std::optional<Loss> loss_;
  double scale_w_;
};

// Marks of parameters that stay at their value.
using Held = std::vector<bool>;

// One Ceres solve; `bounded` keeps the parameters between their bounds.
Solution Solve(const EnergyModel& model, const Rows& rows, std::vector<double> start, Loss loss,
               double scale_w, bool bounded, const Held& held) {
  constexpr std::size_t kBlockRows = 512;
  ceres::Problem problem;
  problem.AddParameterBlock(start.data(), model.size());
  std::vector<int> constant;
  for (int i = 0; i < model.size(); ++i) {
    const ParameterSpec& spec = model.parameters()[static_cast<std::size_t>(i)];
    if (held[static_cast<std::size_t>(i)]) constant.push_back(i);
    if (!bounded) continue;
    problem.SetParameterLowerBound(start.data(), i, spec.lower);
    problem.SetParameterUpperBound(start.data(), i, spec.upper);
  }
  if (constant.size() == held.size()) return {start, 0.0, 0};
  if (!constant.empty()) problem.SetManifold(start.data(), new ceres::SubsetManifold(model.size(), constant));
  for (std::size_t begin = 0; begin < rows.size(); begin += kBlockRows) {
    const std::size_t end = std::min(rows.size(), begin + kBlockRows);
    Rows block(rows.begin() + static_cast<std::ptrdiff_t>(begin),
               rows.begin() + static_cast<std::ptrdiff_t>(end));
    problem.AddResidualBlock(new BlockResiduals(model, std::move(block), loss, scale_w), nullptr,
                             start.data());
  }

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-10;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-8;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ED3R_CHECK(summary.IsSolutionUsable(), model.name() + ": " + summary.message);
  return {start, summary.final_cost, static_cast<int>(summary.iterations.size())};
}

// Derivative of the cost by each parameter.
std::vector<double> CostGradient(const EnergyModel& model, const Rows& rows,
                                 const std::vector<double>& values, Loss loss, double scale_w) {
  std::vector<double> total(values.size(), 0.0), gradient(values.size());
  for (const FlightRow* row : rows) {
    const double power_w = model.PowerW(*row, values.data(), gradient.data());
    const double score = ScoreOf(loss, (power_w - row->power_w) / scale_w) / scale_w;
    for (std::size_t k = 0; k < total.size(); ++k) total[k] += score * gradient[k];
  }
  return total;
}

// A bounded minimum near `start` by active set: what stands at a bound is held, the rest is solved freely;
// what leaves its bounds joins the held, what wants back in is released. Ceres' own bounds creep along an
// active bound (dozens of iterations, each with a line search, where this takes two short solves).
Solution SolveActiveSet(const EnergyModel& model, const Rows& rows, const std::vector<double>& start,
                        Loss loss, double scale_w) {
  constexpr int kMaxRounds = 10;
  const std::vector<ParameterSpec>& specs = model.parameters();
  Solution solution{.values = start};
  Held held(start.size(), false);
  const auto clamp_to_bounds = [&] {
    bool moved = false;
    for (std::size_t i = 0; i < held.size(); ++i) {
      const double margin = kAtBound * (specs[i].upper - specs[i].lower);
      double& value = solution.values[i];
      if (held[i] || (value > specs[i].lower + margin && value < specs[i].upper - margin)) continue;
      value = value <= specs[i].lower + margin ? specs[i].lower : specs[i].upper;
      held[i] = moved = true;
    }
    return moved;
  };
  clamp_to_bounds();
  int iterations = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    solution = Solve(model, rows, solution.values, loss, scale_w, false, held);
    iterations += solution.iterations;
    bool changed = clamp_to_bounds();
    if (!changed) {
      const std::vector<double> gradient = CostGradient(model, rows, solution.values, loss, scale_w);
      for (std::size_t i = 0; i < held.size(); ++i) {
        const bool inward = solution.values[i] == specs[i].lower ? gradient[i] < 0.0 : gradient[i] > 0.0;
        if (!held[i] || !inward) continue;
        held[i] = false;
        changed = true;
      }
    }
    solution.iterations = iterations;
    if (!changed) return solution;
  }
  // A parameter whose minimum lies on the bound itself can be held and released for ever.
  solution = Solve(model, rows, solution.values, loss, scale_w, true, Held(start.size(), false));
  solution.iterations += iterations;
  return solution;
}

// The model's own start, then points of an additive recurrence with irrational steps: evenly spread in any
// dimension.
std::vector<std::vector<double>> Starts(const EnergyModel& model) {
  std::vector<std::vector<double>> starts(kSpreadStarts + 1);
  const double golden = std::pow(2.0, 1.0 / (model.size() + 1.0));
  for (int k = 0; k <= kSpreadStarts; ++k) {
    double step = 1.0;
    for (const ParameterSpec& spec : model.parameters()) {
      step /= golden;
      const double share = std::fmod(0.5 + k * step, 1.0);
      starts[static_cast<std::size_t>(k)].push_back(
          k == 0 ? spec.start : spec.lower + (0.02 + 0.96 * share) * (spec.upper - spec.lower));
    }
  }
  return starts;
}

Solution BestOfStarts(const EnergyModel& model, const Rows& rows, Estimate& estimate) {
  Rows thinned;
  const std::size_t stride = (rows.size() + kStartRows - 1) / kStartRows;
  std::vector<double> powers;
  for (std::size_t i = 0; i < rows.size(); i += stride) {
    thinned.push_back(rows[i]);
    powers.push_back(rows[i]->power_w);
  }
  const double scale_w = 0.1 * std::max(1e-3, MedianAbsolute(powers));
  std::vector<Solution> solutions;
  for (const std::vector<double>& start : Starts(model))
    solutions.push_back(Solve(model, thinned, start, Loss::kHuber, scale_w, true, Held(start.size(), false)));
  const auto best = std::min_element(solutions.begin(), solutions.end(),
                                     [](const Solution& a, const Solution& b) { return a.cost < b.cost; });
  estimate.starts = static_cast<int>(solutions.size());
  for (const Solution& solution : solutions) {
    estimate.starts_agreeing += solution.cost <= best->cost * (1.0 + kSameCost) + 1e-9 ? 1 : 0;
    estimate.iterations += solution.iterations;
  }
  return *best;
}

void CountBeyond(const EnergyModel& model, const Rows& rows, const std::vector<double>& values,
                 Estimate& estimate) {
  estimate.beyond_low = estimate.beyond_high = 0;
  for (const double residual : Residuals(model, rows, values)) {
    estimate.beyond_low += residual > kTukeyLimit * estimate.scale_w ? 1 : 0;
    estimate.beyond_high += residual < -kTukeyLimit * estimate.scale_w ? 1 : 0;
  }
}

void MarkBounds(const EnergyModel& model, Estimate& estimate) {
  for (std::size_t i = 0; i < estimate.values.size(); ++i) {
    const ParameterSpec& spec = model.parameters()[i];
    const double margin = kAtBound * (spec.upper - spec.lower);
    estimate.at_lower.push_back(estimate.values[i] <= spec.lower + margin);
    estimate.at_upper.push_back(estimate.values[i] >= spec.upper - margin);
  }
}

// Both loss stages from a start, on all rows.
Solution TwoStages(const EnergyModel& model, const Rows& rows, Solution solution, Estimate& estimate) {
  constexpr int kHuberRounds = 2;  // the scale needs a solution and the solution a scale
  for (int round = 0; round < kHuberRounds; ++round) {
    estimate.scale_w = ScaleW(model, rows, solution.values);
    solution = SolveActiveSet(model, rows, solution.values, Loss::kHuber, estimate.scale_w);
    estimate.iterations += solution.iterations;
  }
  estimate.scale_w = ScaleW(model, rows, solution.values);
  const Solution tukey = SolveActiveSet(model, rows, solution.values, Loss::kTukey, estimate.scale_w);
  estimate.iterations += tukey.iterations;
  CountBeyond(model, rows, tukey.values, estimate);
  const int beyond = estimate.beyond_low + estimate.beyond_high;
  estimate.loss = beyond <= kMaxOutlierShare * static_cast<double>(rows.size()) ? Loss::kTukey : Loss::kHuber;
  return estimate.loss == Loss::kTukey ? tukey : solution;
}

}  // namespace

Estimate EstimateParameters(const EnergyModel& model, const Rows& rows, const std::optional<Estimate>& near) {
  ED3R_CHECK(rows.size() > static_cast<std::size_t>(model.size()), model.name() + ": too few rows");
  Estimate estimate;
  estimate.rows = static_cast<int>(rows.size());
  Solution solution;
  if (near) {
    estimate.starts = estimate.starts_agreeing = 1;
    estimate.loss = near->loss;
    estimate.scale_w = near->scale_w;
    solution = SolveActiveSet(model, rows, near->values, near->loss, estimate.scale_w);
    estimate.iterations = solution.iterations;
  } else {
    const Solution start = BestOfStarts(model, rows, estimate);
    solution = TwoStages(model, rows, start, estimate);
  }
  estimate.values = solution.values;
  CountBeyond(model, rows, estimate.values, estimate);
  MarkBounds(model, estimate);
  return estimate;
}

std::unique_ptr<ceres::CostFunction> RowResiduals(const EnergyModel& model, Rows rows, double scale_w) {
  return std::make_unique<BlockResiduals>(model, std::move(rows), std::nullopt, scale_w);
}

double ScoreOf(Loss loss, double u) {
  if (loss == Loss::kHuber) return std::clamp(u, -kHuberLimit, kHuberLimit);
  const double t = 1.0 - u * u / (kTukeyLimit * kTukeyLimit);
  return t > 0.0 ? u * t * t : 0.0;
}

double ScoreSlopeOf(Loss loss, double u) {
  if (loss == Loss::kHuber) return std::abs(u) <= kHuberLimit ? 1.0 : 0.0;
  const double q = u * u / (kTukeyLimit * kTukeyLimit);
  return q < 1.0 ? (1.0 - q) * (1.0 - 5.0 * q) : 0.0;
}

}  // namespace ed3r::fit
