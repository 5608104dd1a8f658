#include "engine/schedule/training_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "engine/core/check.h"
#include "engine/core/progress.h"
#include "engine/core/version.h"
#include "engine/mission/samples.h"
#include "engine/rfnn/model_file.h"
#include "engine/rfnn/train_all.h"
#include "engine/schedule/warmup.h"
#include "engine/store/reader.h"
#include "engine/sweep/setting.h"

namespace ed3r::schedule {
namespace {

// Names of the agents in the store.
constexpr char kRcAgent[] = "rc";
constexpr char kRobotAgent[] = "robot";

// What is trained for an arm.
bool NeedsRc(const Config& config) {
  return agents::FindStrategy(config.mission.strategy).motion.asks_network &&
         config.networks.rc == sweep::FileNotNeeded("networks.rc");
}
bool NeedsRobot(const Config& config) {
  return agents::FindStrategy(config.mission.strategy).execution.asks_network &&
         config.networks.robot == sweep::FileNotNeeded("networks.robot");
}

// All that the rows of a data set depend on.
std::string RewardKey(const WarmupPart& part, const AgentsConfig& agents) {
  return fmt::format("{} {} {} {} {} {} {} {} {} {}", part.stage, part.arm, part.first, part.end,
                     agents.eta_min, agents.lambda1, agents.lambda2, agents.mu1, agents.mu2,
                     agents.energy_scale_j);
}

struct Samples {
  rfnn::DataSet rc{rfnn::kRcNetwork.inputs()};
  rfnn::DataSet robot{rfnn::kRobotNetwork.inputs()};
};

Samples ReadSamples(store::ResultReader& reader, const sweep::SweepPlan& plan, const WarmupPart& part,
                    const AgentsConfig& agents) {
  const sweep::Arm& flown =
      plan.stages[static_cast<std::size_t>(part.stage)].arms[static_cast<std::size_t>(part.arm)];
  // By its name: where the plan is about to grow, the arm has another number there.
  const int arm = reader.ArmNamed(part.stage, flown.name);
  Samples samples;
  reader.NeedTimesteps(part.stage);
  std::int64_t rows = 0;
  reader.ForEachMission(part.stage, arm, part.first, part.end, store::Steps::kSkip,
                        [&](const store::StoredMission& mission) { rows += mission.record.timesteps; });
  samples.rc.Reserve(static_cast<std::size_t>(rows));
  samples.robot.Reserve(static_cast<std::size_t>(rows));
  reader.ForEachMission(part.stage, arm, part.first, part.end, store::Steps::kLoad,
                        [&](const store::StoredMission& mission) {
                          mission::AppendSamples(mission.record, mission.id.mission, flown.config, agents,
                                                 samples.rc, samples.robot);
                        });
  return samples;
}

// Calls `visit` with stage, arm and warm-up of every arm that learns in this training stage; "" in any.
template <class Visit>
void ForEachLearner(const sweep::SweepPlan& plan, const std::string& training, const Visit& visit) {
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    const sweep::Stage& stage = plan.stages[s];
    for (std::size_t a = 0; a < stage.arms.size(); ++a) {
      if (stage.kind != sweep::StageKind::kFly || !NeedsTraining(stage.arms[a].config)) continue;
      const WarmupChoice choice = ChooseWarmup(plan, stage, stage.arms[a]);
      if (!training.empty() && !choice.trainings.contains(training)) continue;
      visit(static_cast<int>(s), static_cast<int>(a), choice);
    }
  }
}

}  // namespace

agents::Networks NetworkShelf::For(const sweep::RunId& id, int places) const {
  const int seed = SeedIndex(id, places);
  if (seed < 0) return {};
  const Pair& pair = by_arm_.at({id.stage, id.arm})[static_cast<std::size_t>(seed)];
  return {pair.rc.get(), pair.robot.get()};
}

int NetworkOfMission(int mission, int places, int networks) {
  return (mission % places + mission / places) % networks;
}

int NetworkShelf::SeedIndex(const sweep::RunId& id, int places) const {
  const auto found = by_arm_.find({id.stage, id.arm});
  if (found == by_arm_.end()) return -1;
  return NetworkOfMission(id.mission, places, static_cast<int>(found->second.size()));
}

