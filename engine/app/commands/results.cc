// Commands that read run directories: status, report, digest, merge.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/app/commands.h"
#include "engine/app/failure_text.h"
#include "engine/app/kept_inputs.h"
#include "engine/app/lacking.h"
#include "engine/app/report_missions.h"
#include "engine/app/stage_state.h"
#include "engine/app/status_of_shards.h"
#include "engine/app/status_watch.h"
#include "engine/app/words.h"
#include "engine/store/digest.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/shards/gathered_shards.h"
#include "engine/store/shards/merge.h"
#include "engine/sweep/plan_text.h"
#include "studies/figures/run_source.h"
#include "studies/report/load.h"
#include "studies/report/report.h"
#include "studies/report/report_folder.h"

namespace ed3r::app {
namespace {

struct DirOptions {
  std::string dir;
  bool json = false;
};

std::shared_ptr<DirOptions> AddDirOptions(CommandLine& parser) {
  auto options = std::make_shared<DirOptions>();
  parser.Option("DIR", options->dir, "Run directory").Required();
  parser.Flag("--json", options->json, "Print JSON");
  return options;
}

struct Check {
  bool done = false;
  bool possible = true;  // false: without checksums
  std::vector<store::DamagedMission> damage;
  std::vector<std::string> beside;  // lines on what is kept besides missions

