// bench_kernels [--rounds N] [rc] [robot] [train] [growth]
//
// growth, only where it is named: the RC's decision among ever more candidates.
//
// Measures the hand-written kernels at the level in use (ED3R_SIMD) against the FMA peak of the core and
// against other libraries, paired in one run on one core. "ratio" is the time over ours; results are compared
// first.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "kernels/aligned_floats.h"
#include "kernels/bench/fma_peak.h"
#include "kernels/bench/paired.h"
#include "kernels/bench/peers.h"
#include "kernels/rfnn.h"
#include "kernels/train.h"

namespace ed3r::bench {
namespace {

constexpr double kSampleSeconds = 2e-4;  // shorter than a time slice of a busy machine
// Training is thousands of steps in a row: with fewer, a sample mostly times the caches that its neighbour emptied.
constexpr double kTrainingSampleSeconds = 4e-3;
constexpr double kTolerance = 1e-4;  // of the largest value: libraries sum in other orders

std::vector<float> Normal(std::size_t n, double sigma, std::mt19937* rng) {
  std::normal_distribution<float> draw(0.0f, static_cast<float>(sigma));
  std::vector<float> values(n);
  for (float& v : values) v = draw(*rng);
  return values;
}

// Random weights that keep the activations at order one (He).
std::vector<float> RandomParameters(const kernels::DenseShape& shape, std::mt19937* rng) {
  std::vector<float> flat;
  for (int l = 0; l < shape.layers; ++l) {
    const int in = shape.sizes[l], out = shape.sizes[l + 1];
    for (float w : Normal(static_cast<std::size_t>(in) * out, std::sqrt(2.0 / in), rng)) flat.push_back(w);
    for (float b : Normal(out, 0.1, rng)) flat.push_back(b);
  }
  return flat;
}

Contender FmaPeak(kernels::SimdLevel level) {
  return {"FMA peak, this core", [level] { RunFmaPeak(level); }, RunFmaPeak(level)};
}

void CheckAgreement(const std::string& name, const std::vector<float>& ours,
                    const std::vector<float>& theirs) {
  float scale = 1e-30f, difference = 0.0f;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    scale = std::max(scale, std::abs(ours[i]));
    difference = std::max(difference, std::abs(ours[i] - theirs[i]));
  }
  if (difference <= kTolerance * scale) return;
  std::fprintf(stderr, "%s disagrees: difference %g of %g\n", name.c_str(), difference, scale);
  std::exit(1);
}

void PrintSkipped(const std::vector<std::string>& missing) {
  for (const std::string& name : missing) std::printf("  %-22s skipped: not found by CMake\n", name.c_str());
}

// One decision: n candidates, of whose inputs the first n_state are the state.
struct Case {
  const char* title;
  std::vector<int> sizes;
  int n_state, n;
};

double DecisionFlops(const kernels::DenseShape& shape, int n_state, int n) {
  double per_candidate = static_cast<double>(shape.sizes[0] - n_state) * shape.sizes[1];
  for (int l = 1; l < shape.layers; ++l)
    per_candidate += static_cast<double>(shape.sizes[l]) * shape.sizes[l + 1];
  return 2.0 * (per_candidate * n + static_cast<double>(n_state) * shape.sizes[1]);
}

void MeasureDecision(const Case& c, int rounds) {
  const kernels::SimdLevel level = kernels::ActiveSimdLevel();
  const kernels::DenseShape shape = kernels::MakeDenseShape(c.sizes.data(), static_cast<int>(c.sizes.size()));
  std::mt19937 rng(1);
  const std::vector<float> flat = RandomParameters(shape, &rng);
  kernels::AlignedFloats packed(kernels::PackedFloats(shape)), workspace(kernels::RfnnWorkspaceFloats(shape));
  kernels::PackParameters(shape, flat.data(), packed.data());
  const int n_action = shape.inputs() - c.n_state;
  const std::vector<float> state = Normal(c.n_state, 1.0, &rng), actions = Normal(c.n * n_action, 1.0, &rng);
  std::vector<float> inputs;
  for (int k = 0; k < c.n; ++k) {
    inputs.insert(inputs.end(), state.begin(), state.end());
    inputs.insert(inputs.end(), actions.begin() + k * n_action, actions.begin() + (k + 1) * n_action);
  }
  std::vector<float> values(c.n);
  const kernels::RfnnDecision decision{state.data(), c.n_state, actions.data(), c.n, values.data()};
  const kernels::DenseNet net{shape, packed.data()};
  const double flops = DecisionFlops(shape, c.n_state, c.n);

  std::vector<std::string> missing;
  std::vector<Contender> contenders;
  contenders.push_back({std::string("hand, ") + kernels::SimdLevelName(level),
                        [&] { kernels::RfnnArgmax(net, decision, workspace.data(), level); }, flops});
  contenders[0].run();
  std::vector<std::unique_ptr<InferencePeer>> peers;
  std::vector<float> theirs(c.n);
  volatile int chosen = 0;
  for (const NamedInferencePeer& named : InferencePeers(&missing)) {
    peers.push_back(named.make(shape, flat.data(), c.n));
    InferencePeer* peer = peers.back().get();
    contenders.push_back({named.name,
                          [&, peer] {
                            peer->Values(inputs.data(), theirs.data());
                            chosen = static_cast<int>(std::max_element(theirs.begin(), theirs.end()) -
                                                      theirs.begin());
                          },
                          flops});
    contenders.back().run();
    CheckAgreement(named.name, values, theirs);
  }
  contenders.push_back(FmaPeak(level));
  PrintTable(c.title, contenders, RunPaired(contenders, rounds, kSampleSeconds));
  PrintSkipped(missing);
}

// Peers learn without dropout, so that different draws do not hide a different step.
void CheckTraining(const NamedTrainingPeer& peer, const kernels::DenseShape& shape,
                   const std::vector<float>& flat, kernels::TrainOptions options,
                   const std::vector<float>& inputs, const std::vector<float>& targets,
                   const std::vector<std::uint32_t>& rows) {
  options.dropout = 0.0;
  options.learning_rate = 1e-3;  // large enough for the losses to move
  kernels::DenseTrainer ours(shape, flat.data(), options);
  const std::unique_ptr<TrainingPeer> theirs = peer.make(shape, flat.data(), options);
  std::vector<float> our_losses, their_losses;
  const int n = static_cast<int>(rows.size());
  for (int step = 0; step < 10; ++step) {
    our_losses.push_back(static_cast<float>(ours.Step(inputs.data(), targets.data(), rows.data(), n)));
    their_losses.push_back(static_cast<float>(theirs->Step(inputs.data(), targets.data(), rows.data(), n)));
  }
  CheckAgreement(peer.name, our_losses, their_losses);
}

void MeasureTraining(int rounds) {
  constexpr int kBatch = 128, kSamples = 4096;
  const int sizes[] = {13, 128, 64, 64, 32, 1};
  const kernels::DenseShape shape = kernels::MakeDenseShape(sizes, 6);
  std::mt19937 rng(2);
  const std::vector<float> flat = RandomParameters(shape, &rng);
  const std::vector<float> inputs = Normal(kSamples * 13, 1.0, &rng), targets = Normal(kSamples, 1.0, &rng);
  std::vector<std::uint32_t> rows(kBatch);
  for (std::uint32_t& r : rows) r = rng() % kSamples;
  double flops = 0;  // forward, weight gradient, and input gradient but for the first layer
  for (int l = 0; l < shape.layers; ++l) flops += 2.0 * kBatch * (l ? 3 : 2) * sizes[l] * sizes[l + 1];

  const kernels::TrainOptions options;
  kernels::DenseTrainer ours(shape, flat.data(), options);
  std::vector<Contender> contenders;
  contenders.push_back({std::string("hand, ") + kernels::SimdLevelName(options.level),
                        [&] { ours.Step(inputs.data(), targets.data(), rows.data(), kBatch); }, flops});
  std::vector<std::string> missing;
  std::vector<std::unique_ptr<TrainingPeer>> peers;
  for (const NamedTrainingPeer& named : TrainingPeers(&missing)) {
    CheckTraining(named, shape, flat, options, inputs, targets, rows);
    peers.push_back(named.make(shape, flat.data(), options));
    TrainingPeer* peer = peers.back().get();
    contenders.push_back(
        {named.name, [&, peer] { peer->Step(inputs.data(), targets.data(), rows.data(), kBatch); }, flops});
  }
  contenders.push_back(FmaPeak(options.level));
  PrintTable("Training step: 13-128-64-64-32-1, batch 128, dropout 0.1, Adam", contenders,
             RunPaired(contenders, rounds, kTrainingSampleSeconds));
  PrintSkipped(missing);
}

void MeasureGrowth(int rounds) {
  const kernels::SimdLevel level = kernels::ActiveSimdLevel();
  const int sizes[] = {13, 128, 64, 64, 32, 1}, states = 8;
  const kernels::DenseShape shape = kernels::MakeDenseShape(sizes, 6);
  std::mt19937 rng(3);
  const std::vector<float> flat = RandomParameters(shape, &rng);
  kernels::AlignedFloats packed(kernels::PackedFloats(shape)), workspace(kernels::RfnnWorkspaceFloats(shape));
  kernels::PackParameters(shape, flat.data(), packed.data());
  const kernels::DenseNet net{shape, packed.data()};
  std::printf("\nRC decision among ever more candidates\n");
  for (const int n : {100, 316, 1000, 3162, 10000, 31623, 100000}) {
    const std::vector<float> state = Normal(states, 1.0, &rng),
                             actions = Normal(n * (shape.inputs() - states), 1.0, &rng);
    const kernels::RfnnDecision decision{state.data(), states, actions.data(), n};
    const std::vector<Contender> contenders = {
        {"hand", [&] { kernels::RfnnArgmax(net, decision, workspace.data(), level); },
         DecisionFlops(shape, states, n)},
        FmaPeak(level)};
    const Timing timing = RunPaired(contenders, rounds, kSampleSeconds).front();
    std::printf("  %6d candidates %10.2f us %8.2f ns each %8.2f of peak\n", n, timing.us, 1e3 * timing.us / n,
                timing.of_peak);
  }
}

int Main(int argc, char** argv) {
  int rounds = 201;
  std::vector<std::string> wanted;
  for (int a = 1; a < argc; ++a) {
    if (std::strcmp(argv[a], "--rounds") == 0 && a + 1 < argc)
      rounds = std::max(1, std::atoi(argv[++a]));
    else
      wanted.push_back(argv[a]);
  }
  const auto is_wanted = [&](const char* name) {
    return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
  };
  PinToThisCore();
  std::printf("level %s, one core, medians of %d paired rounds; ratio = time / hand-written time\n",
              kernels::SimdLevelName(kernels::ActiveSimdLevel()), rounds);
  if (is_wanted("rc"))
    MeasureDecision({"RC decision: 13-128-64-64-32-1, 1000 candidates", {13, 128, 64, 64, 32, 1}, 8, 1000},
                    rounds);
  if (is_wanted("robot"))
    MeasureDecision({"Robot decision: 11-128-64-32-1, 3 actions", {11, 128, 64, 32, 1}, 9, 3}, rounds);
  if (is_wanted("train")) MeasureTraining(rounds);
  if (!wanted.empty() && is_wanted("growth")) MeasureGrowth(rounds);
  return 0;
}

}  // namespace
}  // namespace ed3r::bench

int main(int argc, char** argv) {
  try {
    return ed3r::bench::Main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
