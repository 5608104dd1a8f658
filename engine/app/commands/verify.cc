// Whether a run directory can be believed, and where two of them part: verify, diff.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/app/commands.h"
#include "engine/app/kept_inputs.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/json_text.h"
#include "engine/store/difference.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/shards/common_run.h"
#include "engine/store/shards/gathered_shards.h"
#include "engine/store/shards/shards.h"

namespace ed3r::app {
namespace {

struct Damage {
  std::string store;
  store::DamagedMission mission;
};

struct Verification {
  std::int64_t stores = 0, missions = 0;
  std::vector<Damage> damage;
  std::vector<std::string> other;  // lines on what is not a mission
  std::vector<std::string> notes;
};

void VerifyStore(const std::string& dir, Verification& found) {
  ++found.stores;
  try {
    store::ResultReader reader(dir);
    const std::int64_t missions = reader.CountMissions();
    found.missions += missions;
    if (!reader.Tables().checked())
      found.other.push_back(
          fmt::format("{}: {}, {}", dir, Counted(missions, "mission"), store::kNothingToCompare));
    for (store::DamagedMission& damage : reader.FindDamage())
      found.damage.push_back({dir, std::move(damage)});
    for (std::string& line : DamageBesideMissions(reader, dir)) found.other.push_back(std::move(line));
  } catch (const UserError& error) {
    // What is not there is bad input; what is there and cannot be read is what was asked.
    if (!std::filesystem::exists(std::filesystem::path(dir) / store::kResultsFile)) throw;
    found.other.emplace_back(error.what());
  } catch (const InternalError& error) {  // SQLite's own tables are not what they should be
    found.other.emplace_back(error.what());
  }
}

// All that the run's tables are made of: its own store, and those of its shards.
Verification Verify(const std::string& dir) {
  const std::vector<std::string> shards = store::ShardDirs(dir);
  Verification found;
  if (shards.empty() || store::HoldsResults(dir)) VerifyStore(dir, found);
  for (const std::string& shard : shards) VerifyStore(shard, found);
  // Each may be whole, and of another run.
  if (found.stores > 1 && found.damage.empty() && found.other.empty()) try {
      const store::AddingStores together = store::StoresThatAdd(dir);
      const store::CommonRun run(together.dirs, store::OtherCode::kRefuse);
      found.notes.insert(found.notes.end(), together.notes.begin(), together.notes.end());
    } catch (const UserError& error) {
      found.other.emplace_back(error.what());
    }
  for (const std::string& empty : store::EmptyShardDirs(dir))
    found.notes.push_back(fmt::format("{}: no results in it: {} is empty", empty, store::kResultsFile));
  return found;
}

int PrintVerification(const std::string& dir, const Verification& found, bool json) {
  const bool whole = found.damage.empty() && found.other.empty();
  if (json) {
    nlohmann::ordered_json object = {{"whole", whole},
                                     {"stores", found.stores},
                                     {"missions", found.missions},
                                     {"damaged", nlohmann::ordered_json::array()},
                                     {"other", found.other}};
    for (const auto& [store, mission] : found.damage)
      object["damaged"].push_back({{"mission", mission.name}, {"problem", mission.what}, {"store", store}});
    fmt::print("{}\n", JsonText(object));
    return whole ? kDone : kFailedInside;
  }
  for (const auto& [store, mission] : found.damage)
    fmt::print("{}{}: {}\n", found.stores > 1 ? store + ": " : "", mission.name, mission.what);
  for (const std::string& line : found.other) fmt::print("{}\n", line);
  if (whole)
    fmt::print("{}: {} whole{}\n", dir, Counted(found.missions, "mission"),
               found.stores > 1 ? fmt::format(" in {} stores", found.stores) : "");
  else if (!found.damage.empty())
    fmt::print("{}: {} damaged; 'ed3r run SWEEP --repair'{} deletes them and flies them again\n", dir,
               Counted(static_cast<std::int64_t>(found.damage.size()), "mission"),
               found.stores > 1 ? " with the --out and --shard of that store" : "");
  return whole ? kDone : kFailedInside;
}

int PrintDifference(const store::RunDifference& difference, bool json) {
  const auto& first = difference.first;
  if (json) {
    nlohmann::ordered_json object = {{"identical", !first.has_value()},
                                     {"compared", difference.compared},
                                     {"differing", difference.differing},
                                     {"only_in_first", difference.only_here},
                                     {"only_in_second", difference.only_there}};
    if (first)
      object["first"] = {{"mission", first->mission},
                         {"timestep", first->timestep},
                         {"quantity", first->quantity},
                         {"first", first->here},
                         {"second", first->there}};
    fmt::print("{}\n", JsonText(object));
    return first ? kFailedInside : kDone;
  }
  if (!first) {
    fmt::print("identical: {}\n", Counted(difference.compared, "mission"));
    return kDone;
  }
  if (first->quantity == "mission")
    fmt::print("{}: only the {} run has it\n", first->mission, first->here.empty() ? "second" : "first");
  else if (first->quantity == "timestep")
    fmt::print("{}: timestep {}: only the {} run has it\n", first->mission, first->timestep,
               first->here.empty() ? "second" : "first");
  else
    fmt::print("{}{}: {} is {} in the first and {} in the second\n", first->mission,
               first->timestep > 0 ? fmt::format(", timestep {}", first->timestep) : "", first->quantity,
               first->here, first->there);
  fmt::print("{} compared, {} differ; {} only in the first, {} only in the second\n",
             Counted(difference.compared, "mission"), difference.differing, difference.only_here,
             difference.only_there);
  return kFailedInside;
}

}  // namespace

Command AddVerify(Program& program) {
  struct Options {
    std::string dir;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "verify",
      "Compares everything stored with its checksums and names what is damaged; exit 1 where anything is, or "
      "has no checksums");
  parser.Option("DIR", options->dir, "Run directory; shards in it, merged or not, are compared, too")
      .Required();
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] {
            const Verification found = Verify(options->dir);
            const int status = PrintVerification(options->dir, found, options->json);
            FlushOutput();
            TellNotes(found.notes);
            return status;
          }};
}

Command AddDiff(Program& program) {
  struct Options {
    std::string a, b;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "diff", "The first mission, timestep and quantity in which two runs differ; exit 1 where they do");
  parser.Option("A", options->a, "Run directory; shards in it count, merged or not").Required();
  parser.Option("B", options->b, "Run directory, likewise").Required();
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] {
            const store::GatheredShards runs[] = {store::GatheredShards(options->a),
                                                  store::GatheredShards(options->b)};
            store::ResultReader a(runs[0].dir()), b(runs[1].dir());
            const store::RunDifference difference = store::DiffRuns(a, b);
            if (difference.compared + difference.only_here + difference.only_there == 0)
              throw UserError(
                  fmt::format("{} and {}: no mission of an arm that both have", options->a, options->b));
            const int status = PrintDifference(difference, options->json);
            FlushOutput();
            for (const store::GatheredShards& run : runs) TellNotes(run.notes());
            return status;
          }};
}

}  // namespace ed3r::app