store::FlownNetworks NetworkShelf::Flown() const {
  store::FlownNetworks flown;
  std::map<const rfnn::Model*, std::string> hashes;
  for (const ShelvedNetwork& network : all_) {
    const std::string& hash = hashes[network.model.get()] = rfnn::NetworkHash(*network.model);
    flown.files[hash] = {network.name, rfnn::ModelBytes(*network.model)};
  }
  for (const auto& [arm, pairs] : by_arm_)
    for (std::size_t seed = 0; seed < pairs.size(); ++seed)
      for (const auto& [agent, model] : {std::pair{std::string(kRcAgent), pairs[seed].rc},
                                         std::pair{std::string(kRobotAgent), pairs[seed].robot}})
        if (model != nullptr)
          flown.uses.push_back(
              {arm.first, arm.second, static_cast<int>(seed), agent, hashes.at(model.get())});
  return flown;
}

std::unique_ptr<NetworkShelf> NetworkShelf::From(const store::FlownNetworks& flown, const std::string& dir) {
  auto shelf = std::make_unique<NetworkShelf>();
  std::map<std::string, std::shared_ptr<const rfnn::Model>> models;
  for (const store::NetworkUse& use : flown.uses) {
    const store::NetworkFile& file = flown.files.at(use.sha256);
    const std::string name = fmt::format("{}: network '{}'", dir, file.name);
    std::shared_ptr<const rfnn::Model>& model = models[use.sha256];
    if (!model) {
      model = std::make_shared<const rfnn::Model>(
          rfnn::OpenModel(file.model, name, use.agent == kRcAgent ? rfnn::kRcNetwork : rfnn::kRobotNetwork));
      if (rfnn::NetworkHash(*model) != use.sha256)
        throw UserError(fmt::format("{}: is not the one that flew", name));
      shelf->all_.push_back({file.name, "", model});
    }
    std::vector<Pair>& pairs = shelf->by_arm_[{use.stage, use.arm}];
    // Seeds are counted from 0 without gaps, in order.
    if (use.seed == static_cast<int>(pairs.size())) pairs.emplace_back();
    if (use.seed < 0 || use.seed + 1 != static_cast<int>(pairs.size()) ||
        (use.agent != kRcAgent && use.agent != kRobotAgent))
      throw UserError(fmt::format("{}: has no place among the networks that flew", name));
    (use.agent == kRcAgent ? pairs.back().rc : pairs.back().robot) = model;
  }
  return shelf;
}

void NetworkShelf::Take(NetworkShelf&& other) {
  // A network that both have is one: the other's copy of it goes.
  std::map<const rfnn::Model*, std::shared_ptr<const rfnn::Model>> here;
  for (ShelvedNetwork& network : other.all_) {
    const auto known = std::find_if(all_.begin(), all_.end(), [&](const ShelvedNetwork& mine) {
      return mine.name == network.name && mine.file == network.file;
    });
    here[network.model.get()] = known == all_.end() ? network.model : known->model;
    if (known == all_.end()) all_.push_back(std::move(network));
  }
  for (auto& [arm, pairs] : other.by_arm_) {
    for (Pair& pair : pairs)
      for (std::shared_ptr<const rfnn::Model>* model : {&pair.rc, &pair.robot})
        if (*model) *model = here.at(model->get());
    by_arm_[arm] = std::move(pairs);
  }
}

bool NeedsTraining(const Config& config) { return NeedsRc(config) || NeedsRobot(config); }

bool NeedsNetworks(const sweep::SweepPlan& plan) {
  return std::any_of(plan.stages.begin(), plan.stages.end(), [](const sweep::Stage& stage) {
    return std::any_of(stage.arms.begin(), stage.arms.end(),
                       [](const sweep::Arm& arm) { return NeedsTraining(arm.config); });
  });
}

void CheckTraining(const sweep::SweepPlan& plan) {
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms)
      if (stage.kind == sweep::StageKind::kFly && NeedsTraining(arm.config)) CheckWarmup(plan, stage, arm);
}

// Collects what is to be trained, each network once, and hands the results out.
class TrainingStage {
 public:
  TrainingStage(const sweep::SweepPlan& plan, const TrainingOptions& options)
      : plan_(plan), options_(options) {
    Collect();
  }

  std::size_t Jobs() const { return jobs_.size(); }
  std::vector<bool> InCache();
  std::unique_ptr<NetworkShelf> Run();
  std::vector<ShelvedNetwork> RunPart(const Shard& part);

