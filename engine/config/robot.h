// The UAV robot: body, speeds, battery, sensors, onboard computer (paper: Appendix, UAV Robot
// Specifications).
#pragma once

#include <cmath>

#include "engine/config/field.h"

namespace ed3r {

struct RobotConfig {
  double mass_kg = 1.816;
  double propeller_radius_m = 0.1;
  int propellers = 4;
  double height_m = 0.23;
  double width_m = 0.47;
  double depth_m = 0.47;
  double speed_mps = 5.0;
  double acceleration_mps2 = 6.0;
  double yaw_rate_degps = 90.0;
  double drag_horizontal = 0.55;
  double drag_vertical = 0.35;
  double battery_mah = 3500.0;
  double battery_v = 11.1;
  double safety_distance_m = 2.0;

  double BatteryJ() const { return battery_mah * 1e-3 * 3600.0 * battery_v; }
  double FrontAreaM2() const { return height_m * width_m; }
  double TopAreaM2() const { return width_m * depth_m; }

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    constexpr std::string_view kTable = "Table UAV (c)";
    visit("mass_kg", self.mass_kg,
          {.unit = "kg", .min = 0.05, .max = 50, .source = kTable, .meaning = "total mass m"});
    visit("propeller_radius_m", self.propeller_radius_m,
          {.unit = "m",
           .min = 0.01,
           .max = 1,
           .source = "Table UAV (c), R1",
           .meaning = "radius r of a propeller, area pi r^2"});
    visit("propellers", self.propellers,
          {.min = 3, .max = 16, .source = kTable, .meaning = "number of propellers n_prop"});
    visit("height_m", self.height_m,
          {.unit = "m", .min = 0.02, .max = 3, .source = kTable, .meaning = "body height"});
    visit("width_m", self.width_m,
          {.unit = "m", .min = 0.05, .max = 3, .source = kTable, .meaning = "body width"});
    visit("depth_m", self.depth_m,
          {.unit = "m", .min = 0.05, .max = 3, .source = kTable, .meaning = "body depth"});
    visit("speed_mps", self.speed_mps,
          {.unit = "m/s", .min = 0.5, .max = 15, .source = kTable, .meaning = "cruise speed v_h and v_v"});
    visit("acceleration_mps2", self.acceleration_mps2,
          {.unit = "m/s^2",
           .min = 0.5,
           .max = 8,
           .source = "R4",
           .meaning = "acceleration and braking of a leg"});
    visit("yaw_rate_degps", self.yaw_rate_degps,
          {.unit = "deg/s",
           .min = 10,
           .max = 360,
           .source = "R35",
           .meaning = "turning rate; a turn is flown together with the move"});
    visit("drag_horizontal", self.drag_horizontal,
          {.min = 0, .max = 5, .source = "Table UAV (c), R2", .meaning = "horizontal drag coefficient C_dh"});
    visit("drag_vertical", self.drag_vertical,
          {.min = 0, .max = 5, .source = "Table UAV (c), R3", .meaning = "vertical drag coefficient C_dv"});
    visit("battery_mah", self.battery_mah,
          {.unit = "mAh", .min = 100, .max = 100000, .source = "Table UAV (b)", .meaning = "battery charge"});
    visit("battery_v", self.battery_v,
          {.unit = "V",
           .min = 3,
           .max = 60,
           .source = "R8",
           .meaning = "nominal battery voltage; beta_max = charge x voltage"});
    visit("safety_distance_m", self.safety_distance_m,
          {.unit = "m",
           .min = 0.5,
           .max = 20,
           .source = "Table UAV (a), R24",
           .meaning = "the robot comes to rest no nearer than this, sd_min"});
  }
};

