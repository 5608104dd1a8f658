#include "studies/fit/determination.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace ed3r::fit {
namespace {

constexpr double kInterval = 1.96;

// A model with some of its parameters at fixed values.
class HeldModel final : public EnergyModel {
 public:
  HeldModel(const EnergyModel& whole, const std::vector<bool>& held, const std::vector<double>& values)
      : EnergyModel(whole.name(), whole.meaning(), FreeOf(whole, held)), whole_(whole), values_(values) {
    for (std::size_t i = 0; i < held.size(); ++i)
      if (!held[i]) free_.push_back(i);
  }

  double PowerW(const FlightRow& row, const double* parameters) const override {
    return whole_.PowerW(row, Whole(parameters).data());
  }

  double PowerW(const FlightRow& row, const double* parameters, double* gradient) const override {
    std::vector<double> all(values_.size());
    const double power_w = whole_.PowerW(row, Whole(parameters).data(), all.data());
    for (std::size_t k = 0; k < free_.size(); ++k) gradient[k] = all[free_[k]];
    return power_w;
  }

 private:
  static std::vector<ParameterSpec> FreeOf(const EnergyModel& whole, const std::vector<bool>& held) {
    std::vector<ParameterSpec> free;
    for (std::size_t i = 0; i < held.size(); ++i)
      if (!held[i]) free.push_back(whole.parameters()[i]);
    return free;
  }

  std::vector<double> Whole(const double* parameters) const {
    std::vector<double> whole = values_;
    for (std::size_t k = 0; k < free_.size(); ++k) whole[free_[k]] = parameters[k];
    return whole;
  }

  const EnergyModel& whole_;
  std::vector<double> values_;
  std::vector<std::size_t> free_;
};

// Standard error that each parameter would have if it were the only one: small is what the power depends on.
std::vector<double> OwnErrors(const EnergyModel& model, const std::vector<Flight>& flights,
                              const Estimate& estimate) {
  const auto size = static_cast<std::size_t>(model.size());
  std::vector<double> information(size, 0.0), gradient(size), errors(size);
  for (const Flight& flight : flights)
    for (const FlightRow& row : flight.rows) {
      model.PowerW(row, estimate.values.data(), gradient.data());
      for (std::size_t i = 0; i < size; ++i) information[i] += gradient[i] * gradient[i];
    }
  for (std::size_t i = 0; i < size; ++i)
    errors[i] = information[i] > 0.0 ? estimate.scale_w / std::sqrt(information[i])
                                     : std::numeric_limits<double>::infinity();
  return errors;
}

struct Fault {
  std::size_t parameter;
  std::string why;
  double width;  // of the interval, in widths of the bounds
};

// The parameter that is determined worst, nothing where all are. The efficiency, which is the first, only when no other is
// left to blame.
std::optional<Fault> WorstOf(const EnergyModel& model, const std::vector<Flight>& flights,
                             const Estimate& estimate, const Uncertainty& uncertainty) {
  const std::vector<double> own = OwnErrors(model, flights, estimate);
  std::optional<Fault> worst;
  for (std::size_t i = own.size(); i-- > 0;) {
    const ParameterSpec& spec = model.parameters()[i];
    const double range = spec.upper - spec.lower;
    const Interval& interval = uncertainty.flights[i];
    const double own_width = 2.0 * kInterval * own[i] / range;
    std::optional<Fault> fault;
    if (estimate.at_upper[i])
      fault = {i, fmt::format("the fit ends at its upper bound {:g}", spec.upper), 1.0 + own_width};
    else if (i == 0 && estimate.at_lower[i])
      fault = {i, fmt::format("the fit ends at its lower bound {:g}", spec.lower), 1.0 + own_width};
    else if (own_width > 1.0)
      fault = {i, "the power of these flights hardly depends on it", 1.0 + own_width};
    else if (!estimate.at_lower[i] && !uncertainty.determined)
      fault = {i, "these flights do not tell it from the others", own_width};
    else if (!estimate.at_lower[i] && interval.high - interval.low > range)
      fault = {i,
               fmt::format("its 95 % interval {:.3g} .. {:.3g} is wider than its bounds", interval.low,
                           interval.high),
               (interval.high - interval.low) / range};
    if (!fault) continue;
    const bool only_efficiency = worst && i == 0;
    if (!only_efficiency && (!worst || fault->width > worst->width)) worst = fault;
  }
  return worst;
}

}  // namespace

Determination Determine(const EnergyModel& model, const std::vector<double>& defaults,
                        const std::vector<Flight>& flights, const Estimate& estimate,
                        const Uncertainty& uncertainty, const Assessment& held_out) {
  const auto size = static_cast<std::size_t>(model.size());
  Determination result;
  result.values = defaults;
  result.not_determined.assign(size, "");
  const double none = std::numeric_limits<double>::quiet_NaN();
  result.intervals.assign(size, {none, none, none});
  Rows rows;
  for (const Flight& flight : flights)
    for (const FlightRow& row : flight.rows) rows.push_back(&row);
  std::vector<bool> held(size, false);
  std::vector<std::size_t> free(size);
  for (std::size_t i = 0; i < size; ++i) free[i] = i;
  Estimate now = estimate;
  Uncertainty sure = uncertainty;
  for (;;) {
    const HeldModel rest(model, held, defaults);
    if (free.size() < size) {
      now = EstimateParameters(rest, rows);  // from all starts: the held values may lie far from the solution
      sure = EstimateUncertainty(rest, flights, now);
    }
    const std::optional<Fault> fault = WorstOf(rest, flights, now, sure);
    if (!fault) break;
    const std::size_t parameter = free[fault->parameter];
    result.not_determined[parameter] = fault->why;
    if (parameter == 0) {
      result.impossible = fmt::format("{}: {}", model.parameters()[0].name, fault->why);
      return result;
    }
    held[parameter] = true;
    free.erase(free.begin() + static_cast<std::ptrdiff_t>(fault->parameter));
  }
  for (std::size_t k = 0; k < free.size(); ++k) {
    result.values[free[k]] = now.values[k];
    result.intervals[free[k]] = sure.flights[k];
  }
  if (!(held_out.median_error_pct <= kMaxHeldOutErrorPct))
    result.impossible =
        fmt::format("the median error of held-out energy is {:.0f} %", held_out.median_error_pct);
  return result;
}

}  // namespace ed3r::fit
