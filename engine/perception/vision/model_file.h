// Detector networks on disk and in the program: one sealed file with architecture, weights, integer scales,
// calibration and provenance. scripts/train_detector.py writes the same format.
//
// Payload, little-endian (engine/core/files/sealed_file.h: u32, f64, text and lists with a u64 count in front):
//   text name | u32 width, height, colours | f64 LeakyReLU slope
//   u32 convolutions, each u32 channels, kernel, stride | u32 fully connected layers, each u32 outputs
//   u32 pixel offset | f64 pixel scale | for each layer: f32 list weights, f32 list biases
//   u32 quantised layers (0 or all), each f64 input scale, u32 zero point, u32 largest input, f64 weight scale
//   f64 temperature and offset of Full, then of Quantized | text provenance (JSON)
#pragma once

#include <string>
#include <string_view>

#include "engine/perception/vision/detector_model.h"

namespace ed3r::perception {

// Atomic. Throws UserError where the disk refuses.
void WriteDetectorModel(const std::string& path, const DetectorModel& model);

// Throws UserError, one line that starts with the path, for a file that is missing, of another kind, damaged, or with
// sizes or scales that cannot be used.
DetectorModel ReadDetectorModel(const std::string& path);

// The same for a file in memory; `name` stands in messages.
DetectorModel ParseDetectorModel(std::string_view bytes, const std::string& name);

// The files compiled into the program (weights/full.ed3rnet, weights/quantized.ed3rnet).
std::string_view BuiltinFullBytes();
std::string_view BuiltinQuantizedBytes();

}  // namespace ed3r::perception
