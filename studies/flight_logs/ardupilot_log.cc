#include "studies/flight_logs/ardupilot_log.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "engine/core/check.h"
#include "studies/flight_logs/dataflash.h"
#include "studies/flight_logs/joined_rows.h"

namespace ed3r::flight_logs {
namespace {

const std::set<std::string> kWanted = {"BAT",  "BAT2", "CURR", "CUR2", "GPS", "CTUN",
                                       "BARO", "XKF1", "NKF1", "EKF1", "EV",  "ARM"};

enum class Event { kArmed = 10, kDisarmed = 11, kLanded = 18, kNotLanded = 28 };

class ArduPilotReader {
 public:
  ArduPilotReader(const std::string& path, std::string_view bytes, const LogReading& reading)
      : path_(path), reading_(reading), log_(path, bytes, kWanted, reading.skip_bad) {
    for (const DataFlashLog::Message& message : log_.messages()) Take(message);
  }

  DecodedLog Read() {
    const ChosenBattery battery = BatteryInFlight(path_, batteries_, armed_, landed_, reading_);
    const bool gps = !gps_speed_.empty();
    const TimeSeries &speed = gps ? gps_speed_ : speed_, &climb = gps ? gps_climb_ : climb_;
    const TimeSeries& altitude = altitude_.empty() ? baro_altitude_ : altitude_;
    if (speed.empty())
      throw UserError(path_ + ": no velocity: neither a GPS with a 3-D fix nor XKF1, NKF1 or EKF1 messages");
    if (altitude.empty()) throw UserError(path_ + ": no altitude: neither CTUN nor BARO messages");
    std::vector<NamedSeries> series = {
        {"ground_speed_mps", &speed}, {"gps_climb_mps", &climb}, {"altitude_m", &altitude}};
    if (!speed_.empty()) {
      series.push_back({"estimator_speed_mps", &speed_});
      series.push_back({"estimator_climb_mps", &climb_});
    }
    if (!throttle_.empty()) series.push_back({"throttle_0_1000", &throttle_});
    DecodedLog joined = JoinRows(path_, LogKind::kArduPilot, battery, series, armed_, landed_);
    CheckFlown(joined);
    joined.bad = log_.skipped().places();
    if (joined.bad > 0) joined.notes.push_back(log_.skipped().Note());
    joined.notes.push_back(gps ? "speed and climb are the GPS's (3-D fix)"
                               : "speed and climb are the estimator's: no GPS with a 3-D fix");
    return joined;
  }

 private:
  void Take(const DataFlashLog::Message& message) {
    const std::string& name = log_.FormatOf(message).name;
    const std::optional<double> stamp = log_.TimeS(message);
    if (stamp) last_s_ = *stamp;
    // Events of old logs have no stamp: they happen when the message before them does.
    if (name == "EV") return TakeEvent(message);
    if (name == "ARM") {
      if (const auto state = log_.Number(message, "ArmState")) armed_.Add(last_s_, *state > 0.5 ? 1.0 : 0.0);
      return;
    }
    if (!stamp) return;
    if (name == "BAT" || name == "BAT2" || name == "CURR" || name == "CUR2")
      return TakeBattery(message, name, *stamp);
    if (name == "GPS") return TakeGps(message, *stamp);
    if (name == "BARO") return TakeBarometer(message, *stamp);
    if (name == "CTUN") {
      Add(altitude_, *stamp, log_.Number(message, "Alt"));
      if (const auto whole = log_.Number(message, "ThrOut")) return AddThrottle(*stamp, *whole);
      if (const auto share = log_.Number(message, "ThO")) AddThrottle(*stamp, 1000.0 * *share);
      return;
    }
    TakeEstimator(message, name, *stamp);
  }

  void TakeEvent(const DataFlashLog::Message& message) {
    const auto id = log_.Number(message, "Id");
    if (!id) return;
    const int event = static_cast<int>(*id);
    if (event == static_cast<int>(Event::kArmed)) armed_.Add(last_s_, 1.0);
    if (event == static_cast<int>(Event::kDisarmed)) armed_.Add(last_s_, 0.0);
    if (event == static_cast<int>(Event::kLanded)) landed_.Add(last_s_, 1.0);
    if (event == static_cast<int>(Event::kNotLanded)) landed_.Add(last_s_, 0.0);
  }