// Onboard computer, and what one frame costs on it (Eqs. 5-7).
struct CpuConfig {
  double frequency_min_hz = 1.5e9;
  double frequency_max_hz = 3.2e9;
  int cores = 6;
  double flops_per_cycle = 8.0;
  double capacitance = 1e-28;
  double full_gflop = 20.23;
  double quantized_gflop = 5.05;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    constexpr std::string_view kTable = "Table UAV (b)";
    visit("frequency_min_hz", self.frequency_min_hz,
          {.unit = "Hz",
           .min = 1e8,
           .max = 1e10,
           .source = "Table UAV (b), R7",
           .meaning = "f_k is uniform from here ..."});
    visit("frequency_max_hz", self.frequency_max_hz,
          {.unit = "Hz",
           .min = 1e8,
           .max = 1e10,
           .source = "Table UAV (b), R7",
           .meaning = "... to here, f_max"});
    visit("cores", self.cores, {.min = 1, .max = 256, .source = kTable, .meaning = "CPU cores n_cpu"});
    visit("flops_per_cycle", self.flops_per_cycle,
          {.unit = "FLOP/cycle", .min = 0.5, .max = 1024, .source = kTable, .meaning = "c"});
    visit("capacitance", self.capacitance,
          {.unit = "F",
           .min = 1e-30,
           .max = 1e-25,
           .source = kTable,
           .meaning = "effective switched capacitance"});
    visit("full_gflop", self.full_gflop,
          {.unit = "GFLOP",
           .min = 0.001,
           .max = 10000,
           .source = "Table CV models",
           .meaning = "Full CNN, one frame"});
    visit("quantized_gflop", self.quantized_gflop,
          {.unit = "GFLOP",
           .min = 0.001,
           .max = 10000,
           .source = "Table CV models",
           .meaning = "Quantized CNN, one frame"});
  }
};

// Sensors and the sensing period (Eqs. 3, 4).
struct SensingConfig {
  double period_s = 3.0;
  double camera_fps = 11.0;
  double camera_power_w = 2.0;
  double frame_byte = 519000.0;
  int lidars = 6;
  double lidar_power_w = 0.9;
  double lidar_range_m = 30.0;
  double lidar_rate_hz = 24.0;
  double camera_hfov_deg = 80.0;
  int camera_width_px = 1920;
  int camera_height_px = 1080;

  int Frames() const { return static_cast<int>(std::lround(camera_fps * period_s)); }
  double PowerW() const { return camera_power_w + lidars * lidar_power_w; }

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    constexpr std::string_view kTable = "Table UAV (a)";
    visit("period_s", self.period_s,
          {.unit = "s", .min = 0.1, .max = 60, .source = kTable, .meaning = "sensing period s"});
    visit("camera_fps", self.camera_fps,
          {.unit = "1/s",
           .min = 0.5,
           .max = 120,
           .source = kTable,
           .meaning = "camera frames per second I_camera"});
    visit("camera_power_w", self.camera_power_w,
          {.unit = "W", .min = 0, .max = 100, .source = "Table UAV (a), R6", .meaning = "camera power"});
    visit("frame_byte", self.frame_byte,
          {.unit = "byte",
           .min = 100,
           .max = 1e9,
           .source = "Table UAV (a), R6",
           .meaning = "size of a frame w_camera"});
    visit("lidars", self.lidars,
          {.min = 6, .max = 6, .source = "Table UAV (a), R24", .meaning = "LiDARs; six look all around"});
    visit(
        "lidar_power_w", self.lidar_power_w,
        {.unit = "W", .min = 0, .max = 100, .source = "Table UAV (a), R6", .meaning = "power of one LiDAR"});
    visit("lidar_range_m", self.lidar_range_m,
          {.unit = "m", .min = 8, .max = 300, .source = "R24", .meaning = "LiDAR range"});
    visit("lidar_rate_hz", self.lidar_rate_hz,
          {.unit = "1/s",
           .min = 10,
           .max = 240,
           .source = "R24",
           .meaning = "LiDAR scans per second in flight"});
    visit("camera_hfov_deg", self.camera_hfov_deg,
          {.unit = "deg",
           .min = 10,
           .max = 150,
           .source = "silent (A37)",
           .meaning = "horizontal field of view"});
    visit("camera_width_px", self.camera_width_px,
          {.unit = "px", .min = 16, .max = 7680, .source = kTable, .meaning = "frame width"});
    visit("camera_height_px", self.camera_height_px,
          {.unit = "px", .min = 16, .max = 4320, .source = kTable, .meaning = "frame height"});
  }
};

}  // namespace ed3r
