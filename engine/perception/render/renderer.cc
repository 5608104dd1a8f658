#include "engine/perception/render/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/perception/render/develop.h"
#include "engine/perception/render/shade.h"

namespace ed3r::perception {
namespace {

constexpr double kSwayMemory = 0.8;   // of the camera's sway from frame to frame
constexpr double kSwayLimit = 3.0;    // standard deviations
constexpr float kMiddleGrey = 0.42f;  // radiance that the mean of a picture is exposed to

// What the draws of a timestep make of each of its frames.
struct FrameDraw {
  PlumePhase phase;
  double right = 0.0, down = 0.0;  // sway in standard deviations
  float exposure = 1.0f;
  std::uint32_t noise_key = 0;
};

std::vector<FrameDraw> DrawFrames(const SensingConfig& sensing, std::uint64_t seed, std::uint32_t scenario,
                                  std::uint32_t timestep) {
  Stream stream(seed, scenario, Purpose::kRendering, timestep);
  const double start_s = stream.Uniform(0.0, 1000.0);
  double right = stream.Normal(), down = stream.Normal(), puff = stream.Normal();
  const double fresh = std::sqrt(1.0 - kSwayMemory * kSwayMemory);
  std::vector<FrameDraw> draws(static_cast<std::size_t>(sensing.Frames()));
  for (std::size_t i = 0; i < draws.size(); ++i) {
    FrameDraw& draw = draws[i];
    draw.phase.time_s = start_s + static_cast<double>(i) / sensing.camera_fps;
    draw.phase.puff = static_cast<float>(0.06 * puff);
    draw.right = std::clamp(right, -kSwayLimit, kSwayLimit);
    draw.down = std::clamp(down, -kSwayLimit, kSwayLimit);
    draw.exposure = static_cast<float>(1.0 + 0.01 * stream.Normal());
    draw.noise_key = stream.Bits();
    right = kSwayMemory * right + fresh * stream.Normal();
    down = kSwayMemory * down + fresh * stream.Normal();
    puff = 0.5 * puff + 0.87 * stream.Normal();
  }
  return draws;
}

// Copy of the still picture with a frame's fire and smoke in it.
void Composite(const RadiancePlanes& still, const PlumeLayers& layers, const PlumeLayers::Frame& frame,
               int columns, RadiancePlanes& out) {
  const auto blend = [&](const std::vector<float>& behind, const std::vector<float>& added,
                         std::vector<float>& to) {
    for (int row = 0; row < layers.rows; ++row) {
      const std::size_t grid = static_cast<std::size_t>(layers.top + row) * columns + layers.left;
      const std::size_t layer = static_cast<std::size_t>(row) * layers.columns;
      for (int x = 0; x < layers.columns; ++x)
        to[grid + x] = behind[grid + x] * frame.through[layer + x] + added[layer + x];
    }
  };
  blend(still.red, frame.added.red, out.red);
  blend(still.green, frame.added.green, out.green);
  blend(still.blue, frame.added.blue, out.blue);
}

}  // namespace

Renderer::Renderer(std::shared_ptr<const TraceScene> scene, int site, const PerceptionConfig& perception,
                   const SensingConfig& sensing, std::uint64_t seed, std::uint32_t scenario)
    : scene_(std::move(scene)),
      site_(site),
      perception_(perception),
      sensing_(sensing),
      seed_(seed),
      scenario_(scenario),
      ambience_(DrawAmbience(perception, seed, scenario)),
      props_(DrawProps(scene_->World(), perception, seed, scenario)) {
  ED3R_CHECK(site >= -1 && site < static_cast<int>(scene_->World().Sites().size()),
             fmt::format("site {}", site));
}

SensingFrames Renderer::Sense(const robot::Pose& pose, std::uint32_t timestep) const {
  std::vector<int> numbers;
  for (int frame = 0; frame < sensing_.Frames(); frame += perception_.render.frame_step)
    numbers.push_back(frame);
  return Sense(pose, timestep, numbers, {perception_.render.width_px, perception_.render.height_px});
}

SensingFrames Renderer::Sense(const robot::Pose& pose, std::uint32_t timestep, std::span<const int> frames,
                              PictureSize size) const {
  ED3R_CHECK(size.width_px >= 16 && size.width_px <= 1920 && size.height_px >= 9 && size.height_px <= 1080,
             fmt::format("{} x {} px", size.width_px, size.height_px));
  const std::vector<FrameDraw> draws = DrawFrames(sensing_, seed_, scenario_, timestep);
  const double half_rad = 0.5 * sensing_.camera_hfov_deg * std::numbers::pi / 180.0;
  const double sway_px =
      perception_.render.jitter_deg * std::numbers::pi / 180.0 * size.width_px / (2.0 * std::tan(half_rad));
  const PixelGrid grid{size.width_px, size.height_px, static_cast<int>(std::ceil(kSwayLimit * sway_px)) + 1};

  const world::Scene& world = scene_->World();
  const world::FireSite* fire = site_ < 0 ? nullptr : &world.Sites()[static_cast<std::size_t>(site_)];
  const SensingTrace trace = scene_->Trace(pose, sensing_, grid, ambience_, props_);
  const StillPicture still = Shade(trace, world, ambience_, props_, fire);
  std::vector<PlumePhase> phases;
  for (const int frame : frames) {
    ED3R_CHECK(frame >= 0 && frame < static_cast<int>(draws.size()), fmt::format("frame {}", frame));
    phases.push_back(draws[static_cast<std::size_t>(frame)].phase);
  }
  PlumeLayers layers;
  if (fire != nullptr) layers = TracePlume(trace, *fire, world.Fire(), ambience_, still.fog, phases);

  SensingFrames out;
  out.truth = layers.truth;
  out.frames = {static_cast<int>(frames.size()), size.width_px, size.height_px, {}};
  const std::size_t frame_bytes = static_cast<std::size_t>(size.width_px) * size.height_px * 3;
  out.frames.rgb.resize(frames.size() * frame_bytes);
  const float exposure = std::clamp(kMiddleGrey / std::max(still.mean, 1e-3f), 0.35f, 3.5f);
  RadiancePlanes picture = still.radiance;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FrameDraw& draw = draws[static_cast<std::size_t>(frames[i])];
    if (layers.columns > 0) Composite(still.radiance, layers, layers.frames[i], grid.Columns(), picture);
    const Shot shot{static_cast<float>(sway_px * draw.right), static_cast<float>(sway_px * draw.down),
                    exposure * draw.exposure, static_cast<float>(perception_.render.noise), draw.noise_key};
    Develop(picture, grid, shot,
            std::span<std::uint8_t>(out.frames.rgb).subspan(i * frame_bytes, frame_bytes));
  }
  return out;
}

}  // namespace ed3r::perception
