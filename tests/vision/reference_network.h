// Plain loops that say what the two kinds of network compute, to test the fast ones against.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/perception/vision/detector_model.h"

namespace ed3r::test {

// One frame, in double precision.
double ReferenceFloatLogit(const perception::DetectorModel& model, std::span<const std::uint8_t> rgb);

// One frame, exact 64-bit integer sums; between layers as MakeIntegerNetwork's contract says.
float ReferenceIntegerLogit(const perception::DetectorModel& model, std::span<const std::uint8_t> rgb);

// `frames` frames of noise in blocks, from black to white.
std::vector<std::uint8_t> NoiseFrames(const perception::Topology& topology, int frames, std::uint64_t seed);

}  // namespace ed3r::test