  bool Whole() const { return damage.empty() && beside.empty(); }
};

Check CheckOf(store::ResultReader& reader) {
  Check check;
  check.possible = reader.Tables().checked();
  check.done = check.possible && reader.IsQuicklyCompared();
  if (!check.done) return check;
  check.damage = reader.FindDamage();
  check.beside = DamageBesideMissions(reader, reader.dir());
  return check;
}

void PrintStatusJson(store::ResultReader& reader, const Check& check) {
  nlohmann::ordered_json object = {{"name", reader.Layout().name}, {"arms", ArmsJson(reader.Status())}};
  const std::vector<store::FailedMission> failures = reader.Failures();
  object["failure_kinds"] = FailureKindsJson(failures);
  object["failures"] = FailuresJson(reader.Layout(), failures);
  object["checked"] = check.done;
  object["damaged"] = nlohmann::ordered_json::array();
  for (const store::DamagedMission& damage : check.damage)
    object["damaged"].push_back({{"mission", damage.name}, {"problem", damage.what}});
  object["other"] = check.beside;
  fmt::print("{}\n", object.dump(2));
}

void PrintStatus(store::ResultReader& reader, const Check& check) {
  fmt::print("{:<12} {:<28} {:>8} {:>8} {:>8} {:>8}\n", "stage", "arm", "planned", "done", "failed",
             "missing");
  for (const store::ArmStatus& arm : reader.Status())
    fmt::print("{:<12} {:<28} {:>8} {:>8} {:>8} {:>8}\n", arm.stage, arm.arm, arm.planned, arm.done,
               arm.failed, arm.missing);
  fmt::print("{}", FailuresText(reader.Layout(), reader.Failures()));
  for (const sweep::WrittenPlan::Stage& stage : sweep::ReadPlanText(reader.StoredRecipe().plan_text).stages)
    if (stage.precision)
      fmt::print(
          "stage {} ends when it is known well enough, so that missing missions may not be needed: 'ed3r "
          "status {} --stage "
          "{}' tells\n",
          stage.name, reader.dir(), stage.name);
  if (!check.possible)
    fmt::print("{}\n", store::kNothingToCompare);
  else if (!check.done)
    fmt::print("not compared with its checksums, as it is larger than {} MB: 'ed3r verify {}' does\n",
               store::kQuicklyComparedBytes / 1'000'000, reader.dir());
  if (!check.damage.empty())
    fmt::print(
        "damaged: {}, the first {}: {}; 'ed3r verify {}' names all, 'ed3r run SWEEP --repair' flies them "
        "again\n",
        Counted(std::ssize(check.damage), "mission"), check.damage.front().name, check.damage.front().what,
        reader.dir());
  for (const std::string& line : check.beside) fmt::print("{}\n", line);
}

// Results are of missions alone, and are whole where they are not damaged themselves.
void TellDamageBesideMissions(store::ResultReader& reader, const std::string& dir) {
  for (const std::string& line : DamageBesideMissions(reader, dir)) Tell("note: {}", line);
}

}  // namespace

Command AddStatus(Program& program) {
  CommandLine parser = program.AddCommand(
      "status",
      "Done, failed and missing missions of a run, while it runs or after; exit 1 where any is damaged");
  const auto options = AddDirOptions(parser);
  auto watch = std::make_shared<WatchOptions>();
  parser
      .Flag("--watch", watch->terminal,
            "Shows rates, the expected end and intervals until nothing is missing")
      .Excludes({"--json"});
  parser
      .Option("--html", watch->html, "Keeps writing a page that shows itself anew, until nothing is missing")
      .Excludes({"--json"});
  auto every_s = std::make_shared<int>(0);  // 0: not given
  parser.Option("--every", *every_s, "Seconds between two looks of --watch and --html; default 5")
      .Range(1, 3600);
  auto stage = std::make_shared<std::string>();
  parser
      .Option("--stage", *stage,
              "Whether this stage is finished: exit 0; 3 when missions failed or are missing, or networks "
              "are; 75 when a stage with a precision is due another round")
      .Excludes({"--watch", "--html", "--json"});
  return {parser, [options, stage, watch, every_s] {
            watch->dir = options->dir;
            if (*every_s > 0 && !watch->terminal && watch->html.empty())
              throw UserError("--every: is of --watch and --html, which look again");
            if (*every_s > 0) watch->seconds = *every_s;
            if (watch->terminal || !watch->html.empty()) return WatchStatus(*watch);
            if (!stage->empty()) return static_cast<int>(TellStage(options->dir, *stage));
            if (IsTallied(options->dir)) return static_cast<int>(TellTally(options->dir, options->json));
            store::ResultReader reader(options->dir);
            const Check check = CheckOf(reader);
            options->json ? PrintStatusJson(reader, check) : PrintStatus(reader, check);
            return static_cast<int>(check.Whole() ? kDone : kFailedInside);
          }};
}

namespace {

struct ReportOptions {
  std::string dir, out, variant;
  std::string cache = "results/cache";
  bool json = false, no_figures = false, no_missions = false, force = false, claims = false;
};

// Tables of the paper's arms and its verdicts find an arm by its name: of two stages they would tell one without saying which.
std::string NamesOfSeveralStages(const report::RunResults& results) {
  std::map<std::string, std::vector<std::string>> stages;
  for (const metrics::ArmData& arm : results.arms)
    if (!arm.missions.empty()) stages[arm.name].push_back(arm.stage);
  std::erase_if(stages, [](const auto& entry) { return entry.second.size() < 2; });
  if (stages.empty()) return "";
  const auto& [name, flown] = *stages.begin();
  return fmt::format(
      "{} by name of more than one stage ({} of stages {}): tables of the paper's arms and verdicts are of "
      "the "
      "last of them, metrics.csv tells each; other names in each stage tell them apart",
      Counted(std::ssize(stages), "arm"), name, fmt::join(flown, ", "));
}

struct ReadRun {
  report::WholeRun whole;
  report::RunDepartures departures;
  figures::RunSource source;
};

// Everything that a report tells, of one moment of a run that may be going on.
ReadRun ReadForReport(store::ResultReader& reader, const ReportOptions& options) {
  const store::Transaction moment = reader.Moment();
  ReadRun read;
  read.whole = report::LoadWhole(reader, options.dir);  // of a damaged run nothing is written
  read.departures = report::ReadDepartures(reader);
  read.source = figures::ReadRunSource(reader, report::ToldVariant(read.whole.results, options.variant));
  return read;
}

std::string CommandOf(const ReportOptions& options) {
  return "ed3r report " + options.dir + (options.out.empty() ? "" : " --out " + options.out) +
         (options.claims ? " --claims" : "") +
         (options.variant.empty() ? "" : " --variant " + options.variant);
}

int MakeReportOf(const ReportOptions& options) {
  const store::GatheredShards run(options.dir);
  store::ResultReader reader(run.dir());
  const ReadRun read = ReadForReport(reader, options);
  const report::RunResults& results = read.whole.results;
  const report::Report report = report::MakeReport(
      results, read.departures,
      options.claims ? report::Judging::kEverything : report::Judging::kWhatThePaperFlew, options.variant);
  report::FolderOptions folder{.provenance = read.whole.provenance,
                               .source = read.source,
                               .out = options.out.empty() ? options.dir + "/report" : options.out,
                               .figures = !options.no_figures,
                               .force = options.force,
                               .command = CommandOf(options)};
  WatchedMissions watched;
  if (!options.no_missions)
    watched = WatchMissions(report, results, read.source.plans, run.dir(), options.cache);
  folder.viewers_note = watched.note;
  for (WatchedMission& mission : watched.list) {
    folder.viewers.push_back({{"mission", mission.mission}, {"what", mission.what}, {"file", mission.file}});
    folder.mission_pages[mission.file] = std::move(mission.page);
  }
  // Missions are flown again from a run that is opened again, and DIR/report would be in another.
  reader.CheckNotReplaced();
  const report::FolderResult written = report::WriteReportFolder(report, results, folder);
  if (options.json)
    fmt::print("{}\n", report::ReportJson(report).dump(2));
  else
    fmt::print("{}\n{}: index.html, report.txt, report.json, metrics.csv, {} tables, {} figures\n",
               report::ReportText(report), folder.out, report.tables.size(), written.figures);
  FlushOutput();
  TellNotes(run.notes());
  TellDamageBesideMissions(reader, options.dir);
  TellLacking(reader, read.whole.provenance.stored, options.dir + ": the report is of");
  if (const std::string& why = read.source.scene.why_not; !why.empty())
    Tell("note: {}: its world is not shown: {}", options.dir, why);
  for (const std::string& note :
       {NamesOfSeveralStages(results), written.note, written.page_note, watched.note})
    if (!note.empty()) Tell("note: {}", note);
  if (written.plot_error.empty()) return kDone;
  Tell("figures: drawing failed: {}", written.plot_error);
  return kFailedInside;
}

}  // namespace

Command AddReport(Program& program) {
  auto options = std::make_shared<ReportOptions>();
  CommandLine parser = program.AddCommand(
      "report", "Tables, figures and index.html of a run beside the paper's values, written to DIR/report");
  parser.Option("DIR", options->dir, "Run directory; shards in it count, merged or not").Required();
  parser.Option("--out", options->out, "Folder to write to; default DIR/report");
  parser.Flag("--force", options->force, "Write into a folder that is neither empty nor a report, too");
  parser.Flag("--claims", options->claims,
              "Judge the paper's claims though another robot, world or parameter was flown than the paper's; "
              "otherwise verdicts are left out then");
  parser
      .Option("--variant", options->variant,
              "Of a sweep with variants: the one that tables, pictures and verdicts tell; default the first. "
              "All are told "
              "in short and compared with the first")
      .OneValue();
  parser.Flag("--no-figures", options->no_figures,
              "Draw nothing (no Python); the figures' data are still written");
  parser.Flag("--no-missions", options->no_missions,
              "Fly no missions again to be watched; a few are otherwise, into DIR/report/missions");
  parser.Option("--cache", options->cache, "Where trained networks are kept; default results/cache");
  parser.Flag("--json", options->json, "Print JSON");
  parser.Footer(
      "Figures are drawn by scripts/plot.py, found beside an installed program, in the source tree or in "
      "$ED3R_SCRIPTS, with /usr/bin/python3 or $ED3R_PYTHON, which needs matplotlib. Without them all else "
      "is written.");
  return {parser, [options] { return MakeReportOf(*options); }};
}

Command AddDigest(Program& program) {
  CommandLine parser =
      program.AddCommand("digest", "One SHA-256 over all stored results, the same however they were flown");
  parser.Footer(
      "Shards in DIR count, merged or not. Where missions of the plan are not stored, a note says how many.");
  const auto options = AddDirOptions(parser);
  return {parser, [options] {
            const store::GatheredShards run(options->dir);
            store::ResultReader reader(run.dir());
            const store::Transaction moment = reader.Moment();
            const std::string digest = store::DigestOf(reader);
            const std::int64_t missions = reader.CountMissions(), planned = reader.Layout().Missions();
            if (options->json)
              fmt::print("{}\n", nlohmann::ordered_json(
                                     {{"sha256", digest}, {"missions", missions}, {"planned", planned}})
                                     .dump(2));
            else
              fmt::print("{}\n", digest);
            FlushOutput();
            if (!reader.Tables().checked()) Tell("note: {}", store::kNothingToCompare);
            TellDamageBesideMissions(reader, options->dir);
            TellNotes(run.notes());
            TellLacking(reader, missions, "this is the digest of");
            return kDone;
          }};
}

Command AddMerge(Program& program) {
  struct Options {
    std::string out;
    std::vector<std::string> dirs;
    bool accept_mixed = false;
  };
  auto options = std::make_shared<Options>();
  CommandLine parser =
      program.AddCommand("merge", "Joins shards into one run directory; refuses conflicting records");
  parser.Option("OUT", options->out, "Run directory to make or to add to").Required();
  parser.Option("DIR", options->dirs, "Run directories to join").Required();
  parser.Flag("--accept-mixed", options->accept_mixed,
              "Join what different code has flown; the report of the run says so");
  return {parser, [options] {
            const store::MergeSummary summary = store::MergeStores(
                options->out, options->dirs,
                options->accept_mixed ? store::OtherCode::kAccept : store::OtherCode::kRefuse);
            fmt::print("{}: {} missions added, {} were there already, {} failed\n", options->out,
                       summary.added, summary.present, summary.failed);
            FlushOutput();
            store::ResultReader reader(options->out);
            TellLacking(reader, reader.CountMissions(), options->out + ": holds");
            return kDone;
          }};
}

}  // namespace ed3r::app
