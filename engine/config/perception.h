// Detection: which tier looks at the world, and the few parameters of the fast tier (R13-R16, R33, R34).
//
// The fast tier ("profile") turns what the camera could see into confidences of the frames of one sensing
// period:
//   signal      s   = the stronger of   w_fire a_fire + w_smoke a_smoke   and   gain w_distractor a_distractor
//   logit       z_i = slope log10(s / half_signal) + N(0, view_sigma) per view + N(0, frame_sigma) per frame
//   confidence  of frame i = ceiling / (1 + exp(-z_i)), and 0 below frame_threshold.
// a: visible share of the image; a_distractor: that of the one distractor which misleads most, times
// 1 / (1 + exp((distractor_tilt_deg - steepness) / distractor_tilt_width_deg)) for how steeply it is seen. The models
// differ in what ResponseConfig holds. A tier made of rendered pixels can fit them; the defaults are calibrated on what the
// paper says of its random walk alone (sweeps/calibration, scripts/calibrate.py).
#pragma once

#include "engine/config/detector.h"
#include "engine/config/field.h"
#include "engine/config/render.h"

namespace ed3r {

enum class PerceptionTier { kProfile, kPixels };
template <>
struct EnumNames<PerceptionTier> {
  static constexpr EnumName<PerceptionTier> kNames[] = {{PerceptionTier::kProfile, "profile"},
                                                        {PerceptionTier::kPixels, "pixels"}};
};

// With the values frozen in sweeps/calibration/frozen.yaml.
inline constexpr std::string_view kCalibratedSource = "calibrated";
inline constexpr std::string_view kAssumedSource = "assumed";

// The fluctuation of a view while the robot hovers over it: part of the view, or drawn anew in every timestep.
enum class ViewNoise { kKept, kRedrawn };
template <>
struct EnumNames<ViewNoise> {
  static constexpr EnumName<ViewNoise> kNames[] = {{ViewNoise::kKept, "kept"},
                                                   {ViewNoise::kRedrawn, "redrawn"}};
};

// Response of one detection model.
struct ResponseConfig {
  double half_signal = 5.67e-5;
  double slope = 5.04;
  double ceiling = 0.935;
  double view_sigma = 0.415;
  double frame_sigma = 0.3;
  double distractor_gain = 1.0;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    visit("half_signal", self.half_signal,
          {.min = 1e-7,
           .max = 1,
           .source = kCalibratedSource,
           .meaning = "signal (share of the image) at half the ceiling"});
    visit("slope", self.slope,
          {.unit = "logit/decade",
           .min = 0.1,
           .max = 50,
           .source = kCalibratedSource,
           .meaning = "growth of the logit with the signal"});
    visit("ceiling", self.ceiling,
          {.min = 0.5, .max = 1, .source = kCalibratedSource, .meaning = "largest confidence"});
    visit("view_sigma", self.view_sigma,
          {.unit = "logit",
           .min = 0,
           .max = 10,
           .source = kCalibratedSource,
           .meaning = "fluctuation from view to view"});
    visit("frame_sigma", self.frame_sigma,
          {.unit = "logit",
           .min = 0,
           .max = 10,
           .source = kAssumedSource,
           .meaning = "fluctuation from frame to frame"});
    visit("distractor_gain", self.distractor_gain,
          {.min = 0,
           .max = 100,
           .source = "R34, Quantized's calibrated",
           .meaning = "how much a distractor excites this model, times distractor_weight"});
  }
};

struct PerceptionConfig {
  PerceptionTier tier = PerceptionTier::kProfile;
  double frame_threshold = 0.5;
  double fire_weight = 1.0;
  double smoke_weight = 0.55;
  double haze_range_m = 206.0;
  double distractors_per_km2 = 130.0;
  double distractor_radius_m = 2.5;
  double distractor_weight = 2.12;
  double distractor_radius_sigma = 0.958;
  double distractor_tilt_deg = 72.6;
  double distractor_tilt_width_deg = 2.35;
  ViewNoise view_noise = ViewNoise::kKept;
  ResponseConfig full;
  ResponseConfig quantized{.half_signal = 8.45e-5,
                           .slope = 3.78,
                           .ceiling = 0.895,
                           .view_sigma = 0.581,
                           .frame_sigma = 0.6,
                           .distractor_gain = 0.389};
  RenderConfig render;
  DetectorConfig detector;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    visit("tier", self.tier, {.source = "none in the paper", .meaning = "how confidences are made"});
    visit("frame_threshold", self.frame_threshold,
          {.min = 0, .max = 1, .source = "R33", .meaning = "a frame's confidence below this counts as 0"});
    visit("fire_weight", self.fire_weight,
          {.min = 0, .max = 10, .source = "unit of weight", .meaning = "weight of visible flame"});
    visit("smoke_weight", self.smoke_weight,
          {.min = 0, .max = 10, .source = kCalibratedSource, .meaning = "weight of visible smoke"});
    visit("haze_range_m", self.haze_range_m,
          {.unit = "m",
           .min = 50,
           .max = 1e6,
           .source = kCalibratedSource,
           .meaning = "distance at which haze leaves 1/e of a signal"});
    visit("distractors_per_km2", self.distractors_per_km2,
          {.unit = "1/km^2",
           .min = 0,
           .max = 5000,
           .source = "R34, calibrated",
           .meaning = "sources of false confidence, drawn per mission"});
    visit("distractor_radius_m", self.distractor_radius_m,
          {.unit = "m", .min = 0.1, .max = 20, .source = "R34", .meaning = "mean radius of a distractor"});
    visit("distractor_radius_sigma", self.distractor_radius_sigma,
          {.min = 0,
           .max = 2,
           .source = "R34, calibrated",
           .meaning = "spread of the logarithm of distractors' radii: the tail of large ones"});
    visit("distractor_weight", self.distractor_weight,
          {.min = 0, .max = 10, .source = "R34, calibrated", .meaning = "weight of a visible distractor"});
    visit("distractor_tilt_deg", self.distractor_tilt_deg,
          {.unit = "deg",
           .min = 0,
           .max = 90,
           .source = "R34, calibrated",
           .meaning =
               "steepness below the horizon at which distractors mislead half as much as straight down"});
    visit("distractor_tilt_width_deg", self.distractor_tilt_width_deg,
          {.unit = "deg",
           .min = 0.1,
           .max = 45,
           .source = "R34, calibrated",
           .meaning = "how gradually that sets in"});
    visit("view_noise", self.view_noise,
          {.source = "R34", .meaning = "fluctuation of a view that the robot hovers over"});
    visit.Nested("full", self.full);
    visit.Nested("quantized", self.quantized);
    visit.Nested("render", self.render);
    visit.Nested("detector", self.detector);
  }
};

}  // namespace ed3r
