// Fixed pieces of work whose instructions scripts/instructions counts, each done once before so that nothing is counted
// that happens only at the first time.
#include <valgrind/callgrind.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/mission/mission.h"
#include "engine/rfnn/trainer.h"
#include "tests/mission/small_world.h"

namespace ed3r::instructions {
namespace {

constexpr std::uint64_t kSeed = 5;

template <class Work>
void Count(const char* name, const Work& work) {
  work();
  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  work();
  CALLGRIND_DUMP_STATS_AT(name);
  CALLGRIND_STOP_INSTRUMENTATION;
}

// Physics, controller, LiDARs, perception, radio and accounts; a random walk asks no network.
void CountMission() {
  const world::Scene scene(mission::FlatParts());
  Config config;
  config.mission.strategy = "random";
  mission::MissionTask task{.scene = scene, .config = config};
  task.seed = kSeed;
  task.scenario = 3;
  Count("mission", [&] { ED3R_CHECK(mission::FlyMission(task).timesteps > 0, "it flies"); });
}

rfnn::DataSet RandomRows(int missions, int rows_each) {
  rfnn::DataSet data(rfnn::kRcNetwork.inputs());
  Stream stream(kSeed, 0, Purpose::kScenario);
  std::vector<float> row(static_cast<std::size_t>(rfnn::kRcNetwork.inputs()));
  for (int m = 0; m < missions; ++m)
    for (int i = 0; i < rows_each; ++i) {
      for (float& value : row) value = static_cast<float>(stream.Uniform(-1, 1));
      data.Add(row, row[0] + row[1] * row[2], m);
    }
  return data;
}

// An epoch of 12 steps and its score; the RC's choice among 1000 candidates by what comes out.
void CountTrainingAndDecision() {
  const rfnn::DataSet data = RandomRows(60, 30);
  rfnn::TrainJob job;
  job.design = rfnn::kRcNetwork;
  job.data = &data;
  job.config.epochs = 1;
  job.code_version = "counted";
  std::optional<rfnn::Model> model;
  Count("training epoch", [&] { model = rfnn::Train(job); });

  constexpr std::size_t kCandidates = 1000;
  Stream stream(kSeed, 1, Purpose::kScenario);
  const std::vector<double> state(static_cast<std::size_t>(rfnn::kRcNetwork.states), 0.25);
  std::vector<float> actions(kCandidates * static_cast<std::size_t>(rfnn::kRcNetwork.actions()));
  for (float& value : actions) value = static_cast<float>(stream.Uniform(-1, 1));
  rfnn::Model::Workspace workspace;
  Count("decision", [&] { ED3R_CHECK(model->Best(state, actions, workspace).index >= 0, "a choice"); });
}

}  // namespace
}  // namespace ed3r::instructions

int main() {
  ed3r::instructions::CountMission();
  ed3r::instructions::CountTrainingAndDecision();
  return 0;
}
