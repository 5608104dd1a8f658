// Views for training detectors: poses like those that missions take, balanced between fire and no fire in the frame.
//
// Views differ in world, site, weather and distractors (each is a scenario of its own). Every second one is sought
// where fire or smoke is in line of sight, at 10 .. 350 m; the others where none is: a third of them turned anywhere, a
// third towards a distractor, a third as towards a fire. What a frame is labelled is decided by its pixels, not by this
// search.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/config/config.h"
#include "engine/perception/render/renderer.h"
#include "engine/perception/render/trace.h"
#include "engine/robot/motion.h"

namespace ed3r::perception {

struct ViewPlan {
  int world = 0;  // index into the scenes
  int site = 0;
  robot::Pose pose;
};

// View `number` of the set of this seed: a pure function of its arguments.
ViewPlan PlanView(std::span<const std::shared_ptr<const TraceScene>> scenes, const Config& config,
                  std::uint64_t seed, std::uint32_t number);

// Kinds of distractors of which some part lies in the frame and in line of sight, in the order of PropKind,
// separated by ';'.
std::string PropsInView(const Renderer& renderer, const world::Scene& scene, const robot::Pose& pose,
                        const SensingConfig& sensing);

}  // namespace ed3r::perception