  void TakeBattery(const DataFlashLog::Message& message, const std::string& name, double time_s) {
    char voltage_type = 0, current_type = 0;
    const auto voltage = log_.Number(message, "Volt", &voltage_type),
               current = log_.Number(message, "Curr", &current_type);
    if (!voltage || !current) return;
    auto instance = log_.Number(message, "Inst");
    if (!instance) instance = log_.Number(message, "Instance");
    const int id = (name == "BAT2" || name == "CUR2" ? 1 : 0) + static_cast<int>(instance.value_or(0.0));
    Battery& battery = batteries_[id];
    battery.id = id;
    if (battery.source.empty()) battery.source = instance ? fmt::format("{} instance {}", name, id) : name;
    // Whole numbers of 16 bits are hundredths: logs of before 2016.
    const auto parts = [](char type) { return type == 'h' || type == 'H' ? 100.0 : 1.0; };
    battery.voltage_v.Add(time_s, *voltage / parts(voltage_type));
    battery.current_a.Add(time_s, *current / parts(current_type));
    if (const auto throttle = log_.Number(message, "Throttle"); throttle && id == 0) {
      if (!battery_throttle_) throttle_ = {};
      battery_throttle_ = true;
      throttle_.Add(time_s, *throttle);
    }
  }

  void AddThrottle(double time_s, double throttle) {
    if (!battery_throttle_) throttle_.Add(time_s, throttle);
  }

  // Of several receivers, barometers or estimator cores: `field` numbers them, where the log has it.
  bool IsFirst(const DataFlashLog::Message& message, std::string_view field) const {
    return log_.Number(message, field).value_or(0.0) < 0.5;
  }

  void TakeBarometer(const DataFlashLog::Message& message, double time_s) {
    if (IsFirst(message, "I")) Add(baro_altitude_, time_s, log_.Number(message, "Alt"));
  }

  void TakeGps(const DataFlashLog::Message& message, double time_s) {
    constexpr double kFix3d = 3.0;
    if (!IsFirst(message, "I")) return;
    const auto status = log_.Number(message, "Status"), speed = log_.Number(message, "Spd"),
               down = log_.Number(message, "VZ");
    if (!status || *status < kFix3d || !speed || !down) return;
    gps_speed_.Add(time_s, *speed);
    gps_climb_.Add(time_s, -*down);
  }

  void TakeEstimator(const DataFlashLog::Message& message, const std::string& name, double time_s) {
    if (!IsFirst(message, "C")) return;
    const int rank = name == "XKF1" ? 3 : name == "NKF1" ? 2 : 1;
    if (rank < estimator_rank_) return;
    if (rank > estimator_rank_) speed_ = climb_ = {};
    estimator_rank_ = rank;
    const auto north = log_.Number(message, "VN"), east = log_.Number(message, "VE"),
               down = log_.Number(message, "VD");
    if (!north || !east || !down) return;
    speed_.Add(time_s, std::hypot(*north, *east));
    climb_.Add(time_s, -*down);
  }

  static void Add(TimeSeries& series, double time_s, const std::optional<double>& value) {
    if (value) series.Add(time_s, *value);
  }

  std::string path_;
  const LogReading& reading_;
  DataFlashLog log_;
  double last_s_ = 0.0;
  std::map<int, Battery> batteries_;
  TimeSeries gps_speed_, gps_climb_, speed_, climb_, altitude_, baro_altitude_, throttle_, armed_, landed_;
  bool battery_throttle_ = false;
  int estimator_rank_ = 0;
};

}  // namespace

DecodedLog ReadArduPilotLog(const std::string& path, std::string_view bytes, const LogReading& reading) {
  return ArduPilotReader(path, bytes, reading).Read();
}

}  // namespace ed3r::flight_logs
