#include "studies/flight_logs/px4_log.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "engine/core/check.h"
#include "studies/flight_logs/joined_rows.h"
#include "studies/flight_logs/ulog.h"

namespace ed3r::flight_logs {
namespace {

const std::set<std::string> kWanted = {"battery_status", "vehicle_local_position", "vehicle_air_data",
                                       "actuator_armed", "vehicle_land_detected"};

class Px4Reader {
 public:
  Px4Reader(const std::string& path, std::string_view bytes, const LogReading& reading)
      : path_(path), reading_(reading), log_(path, bytes, kWanted, reading.skip_bad) {
    for (const ULog::Sample& sample : log_.samples()) Take(sample);
  }

  DecodedLog Read() {
    const ChosenBattery battery = BatteryInFlight(path_, batteries_, armed_, landed_, reading_);
    if (speed_.empty())
      throw UserError(
          fmt::format("{}: no velocity: vehicle_local_position {}", path_,
                      positions_ == 0 ? "is not in the log" : "never says that its velocities are valid"));
    std::vector<NamedSeries> series = {
        {"ground_speed_mps", &speed_}, {"climb_mps", &climb_}, {"altitude_m", &altitude_}};
    if (!density_.empty()) series.push_back({"air_density_kgm3", &density_});
    DecodedLog joined = JoinRows(path_, LogKind::kPx4, battery, series, armed_, landed_);
    CheckFlown(joined);
    joined.bad = log_.skipped().places();
    if (joined.bad > 0) joined.notes.push_back(log_.skipped().Note());
    joined.notes.push_back("speed and climb are the estimator's (vehicle_local_position)");
    if (log_.dropouts() > 0)
      joined.notes.push_back(fmt::format("the logger lost data {} times", log_.dropouts()));
    return joined;
  }

 private:
  void Take(const ULog::Sample& sample) {
    const ULog::Topic& topic = log_.topics()[sample.topic];
    const auto time_s = log_.TimeS(sample);
    if (!time_s) return;
    if (topic.name == "battery_status") return TakeBattery(sample, topic.instance, *time_s);
    if (topic.instance != 0) return;
    if (topic.name == "vehicle_local_position") return TakePosition(sample, *time_s);
    if (topic.name == "vehicle_air_data") {
      if (const auto rho = log_.Number(sample, "rho")) density_.Add(*time_s, *rho);
    } else if (topic.name == "actuator_armed") {
      if (const auto armed = log_.Number(sample, "armed")) armed_.Add(*time_s, *armed > 0.5 ? 1.0 : 0.0);
    } else if (const auto landed = log_.Number(sample, "landed")) {
      landed_.Add(*time_s, *landed > 0.5 ? 1.0 : 0.0);
    }
  }

  void TakeBattery(const ULog::Sample& sample, int instance, double time_s) {
    const auto voltage = log_.Number(sample, "voltage_v"), current = log_.Number(sample, "current_a");
    if (!voltage || !current || log_.Number(sample, "connected").value_or(1.0) < 0.5) return;
    Battery& battery = batteries_[instance];
    battery.id = instance;
    if (battery.source.empty()) battery.source = fmt::format("battery_status {}", instance);
    battery.voltage_v.Add(time_s, *voltage);
    battery.current_a.Add(time_s, *current);
  }

  void TakePosition(const ULog::Sample& sample, double time_s) {
    ++positions_;
    const auto vx = log_.Number(sample, "vx"), vy = log_.Number(sample, "vy"), vz = log_.Number(sample, "vz"),
               z = log_.Number(sample, "z");
    if (!vx || !vy || !vz || !z) return;
    if (log_.Number(sample, "v_xy_valid").value_or(1.0) < 0.5 ||
        log_.Number(sample, "v_z_valid").value_or(1.0) < 0.5)
      return;
    speed_.Add(time_s, std::hypot(*vx, *vy));
    climb_.Add(time_s, -*vz);
    altitude_.Add(time_s, -*z);
  }

  std::string path_;
  const LogReading& reading_;
  ULog log_;
  std::map<int, Battery> batteries_;
  TimeSeries speed_, climb_, altitude_, density_, armed_, landed_;
  int positions_ = 0;
};

}  // namespace

DecodedLog ReadPx4Log(const std::string& path, std::string_view bytes, const LogReading& reading) {
  return Px4Reader(path, bytes, reading).Read();
}

}  // namespace ed3r::flight_logs