 private:
  struct ArmNeed {
    int stage, arm;
    std::vector<std::size_t> rc_jobs, robot_jobs;  // by training seed
  };
  // The samples of one part of a warm-up and one reward, empty until something is trained on them.
  struct Lesson {
    WarmupPart part;
    AgentsConfig agents;
    Samples samples;
  };
  void Collect();
  std::size_t AddJob(const rfnn::NetworkDesign& design, const rfnn::DataSet& data, const sweep::Arm& arm,
                     std::string_view source, int seed);
  const Samples& SamplesFor(const WarmupPart& part, const AgentsConfig& agents);
  void ReadLessons(const std::vector<rfnn::TrainJob>& jobs);
  // Null where it was stopped.
  std::vector<std::shared_ptr<const rfnn::Model>> Train(const std::vector<rfnn::TrainJob>& jobs,
                                                        const std::vector<std::string>& names);

  const sweep::SweepPlan& plan_;
  const TrainingOptions& options_;
  std::map<std::string, Lesson> lessons_;
  std::vector<rfnn::TrainJob> jobs_;
  std::vector<std::string> names_;
  std::vector<ArmNeed> needs_;
};

const Samples& TrainingStage::SamplesFor(const WarmupPart& part, const AgentsConfig& agents) {
  return lessons_.try_emplace(RewardKey(part, agents), Lesson{part, agents, {}}).first->second.samples;
}

void TrainingStage::ReadLessons(const std::vector<rfnn::TrainJob>& jobs) {
  for (auto& [key, lesson] : lessons_) {
    const bool needed = std::any_of(jobs.begin(), jobs.end(), [&lesson = lesson](const rfnn::TrainJob& job) {
      return job.data == &lesson.samples.rc || job.data == &lesson.samples.robot;
    });
    if (!needed) continue;
    store::ResultReader reader(options_.run_dir);
    lesson.samples = ReadSamples(reader, plan_, lesson.part, lesson.agents);
  }
}

std::size_t TrainingStage::AddJob(const rfnn::NetworkDesign& design, const rfnn::DataSet& data,
                                  const sweep::Arm& arm, std::string_view source, int seed) {
  rfnn::TrainJob job{
      .design = design,
      .data = &data,
      .config = arm.config.training,
      .seed = static_cast<std::uint64_t>(arm.config.training.seed + seed),
      .code_version = ThisCode().training,
      .notes = {{"warm-up", std::string(source)}, {"eta_min", fmt::format("{}", arm.config.agents.eta_min)}}};
  std::string name = fmt::format("{} from {}{}, eta_min {}, seed {}", design.name, source,
                                 arm.variant.empty() ? "" : fmt::format(" of {}", arm.variant),
                                 arm.config.agents.eta_min, job.seed);
  for (std::size_t i = 0; i < jobs_.size(); ++i)  // keys of the jobs alone: no sample is read yet
    if (names_[i] == name && jobs_[i].data == job.data &&
        rfnn::TrainingKey(jobs_[i]) == rfnn::TrainingKey(job))
      return i;
  jobs_.push_back(std::move(job));
  names_.push_back(std::move(name));
  return jobs_.size() - 1;
}

void TrainingStage::Collect() {
  ForEachLearner(plan_, options_.stage, [&](int s, int a, const WarmupChoice& choice) {
    const sweep::Arm& arm = plan_.stages[static_cast<std::size_t>(s)].arms[static_cast<std::size_t>(a)];
    const std::string_view source = agents::FindStrategy(arm.config.mission.strategy).networks;
    ArmNeed need{s, a, {}, {}};
    for (int seed = 0; seed < arm.config.training.seeds; ++seed) {
      const Samples& samples =
          SamplesFor(PartOf(plan_, choice, arm.config.training, seed), arm.config.agents);
      if (NeedsRc(arm.config))
        need.rc_jobs.push_back(AddJob(rfnn::kRcNetwork, samples.rc, arm, source, seed));
      if (NeedsRobot(arm.config))
        need.robot_jobs.push_back(AddJob(rfnn::kRobotNetwork, samples.robot, arm, source, seed));
    }
    needs_.push_back(std::move(need));
  });
}

