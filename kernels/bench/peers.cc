#include "kernels/bench/peers.h"

namespace ed3r::bench {

std::vector<NamedInferencePeer> InferencePeers([[maybe_unused]] std::vector<std::string>* missing) {
  std::vector<NamedInferencePeer> peers = {{"Eigen", MakeEigen}};
#ifdef ED3R_BENCH_OPENBLAS
  peers.push_back({"OpenBLAS", MakeOpenBlas});
#else
  missing->push_back("OpenBLAS");
#endif
#ifdef ED3R_BENCH_ONEDNN
  peers.push_back({"oneDNN", MakeOneDnn});
#else
  missing->push_back("oneDNN");
#endif
#ifdef ED3R_BENCH_TORCH
  peers.push_back({"libtorch", MakeTorch});
#else
  missing->push_back("libtorch");
#endif
  return peers;
}

std::vector<NamedTrainingPeer> TrainingPeers([[maybe_unused]] std::vector<std::string>* missing) {
  std::vector<NamedTrainingPeer> peers = {{"Eigen", MakeEigenTraining},
                                          {"Eigen, our dropout", MakeEigenTrainingWithOurDraws}};
#ifdef ED3R_BENCH_TORCH
  peers.push_back({"libtorch", MakeTorchTraining});
#else
  missing->push_back("libtorch");
#endif
  return peers;
}

std::vector<FlatLayer> FlatLayers(const kernels::DenseShape& shape, const float* flat) {
  std::vector<FlatLayer> layers;
  for (int l = 0; l < shape.layers; ++l) {
    const int in = shape.sizes[l], out = shape.sizes[l + 1];
    layers.push_back({flat, flat + static_cast<std::size_t>(in) * out, in, out});
    flat = layers.back().biases + out;
  }
  return layers;
}

}  // namespace ed3r::bench
