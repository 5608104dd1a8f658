#include "studies/fit/synthetic.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/core/random.h"

namespace ed3r::fit {
namespace {

constexpr int kPhaseRows = 20;

struct Phase {
  double airspeed_mps, climb_mps;
};

// Every flight begins hovering; then hover, climb, descent and cruise are equally likely.
Phase DrawPhase(const SyntheticOptions& options, bool first, Stream& stream) {
  const std::uint32_t kind = first ? 0 : stream.Below(4);
  const double speed = stream.Uniform(0.0, options.max_airspeed_mps);
  const double climb = stream.Uniform(0.1, 1.0) * options.max_climb_mps;
  switch (kind) {
    case 0:
      return {speed / options.max_airspeed_mps, 0.0};
    case 1:
      return {speed, climb};
    case 2:
      return {speed, -climb};
    default:
      return {speed, 0.0};
  }
}

// Noise of a flight's rows as a factor of their power, outliers included.
class Noise {
 public:
  Noise(const SyntheticOptions& options, Stream& stream)
      : options_(options), stream_(stream), state_(stream.Normal()), flight_(stream.Normal()) {}

  double Factor() {
    const double rho = options_.correlation;
    state_ = rho * state_ + std::sqrt(1.0 - rho * rho) * stream_.Normal();
    const bool outlier = stream_.Uniform() < options_.outlier_share;
    const bool drop_out = stream_.Uniform() < options_.drop_out_share;
    const double size = stream_.Uniform();
    if (outlier) return drop_out ? 0.1 * size : 2.0 + size;
    return 1.0 + options_.noise_share * state_ + options_.flight_share * flight_;
  }

 private:
  const SyntheticOptions& options_;
  Stream& stream_;
  double state_, flight_;
};

}  // namespace

FlightLog MakeSyntheticLog(const EnergyModel& model, const std::vector<double>& truth,
                           const LogFormat& format, const SyntheticOptions& options, std::uint64_t seed,
                           std::uint32_t index) {
  FlightLog log;
  log.format = format;
  log.files = {"synthetic"};
  for (int f = 0; f < options.flights; ++f) {
    Stream stream(seed, index, Purpose::kBootstrap, static_cast<std::uint32_t>(f));
    Flight flight{.id = fmt::format("synthetic#{}", f), .rows = {}};
    FlightRow row;
    row.mass_kg = format.robot.mass_kg + 0.5 * options.max_payload_kg * (f % 3);
    row.density_kgm3 = stream.Uniform(1.15, 1.25);
    Noise noise(options, stream);
    Phase phase{};
    for (int i = 0; i < options.rows_per_flight; ++i) {
      if (i % kPhaseRows == 0) phase = DrawPhase(options, i == 0, stream);
      row.time_s = i * options.period_s;
      row.airspeed_mps = phase.airspeed_mps;
      row.climb_mps = phase.climb_mps;
      row.power_w = model.PowerW(row, truth.data()) * noise.Factor();
      log.hover_rows += IsHover(row, format) ? 1 : 0;
      flight.rows.push_back(row);
    }
    log.rows += options.rows_per_flight;
    log.flights.push_back(std::move(flight));
  }
  return log;
}

}  // namespace ed3r::fit
