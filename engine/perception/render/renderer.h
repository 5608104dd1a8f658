// The pixel tier's eyes: the camera frames of a sensing period, and the truth about them.
//
// The view is traced and lit once per sensing period; its frames differ by flicker of fire and smoke, sway of the
// hovering camera and sensor noise. Everything is drawn by (seed, scenario, timestep), so that arms which fly the
// same scenario meet the same weather, distractors, flicker and noise; frame i is the same whatever other frames
// are asked for.
//
// Frame of reference as in the scene; pictures as in FrameStack. The pixels are square: a picture shows the camera's
// horizontal field of view, its height follows from its shape.
// Threads: const members may be called from any thread; the scene must outlive the renderer.
// Determinism: the bytes depend on the arguments alone, not on thread or call order.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/config/perception.h"
#include "engine/config/robot.h"
#include "engine/perception/image.h"
#include "engine/perception/render/plume.h"
#include "engine/perception/render/trace.h"
#include "engine/robot/motion.h"
#include "engine/world/scene.h"

namespace ed3r::perception {

struct SensingFrames {
  FrameStack frames;
  GroundTruth truth;
};

// Pixels; 16..1920 x 9..1080.
struct PictureSize {
  int width_px = 96;
  int height_px = 54;
};

// One mission's camera.
class Renderer {
 public:
  // site: the fire that burns; -1 for none. The TraceScene may be shared by missions on one scene.
  Renderer(std::shared_ptr<const TraceScene> scene, int site, const PerceptionConfig& perception,
           const SensingConfig& sensing, std::uint64_t seed, std::uint32_t scenario);

  // Of a timestep's sensing period the frames 0, frame_step, 2 frame_step ..., in the size of perception.render.
  SensingFrames Sense(const robot::Pose& pose, std::uint32_t timestep) const;

  // Some frames of it (numbers from 0), in any size. Throws InternalError for a size or number out of range.
  SensingFrames Sense(const robot::Pose& pose, std::uint32_t timestep, std::span<const int> frames,
                      PictureSize size) const;

  const Ambience& Weather() const { return ambience_; }
  const std::vector<Prop>& Props() const { return props_; }

 private:
  std::shared_ptr<const TraceScene> scene_;
  int site_;
  PerceptionConfig perception_;
  SensingConfig sensing_;
  std::uint64_t seed_;
  std::uint32_t scenario_;
  Ambience ambience_;
  std::vector<Prop> props_;
};

}  // namespace ed3r::perception
