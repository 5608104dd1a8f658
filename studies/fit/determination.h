// What of a fitted model the data determine: what may be flown.
//
// A parameter is not determined where the fit ended at its upper bound (the data ask for more than the model may give),
// where its 95 % interval is as wide as its bounds, or where the normal equations are singular. One at a time, such
// parameters are held at the engine's default and the others are fitted again, so that what is written and the default of
// what is not make one model. A lower bound that the data hold on to is a value: that effect is not there.
#pragma once

#include <string>
#include <vector>

#include "studies/fit/assessment.h"
#include "studies/fit/energy_model.h"
#include "studies/fit/uncertainty.h"

namespace ed3r::fit {

// Median error of held-out energy above which a model says nothing about the log.
inline constexpr double kMaxHeldOutErrorPct = 100.0;

struct Determination {
  std::string impossible;  // why the model must not be flown; "" if it may
  // Per parameter of the model: the value to fly, its interval, and why it is the default and not written ("" if the data
  // determine it).
  std::vector<double> values;
  std::vector<Interval> intervals;
  std::vector<std::string> not_determined;

  bool Usable() const { return impossible.empty(); }
};

// `defaults`: the engine's value of each of the model's parameters. Deterministic, one thread.
Determination Determine(const EnergyModel& model, const std::vector<double>& defaults,
                        const std::vector<Flight>& flights, const Estimate& estimate,
                        const Uncertainty& uncertainty, const Assessment& held_out);

}  // namespace ed3r::fit
