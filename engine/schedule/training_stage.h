// A training stage: the networks that later arms of a plan ask for, trained on the plan's own warm-up (R18).
//
// Which networks there are follows from the arms: one RC network per warm-up strategy, reward and training seed, and
// a robot network where the robot has a choice. Arms that need the same network share it; so do sweeps, through the
// cache. Networks of one kind learn from the same missions, or each from its own (warmup.h): with its own, what differs
// between them holds the luck of the warm-up beside that of training.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/agents/context.h"
#include "engine/rfnn/trainer.h"
#include "engine/schedule/todo.h"
#include "engine/store/networks.h"
#include "engine/sweep/plan.h"

namespace ed3r::schedule {

// Which of several networks flies a mission of an arm. They take turns, so shifted from round to round of the `places` (sites
// times base stations) that each meets each place as often and none flies the first missions alone.
int NetworkOfMission(int mission, int places, int networks);

// A network that was trained or found in the cache.
struct ShelvedNetwork {
  std::string name;  // "rc from random, eta_min 0.75, seed 1"
  std::string file;  // in the cache
  std::shared_ptr<const rfnn::Model> model;
};

// Networks by the arm that asks for them. Immutable once made; shared read-only by all missions.
class NetworkShelf {
 public:
  // Those of one mission, by NetworkOfMission. All null for arms that ask none.
  agents::Networks For(const sweep::RunId& id, int places) const;
  // Which of its arm's training seeds a mission flies with; -1 without networks.
  int SeedIndex(const sweep::RunId& id, int places) const;

  const std::vector<ShelvedNetwork>& All() const { return all_; }

  // Adds the arms of another shelf, whose networks replace those of the same arms.
  void Take(NetworkShelf&& other);

  // For the store, and back from it.
  store::FlownNetworks Flown() const;
  // Every network is compared with the hash under which it flew; UserError when one differs.
  static std::unique_ptr<NetworkShelf> From(const store::FlownNetworks& flown, const std::string& dir);

 private:
  friend class TrainingStage;
  struct Pair {
    std::shared_ptr<const rfnn::Model> rc, robot;
  };
  std::map<std::pair<int, int>, std::vector<Pair>> by_arm_;  // (stage, arm) -> one pair per training seed
  std::vector<ShelvedNetwork> all_;
};

struct TrainingOptions {
  std::string stage;  // trains what the arms behind this training stage ask for; "" for all arms of the plan
  std::string run_dir;    // holds the warm-up missions
  std::string cache_dir;  // holds networks and checkpoints of all sweeps
  int threads = 1;
  const std::atomic<bool>* stop = nullptr;
  std::FILE* progress = nullptr;  // where a progress line goes, as in ScheduleOptions
  bool quiet = false;
};

// Whether an arm, or any arm of the plan, asks for networks that are trained: its strategy asks one, and it is no file.
bool NeedsTraining(const Config& config);
bool NeedsNetworks(const sweep::SweepPlan& plan);

// Arms that ask for networks must stand in stages behind a training stage that is behind a warm-up with their source
// strategy, with missions for each network (CheckWarmup). Throws UserError that says what is missing; part of the checks before anything is written.
void CheckTraining(const sweep::SweepPlan& plan);

// Trains, or finds, the networks of a training stage: those of arms behind it whose warm-up is before it, so that nothing
// is learned from a warm-up that is not flown out. Null when stopped: the same call again continues. NetworkShelf::From() takes them from
// a run that has flown.
std::unique_ptr<NetworkShelf> TrainNetworks(const sweep::SweepPlan& plan, const TrainingOptions& options);

// Of the arms that learn in the training stage of this name: how many have no network among `uses`. 0 when it is done.
std::int64_t CountUntrained(const sweep::SweepPlan& plan, const std::string& training,
                            const std::vector<store::NetworkUse>& uses);

// How many networks TrainNetworks() would train where the cache holds none. Reads nothing.
std::int64_t CountNetworks(const sweep::SweepPlan& plan);

// By network: whether the cache holds it already. Reads the warm-up of `options.run_dir`.
std::vector<bool> NetworksInCache(const sweep::SweepPlan& plan, const TrainingOptions& options);

// Network i of these for every i that leaves the part's remainder, into the cache: tasks of a batch system share the work,
// and TrainNetworks() then finds them all. Empty when stopped, or where the part has no network.
std::vector<ShelvedNetwork> TrainPart(const sweep::SweepPlan& plan, const TrainingOptions& options,
                                      const Shard& part);

}  // namespace ed3r::schedule
