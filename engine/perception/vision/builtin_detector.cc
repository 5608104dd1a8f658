#include "engine/perception/vision/builtin_detector.h"

#include <vector>

#include "engine/core/check.h"
#include "engine/perception/vision/network.h"
#include "engine/perception/vision/pool.h"
#include "engine/perception/vision/resize.h"

namespace ed3r::perception {
namespace {

// As many frames of a sensing period as are looked at by default.
constexpr int kBatch = 7;

class NetworkDetector final : public FrameDetector {
 public:
  NetworkDetector(std::shared_ptr<const DetectorModel> model, Arithmetic arithmetic)
      : model_(std::move(model)),
        calibration_(arithmetic == Arithmetic::kFloat ? model_->full : model_->quantized),
        networks_([model = model_, arithmetic] {
          return arithmetic == Arithmetic::kFloat ? MakeFloatNetwork(*model, kBatch)
                                                  : MakeIntegerNetwork(*model, kBatch);
        }) {}

  void Confidences(const FrameStack& frames, std::span<double> confidences) const override {
    const Topology& topology = model_->topology;
    if (frames.width_px != topology.width_px || frames.height_px != topology.height_px) {
      Confidences(Resized(frames, topology.width_px, topology.height_px), confidences);
      return;
    }
    ED3R_CHECK(confidences.size() == static_cast<std::size_t>(frames.frames), "one confidence per frame");
    std::vector<float> logits(confidences.size());
    networks_.With([&](Network& network) { network.Logits(frames.rgb, logits); });
    for (std::size_t f = 0; f < logits.size(); ++f)
      confidences[f] = Confidence(static_cast<double>(logits[f]), calibration_);
  }

 private:
  std::shared_ptr<const DetectorModel> model_;
  Calibration calibration_;
  mutable Pool<Network> networks_;
};

}  // namespace

std::shared_ptr<const FrameDetector> MakeNetworkDetector(std::shared_ptr<const DetectorModel> model,
                                                         Arithmetic arithmetic) {
  return std::make_shared<NetworkDetector>(std::move(model), arithmetic);
}

}  // namespace ed3r::perception