std::vector<std::shared_ptr<const rfnn::Model>> TrainingStage::Train(const std::vector<rfnn::TrainJob>& jobs,
                                                                     const std::vector<std::string>& names) {
  ReadLessons(jobs);
  rfnn::TrainAllOptions train;
  train.cache = options_.cache_dir;
  train.threads = options_.threads;
  train.stop = options_.stop;
  ProgressLine line(options_.progress, options_.quiet);
  std::size_t done = 0;
  train.on_done = [&](std::size_t) { ++done; };
  train.on_epoch = [&](std::size_t job, int epoch, const rfnn::EpochLoss& loss) {
    line.Show(fmt::format("training  {}/{} networks  {}: epoch {}, validation loss {:.4f}", done, jobs.size(),
                          names[job], epoch, loss.validation));
  };
  std::vector<std::shared_ptr<const rfnn::Model>> models = rfnn::TrainAll(jobs, train);
  line.Clear();
  if (std::any_of(models.begin(), models.end(), [](const auto& model) { return model == nullptr; }))
    models.clear();
  return models;
}

std::vector<bool> TrainingStage::InCache() {
  ReadLessons(jobs_);
  std::vector<bool> found;
  for (const rfnn::TrainJob& job : jobs_)
    found.push_back(std::filesystem::exists(rfnn::CachePath(options_.cache_dir, job)));
  return found;
}

std::unique_ptr<NetworkShelf> TrainingStage::Run() {
  const std::vector<std::shared_ptr<const rfnn::Model>> models = Train(jobs_, names_);
  if (models.empty() && !jobs_.empty()) return nullptr;
  auto shelf = std::make_unique<NetworkShelf>();
  for (std::size_t i = 0; i < jobs_.size(); ++i)
    shelf->all_.push_back({names_[i], rfnn::CachePath(options_.cache_dir, jobs_[i]), models[i]});
  for (const ArmNeed& need : needs_) {
    std::vector<NetworkShelf::Pair>& pairs = shelf->by_arm_[{need.stage, need.arm}];
    for (std::size_t seed = 0; seed < std::max(need.rc_jobs.size(), need.robot_jobs.size()); ++seed)
      pairs.push_back({need.rc_jobs.empty() ? nullptr : models[need.rc_jobs[seed]],
                       need.robot_jobs.empty() ? nullptr : models[need.robot_jobs[seed]]});
  }
  return shelf;
}

std::vector<ShelvedNetwork> TrainingStage::RunPart(const Shard& part) {
  std::vector<rfnn::TrainJob> jobs;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < jobs_.size(); ++i) {
    if (!InShard(static_cast<std::int64_t>(i), part)) continue;
    jobs.push_back(jobs_[i]);
    names.push_back(names_[i]);
  }
  const std::vector<std::shared_ptr<const rfnn::Model>> models = Train(jobs, names);
  std::vector<ShelvedNetwork> networks;
  for (std::size_t i = 0; i < models.size(); ++i)
    networks.push_back({names[i], rfnn::CachePath(options_.cache_dir, jobs[i]), models[i]});
  return networks;
}

std::unique_ptr<NetworkShelf> TrainNetworks(const sweep::SweepPlan& plan, const TrainingOptions& options) {
  return TrainingStage(plan, options).Run();
}

std::int64_t CountUntrained(const sweep::SweepPlan& plan, const std::string& training,
                            const std::vector<store::NetworkUse>& uses) {
  std::int64_t untrained = 0;
  ForEachLearner(plan, training, [&](int stage, int arm, const WarmupChoice&) {
    if (std::none_of(uses.begin(), uses.end(),
                     [&](const store::NetworkUse& use) { return use.stage == stage && use.arm == arm; }))
      ++untrained;
  });
  return untrained;
}

std::int64_t CountNetworks(const sweep::SweepPlan& plan) {
  const TrainingOptions nothing;
  return static_cast<std::int64_t>(TrainingStage(plan, nothing).Jobs());
}

std::vector<bool> NetworksInCache(const sweep::SweepPlan& plan, const TrainingOptions& options) {
  return TrainingStage(plan, options).InCache();
}

std::vector<ShelvedNetwork> TrainPart(const sweep::SweepPlan& plan, const TrainingOptions& options,
                                      const Shard& part) {
  return TrainingStage(plan, options).RunPart(part);
}

}  // namespace ed3r::schedule
