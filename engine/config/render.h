// What a user may set of the rendered frames (engine/perception/render).
#pragma once

#include "engine/config/field.h"

namespace ed3r {

struct RenderConfig {
  int width_px = 192;
  int height_px = 108;
  int frame_step = 5;
  double noise = 2.0;
  double jitter_deg = 0.2;
  double weather = 1.0;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    constexpr std::string_view kSource = "none in the paper";
    visit("width_px", self.width_px,
          {.unit = "px",
           .min = 16,
           .max = 1920,
           .source = kSource,
           .meaning = "width of the frames that the networks look at"});
    visit("height_px", self.height_px,
          {.unit = "px",
           .min = 9,
           .max = 1080,
           .source = kSource,
           .meaning = "height of the frames that the networks look at"});
    visit(
        "frame_step", self.frame_step,
        {.unit = "frame",
         .min = 1,
         .max = 100,
         .source = kSource,
         .meaning = "one in so many of a sensing period's frames is rendered and looked at; the cost of all "
                    "is counted"});
    visit("noise", self.noise,
          {.unit = "1/255",
           .min = 0,
           .max = 40,
           .source = kSource,
           .meaning = "standard deviation of the sensor noise in an 8-bit channel"});
    visit("jitter_deg", self.jitter_deg,
          {.unit = "deg",
           .min = 0,
           .max = 1,
           .source = kSource,
           .meaning = "standard deviation of the hovering camera's pitch and yaw"});
    visit(
        "weather", self.weather,
        {.min = 0,
         .max = 1,
         .source = kSource,
         .meaning = "how far sun, clouds, haze and season differ between missions; 0: a clear summer noon"});
  }
};

}  // namespace ed3r
