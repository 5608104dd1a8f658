// Processor time of the detectors' networks on one core: the 7 frames of a sensing period that are looked at, of the compact
// networks, one frame of the full-size one; single precision against 8-bit integers, medians, interleaved so that a busy
// machine slows both. What flies is Full (192 x 108) in single precision and Quantized (96 x 54) in integers.
//
//   vision_bench [ROUNDS [BATCH...]]
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "engine/perception/vision/network.h"

namespace ed3r::perception {
namespace {

double RunMs(Network& network, const std::vector<std::uint8_t>& rgb, std::vector<float>& logits) {
  const std::clock_t start = std::clock();  // processor time, which other programs disturb less
  network.Logits(rgb, logits);
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void Compare(const Topology& topology, int frames, int batch, int rounds) {
  const DetectorModel model = RandomDetectorModel(topology, 1);
  std::vector<std::uint8_t> rgb(static_cast<std::size_t>(Layers(topology).front().Inputs() * frames));
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = static_cast<std::uint8_t>((i * 2654435761u) >> 24);
  std::vector<float> logits(static_cast<std::size_t>(frames));
  const std::unique_ptr<Network> full = MakeFloatNetwork(model, batch),
                                 quantized = MakeIntegerNetwork(model, batch);
  std::vector<double> full_ms, quantized_ms;
  for (int r = 0; r < rounds; ++r) {
    full_ms.push_back(RunMs(*full, rgb, logits));
    quantized_ms.push_back(RunMs(*quantized, rgb, logits));
  }
  const double gflop = 1e-9 * static_cast<double>(FlopCount(topology)) * frames;
  const double f = Median(full_ms), q = Median(quantized_ms);
  fmt::print(
      "{:<18} {:>2} frames, batch {:>2}: f32 {:>7.2f} ms ({:>5.1f} GFLOP/s)   int8 {:>7.2f} ms   f32/int8 "
      "{:.2f}\n",
      topology.name, frames, batch, f, gflop / f * 1e3, q, f / q);
}

}  // namespace
}  // namespace ed3r::perception

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 50;
  std::vector<int> batches;
  for (int i = 2; i < argc; ++i) batches.push_back(std::atoi(argv[i]));
  if (batches.empty()) batches = {7};
  for (const int batch : batches) {
    ed3r::perception::Compare(ed3r::perception::CompactFullTopology(), 7, batch, rounds);
    ed3r::perception::Compare(ed3r::perception::CompactQuantizedTopology(), 7, batch, rounds);
  }
  ed3r::perception::Compare(ed3r::perception::FullSizeTopology(), 1, 1, std::max(1, rounds / 20));
}
