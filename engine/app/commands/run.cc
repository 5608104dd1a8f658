#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "engine/app/commands.h"
#include "engine/app/finished_run.h"
#include "engine/app/idle_settings.h"
#include "engine/app/machine.h"
#include "engine/app/shard_text.h"
#include "engine/app/stored_run.h"
#include "engine/app/sweep_arguments.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/interrupt.h"
#include "engine/schedule/inputs.h"
#include "engine/schedule/sweep_runner.h"
#include "engine/store/reader.h"
#include "studies/report/load.h"
#include "studies/report/report.h"

namespace ed3r::app {
namespace {

struct Options {
  SweepArguments sweep;
  std::string out, stage, from;
  std::string cache = "results/cache";
  int threads = 0;
  std::string shard = "1/1";
  bool quiet = false, repair = false, only_failed = false, accept_mixed = false, profile = false;
};

std::string NetworksText(const std::vector<schedule::ShelvedNetwork>& networks) {
  std::string text;
  for (const schedule::ShelvedNetwork& network : networks) {
    const rfnn::TrainingReport& report = network.model->data().report;
    text += fmt::format(
        "network {}: {}, best {}; R2 train {:.3f}, validation {:.3f}, held out {:.3f}{}; {}\n", network.name,
        Counted(static_cast<std::int64_t>(report.curve.size()), "epoch"), report.best_epoch, report.train.r2,
        report.validation.r2, report.test.r2,
        report.test.r2 < 0.0 ? " (foresees no better than a mean: it wants more warm-up missions or epochs)"
                             : "",
        network.file);
  }
  return text;
}

// One line on what this session did, with the real-time factor per core.
void PrintSession(const schedule::SweepSummary& summary, const std::string& dir) {
  const schedule::RunSummary& flown = summary.flown;
  if (!summary.grown.empty()) fmt::print("grown: {}\n", summary.grown);
  for (const store::DamagedMission& damage : summary.repaired)
    fmt::print("repaired: {}: {}\n", damage.name, damage.what);
  fmt::print("{}: {} stored", dir, Counted(summary.stored_before + flown.stored, "mission"));
  if (summary.stored_before > 0) fmt::print(" ({} before)", summary.stored_before);
  if (flown.failed > 0) fmt::print(", {} failed", flown.failed);
  if (flown.stored > 0)
    fmt::print("; {:.1f} simulated hours in {:.1f} s on {}: {:.0f} x real time per core",
               flown.simulated_s / 3600, flown.wall_s, Counted(flown.threads, "thread"),
               flown.simulated_s / flown.wall_s / flown.threads);
  fmt::print("\n");
  fmt::print("{}", NetworksText(summary.networks));
}

int ToldEnd() {
  const bool requeue = AsksRequeue(InterruptSignal());
  Tell("{}: what is stored is kept; the same command continues",
       requeue ? fmt::format("ended by {}", SignalName(InterruptSignal())) : "interrupted");
  return requeue ? kRequeue : kInterrupted;
}

// A part of a training stage leaves networks in the cache and needs no store of its own.
bool IsPartOfTraining(const sweep::SweepPlan& plan, const Options& options, const schedule::Shard& shard) {
  return shard.count > 1 &&
         std::any_of(plan.stages.begin(), plan.stages.end(), [&](const sweep::Stage& stage) {
           return stage.name == options.stage && stage.kind == sweep::StageKind::kTrain;
         });
}

// UserError unless all is stored that the training stage learns from. Inputs are not compared: networks know records alone.
void CheckFoundation(const sweep::SweepPlan& plan, const Options& options) {
  store::ResultReader reader(options.from);
  if (reader.StoredRecipe().plan_text != plan.CanonicalText())
    throw UserError(fmt::format("{}: holds results of another plan; give another --from", options.from));
  if (!options.accept_mixed)
    schedule::RefuseOtherCode(options.from, reader.StoredRecipe().code, schedule::CodeOf(plan));
  const std::vector<sweep::RunId> stored = reader.Stored();
  for (const sweep::Stage& stage : plan.stages)
    if (stage.name == options.stage)
      schedule::CheckReady(plan, stage, stored, options.from, report::HalfWidth);
}

int TrainAPart(const sweep::SweepPlan& plan, const Options& options, const schedule::Shard& shard) {
  if (options.from.empty())
    throw UserError(
        "--from: is missing; a part of a training stage learns from the run that holds the warm-up");
  // --out may be given to every part of a sweep alike.
  for (const auto& [given, option] :
       {std::pair(options.repair, "--repair"), std::pair(options.only_failed, "--only-failed"),
        std::pair(options.profile, "--profile")})
    if (given)
      throw UserError(
          fmt::format("{}: is not allowed with a part of a training stage, which flies nothing and keeps no "
                      "store; leave it out",
                      option));
  schedule::CheckPlan(plan);
  CheckFoundation(plan, options);
  InstallInterruptHandler();
  const std::vector<schedule::ShelvedNetwork> networks =
      schedule::TrainPart(plan,
                          {options.stage, options.from, options.cache, schedule::ThreadsFor(options.threads),
                           &InterruptFlag(), stderr, options.quiet},
                          shard);
  if (InterruptFlag()) return ToldEnd();
  if (!options.quiet) fmt::print("{}", NetworksText(networks));
  return kDone;
}

std::string TableOf(const std::string& dir) {
  store::ResultReader reader(dir);
  const store::Transaction moment = reader.Moment();
  return report::ReportText(report::MakeReport(report::LoadRun(reader), report::ReadDepartures(reader)));
}

int Run(const Options& options) {
  const sweep::SweepPlan plan = options.sweep.Load();
  const schedule::Shard shard = schedule::ParseShard(options.shard);
  schedule::ThreadsFor(options.threads);  // refused before worlds are built
  if (IsPartOfTraining(plan, options, shard)) return TrainAPart(plan, options, shard);
  const std::string dir = options.out.empty() ? DefaultRunDir(plan) : options.out;
  const bool all_of_it = shard.count == 1 && options.stage.empty() && !options.repair &&
                         !options.only_failed && !options.accept_mixed;
  if (all_of_it && TellFinishedRun(plan, dir, options.cache, options.quiet)) return kDone;
  const schedule::Inputs inputs(plan);
  InstallInterruptHandler();
  if (!options.quiet)
    for (const std::string& sentence : IdleSettings(plan)) Tell("note: {}", sentence);

  schedule::SweepOptions sweep;
  sweep.dir = dir;
  sweep.stage = options.stage;
  sweep.foundation = options.from;
  sweep.cache_dir = options.cache;
  sweep.shard = shard;
  sweep.schedule.threads = options.threads;
  sweep.schedule.stop = &InterruptFlag();
  sweep.schedule.quiet = options.quiet;
  sweep.repair = options.repair;
  sweep.only_failed = options.only_failed;
  sweep.accept_mixed = options.accept_mixed;
  sweep.profile = options.profile;
  sweep.half_width = report::HalfWidth;
  sweep.notes = DescribeMachine();
  sweep.notes.merge(NotesOf(options.sweep));
  sweep.notes.emplace("sweep question", plan.question);
  const schedule::SweepSummary summary = schedule::RunSweep(plan, inputs, sweep);

  const store::FileMoment told = store::LookAtFile(dir);
  std::string table;
  if (!options.quiet) {
    const bool part = shard.count > 1, ended = !summary.flown.interrupted;
    if (ended) table = part ? ShardTable(plan, shard, options.stage, dir) : TableOf(dir);
    if (ended) fmt::print("{}\n", table);
    PrintSession(summary, dir);
    if (part && ended)
      fmt::print("{}", AfterShard(plan, shard, options.stage, dir, summary.waiting_stage));
    else if (!summary.waiting_stage.empty())
      fmt::print("stage {} waits: missions that it builds on are missing or failed\n", summary.waiting_stage);
  }
  if (options.profile) fmt::print("time: {}\n", summary.profile.Text());
  if (summary.flown.interrupted) return ToldEnd();
  if (all_of_it && summary.flown.failed == 0 && summary.waiting_stage.empty())
    RememberFinishedRun(plan, dir, options.cache, told, summary.stored_before + summary.flown.stored, table,
                        NetworksText(summary.networks));
  return summary.flown.failed > 0 ? kMissionsFailed : kDone;
}

}  // namespace

Command AddRun(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "run", "Flies a sweep and prints its table; the same command again continues where it stopped");
  options->sweep.AddTo(parser);
  parser.Option("--out", options->out, "Run directory; default results/runs/<sweep name>");
  parser.Option("--stage", options->stage, "Fly or train this stage alone");
  parser
      .Option("--from", options->from,
              "Run directory, only read, that holds the missions and networks that --stage builds on; "
              "default --out")
      .Needs("--stage");
  parser.Option("--cache", options->cache,
                "Where trained networks are kept for all sweeps; default results/cache");
  parser.Option("--threads", options->threads, "Threads; 0, the default: all processors");
  parser.Option("--shard", options->shard,
                "I/N: fly one of N parts, e.g. 1/4, counted from 1 to N or from 0 to N-1 (0/N is N/N); "
                "'ed3r merge' joins them");
  parser.Flag("--repair", options->repair,
              "Delete stored missions that are damaged ('ed3r verify' names them) and fly them again");
  parser.Flag("--only-failed", options->only_failed,
              "Fly the missions that have failed again ('ed3r status' tells why), and none that are missing");
  parser.Flag("--accept-mixed", options->accept_mixed,
              "Continue a run that other code has begun, or build on one (--from); its report says so");
  parser.Flag("--profile", options->profile,
              "Tell where the time went (physics, decisions, training, ...); also kept for the report");
  parser.Flag("--quiet", options->quiet, "Neither progress nor table");
  return {parser, [options] { return Run(*options); }};
}

}  // namespace ed3r::app
