// Measures trainings and decisions on a synthetic warm-up of the paper's size (2040 missions, 114k rows).
//
//   rfnn_bench decide              one decision: Model::Best against the bare kernel, medians
//   rfnn_bench train NET RATE EPOCHS [MISSIONS [PATIENCE]]
//                                  one training of 'rc' or 'robot': time per epoch, loss every tenth of the
//                                  way, R2 of the parts, permutation importance of the inputs
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "engine/core/random.h"
#include "engine/rfnn/bench/synthetic_warm_up.h"
#include "engine/rfnn/score.h"
#include "engine/rfnn/trainer.h"
#include "kernels/rfnn.h"

namespace ed3r::rfnn {
namespace {

using Clock = std::chrono::steady_clock;

double Seconds(Clock::time_point since) {
  return std::chrono::duration<double>(Clock::now() - since).count();
}

// Of this process: what a training would take on an idle core.
double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Median of the time of one call.
template <class Call>
double MedianUs(int rounds, int calls, Call call) {
  std::vector<double> times;
  for (int r = 0; r < rounds; ++r) {
    const auto start = Clock::now();
    for (int i = 0; i < calls; ++i) call();
    times.push_back(1e6 * Seconds(start) / calls);
  }
  std::nth_element(times.begin(), times.begin() + rounds / 2, times.end());
  return times[static_cast<std::size_t>(rounds / 2)];
}

ModelData DrawnModel(const NetworkDesign& design) {
  Stream stream(1, 0, Purpose::kTraining);
  ModelData data;
  for (std::size_t i = kernels::ParameterCount(ShapeOf(design)); i > 0; --i)
    data.weights.push_back(static_cast<float>(0.1 * stream.Normal()));
  data.scaling.input_mean.assign(static_cast<std::size_t>(design.inputs()), 3.0);
  data.scaling.input_sd.assign(static_cast<std::size_t>(design.inputs()), 2.0);
  return data;
}

void Decide(const NetworkDesign& design, int n, int calls) {
  const Model model(design, DrawnModel(design));
  Stream stream(2, 0, Purpose::kCandidates);
  std::vector<double> state;
  std::vector<float> float_state, actions;
  for (int i = 0; i < design.states; ++i) state.push_back(stream.Uniform(-1, 7));
  float_state.assign(state.begin(), state.end());
  for (int i = 0; i < n * design.actions(); ++i) actions.push_back(static_cast<float>(stream.Uniform(-1, 7)));

  const kernels::DenseShape shape = ShapeOf(design);
  kernels::AlignedFloats packed(kernels::PackedFloats(shape)), scratch(kernels::RfnnWorkspaceFloats(shape));
  kernels::PackParameters(shape, model.data().weights.data(), packed.data());
  kernels::RfnnDecision bare;
  bare.state = float_state.data();
  bare.n_state = design.states;
  bare.actions = actions.data();
  bare.n = n;
  Model::Workspace workspace;
  double sink = 0.0;
  const double kernel_us = MedianUs(41, calls, [&] {
    sink += kernels::RfnnArgmax({shape, packed.data()}, bare, scratch.data()).value;
  });
  const double model_us = MedianUs(41, calls, [&] { sink += model.Best(state, actions, workspace).reward; });
  fmt::print("{:5} {:4} actions  {}  kernel {:8.3f} us  Model::Best {:8.3f} us  ({:+.1f} %) [{:.0f}]\n",
             design.name, n, kernels::SimdLevelName(kernels::ActiveSimdLevel()), kernel_us, model_us,
             100.0 * (model_us / kernel_us - 1.0), sink);
}

void PrintScore(const char* part, const FitScore& s) {
  fmt::print("  {:10} {:6} rows {:5} missions  mse {:.5f}  R2 {:.4f}  MAE {:.4f}  RMSE {:.4f}\n", part,
             s.rows, s.missions, s.mse, s.r2, s.mae, s.rmse);
}

void TrainOne(const NetworkDesign& design, const DataSet& data, double rate, int epochs, int patience) {
  TrainJob job;
  job.design = design;
  job.data = &data;
  job.config.learning_rate = rate;
  job.config.epochs = epochs;
  job.config.patience = patience;
  job.seed = 1;
  job.code_version = "bench";
  TrainControl control;
  const auto start = Clock::now();
  const double cpu_start = CpuSeconds();
  control.on_epoch = [&](int epoch, const EpochLoss& loss) {
    if (epoch == 1 || epoch % std::max(1, epochs / 10) == 0)
      fmt::print("  epoch {:5}  train {:.5f}  validation {:.5f}  {:.1f} s\n", epoch, loss.train,
                 loss.validation, Seconds(start));
  };
  const std::optional<Model> model = Train(job, control);
  const double cpu = CpuSeconds() - cpu_start;
  const TrainingReport& report = model->data().report;
  fmt::print("{} network, rate {}, {}: {} epochs ({}), best {}, {:.1f} s, CPU {:.1f} s, {:.1f} ms an epoch\n",
             design.name, rate, kernels::SimdLevelName(kernels::ActiveSimdLevel()), report.curve.size(),
             report.stopped_early ? "patience" : "all", report.best_epoch, Seconds(start), cpu,
             1e3 * cpu / static_cast<double>(report.curve.size()));
  PrintScore("train", report.train);
  PrintScore("validation", report.validation);
  PrintScore("test", report.test);
  const Split split = MakeSplit(data.missions, static_cast<std::uint64_t>(job.config.split_seed));
  const std::vector<double> importance = PermutationImportance(*model, data, split.validation, 1);
  for (std::size_t i = 0; i < importance.size(); ++i)
    fmt::print("  {:18} {:+.4f}\n", design.features[i], importance[i]);
}

int Main(std::vector<std::string> args) {
  if (args.size() == 1 && args[0] == "decide") {
    Decide(kRcNetwork, 1000, 20);
    Decide(kRobotNetwork, 3, 5000);
    return 0;
  }
  if (args.size() >= 4 && args[0] == "train" && (args[1] == "rc" || args[1] == "robot")) {
    const int missions = args.size() > 4 ? std::atoi(args[4].c_str()) : 2040;
    const int patience = args.size() > 5 ? std::atoi(args[5].c_str()) : 10;
    const SyntheticWarmUp log = MakeSyntheticWarmUp(missions, 56, 1);
    const bool rc = args[1] == "rc";
    TrainOne(rc ? kRcNetwork : kRobotNetwork, rc ? log.rc : log.robot, std::atof(args[2].c_str()),
             std::atoi(args[3].c_str()), patience);
    return 0;
  }
  fmt::print(stderr, "usage: rfnn_bench decide | train rc|robot RATE EPOCHS [MISSIONS [PATIENCE]]\n");
  return 2;
}

}  // namespace
}  // namespace ed3r::rfnn

int main(int argc, char** argv) { return ed3r::rfnn::Main({argv + 1, argv + argc}); }
