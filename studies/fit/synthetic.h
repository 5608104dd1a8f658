// Flight logs made from known parameters: what the estimation is checked against.
#pragma once

#include <cstdint>
#include <vector>

#include "studies/fit/energy_model.h"

namespace ed3r::fit {

struct SyntheticOptions {
  int flights = 60;
  int rows_per_flight = 100;
  double period_s = 0.5;
  double max_airspeed_mps = 15.0;
  double max_climb_mps = 5.0;
  double max_payload_kg = 0.5;  // flights carry 0, half or all of it
  double noise_share = 0.05;    // standard deviation of a row's noise, share of its power
  double outlier_share = 0.01;  // rows that are drop-outs or spikes
  double drop_out_share = 0.5;  // of the outliers; 1 = all of them read near 0 W
  double correlation = 0.0;     // of neighbouring rows' noise (first-order autoregression)
  double flight_share = 0.0;    // standard deviation of an error common to all rows of a flight
};

// Flights of hover, climb, cruise and descent phases; the power of `model` at `truth` plus noise. A pure
// function of its arguments: log `index` of `seed`. The format supplies the airframe and what counts as
// hovering.
FlightLog MakeSyntheticLog(const EnergyModel& model, const std::vector<double>& truth,
                           const LogFormat& format, const SyntheticOptions& options, std::uint64_t seed,
                           std::uint32_t index);

}  // namespace ed3r::fit
