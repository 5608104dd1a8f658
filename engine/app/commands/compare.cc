// What differs between runs of the same arms: seeds, perception tiers, versions of the code.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/app/commands.h"
#include "engine/app/lacking.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/remove_file.h"
#include "engine/core/json_text.h"
#include "engine/store/directory_lock.h"
#include "engine/store/reader.h"
#include "engine/store/shards/gathered_shards.h"
#include "studies/figures/run_source.h"
#include "studies/metrics/number_text.h"
#include "studies/report/compare_page.h"
#include "studies/report/departures.h"
#include "studies/report/load.h"
#include "studies/report/provenance.h"
#include "studies/report/web_page.h"
#include "studies/tables/layout.h"
#include "studies/variants/pairing_notes.h"
#include "studies/variants/variants.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> dirs;
  std::string out;
  bool json = false, claims = false;
};

// A run is called by its folder.
std::string LabelOf(const std::string& dir) {
  const fs::path path = fs::absolute(dir).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

std::string NewLabel(const std::string& dir, const std::vector<std::string>& labels) {
  std::string label = LabelOf(dir);
  if (std::find(labels.begin(), labels.end(), label) != labels.end())
    throw UserError(
        fmt::format("{}: two of the runs are in folders called '{}'; their names must differ", dir, label));
  return label;
}

// What keeps claims from being judged, a line for each run; none where all may be.
std::vector<std::string> DepartureLines(const report::RunDepartures& departures,
                                        const std::vector<std::string>& labels, bool claims) {
  std::vector<std::string> lines;
  for (const std::string& label : labels)
    if (const report::Departures& of_run = departures.at(label); !of_run.PaperFlown())
      lines.push_back(
          fmt::format("{}: not as in the paper: {}.", label, report::DepartureText(of_run.results)));
  if (!lines.empty())
    lines.push_back(claims ? "The paper's claims are judged all the same (--claims)."
                           : "So the paper's claims are not judged; --claims judges them all the same.");
  return lines;
}

using Fingerprints = std::map<std::string, std::string>;

// Files that both runs name alike and that hold something else in this one: worlds, networks, detectors.
std::vector<std::string> OtherContents(const Fingerprints& first, const std::string& first_label,
                                       const Fingerprints& here, const std::string& label) {
  std::vector<std::string> lines;
  for (const auto& [name, fingerprint] : here)
    if (const auto there = first.find(name); there != first.end() && there->second != fingerprint)
      lines.push_back(
          fmt::format("{}: {} is not what it is in {}: its content differs.", label, name, first_label));
  return lines;
}

std::string Wrapped(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += tables::Wrap(line, "", tables::kTerminalWidth);
  return lines.empty() ? text : text + '\n';
}

nlohmann::ordered_json JsonOf(const variants::VariantStudy& study, const std::vector<std::string>& departures,
                              const std::vector<std::string>& other_contents) {
  nlohmann::ordered_json json = {{"runs", study.variants},
                                 {"departures", departures},
                                 {"other_contents", other_contents},
                                 {"differences", nlohmann::ordered_json::array()},
                                 {"changed_verdicts", nlohmann::ordered_json::array()}};
  for (const variants::VariantDifference& d : study.differences)
    json["differences"].push_back({{"arm", d.arm},
                                   {"run", d.variant},
                                   {"metric", d.metric},
                                   {"base", metrics::JsonNumber(d.base)},
                                   {"difference", metrics::JsonNumber(d.difference)},
                                   {"lo", metrics::JsonNumber(d.lo)},
                                   {"hi", metrics::JsonNumber(d.hi)},
                                   {"pairs", d.pairs},
                                   {"base_networks", d.base_networks},
                                   {"networks", d.networks}});
  for (const variants::VerdictChange& change : study.changes)
    json["changed_verdicts"].push_back({{"claim", change.claim},
                                        {"run", change.variant},
                                        {"base", NameOf(change.base)},
                                        {"here", NameOf(change.here)}});
  return json;
}

// What made the runs, by their labels.
nlohmann::ordered_json ManifestOf(const std::vector<report::ComparedRun>& runs) {
  nlohmann::ordered_json manifest = nlohmann::ordered_json::object();
  for (const report::ComparedRun& run : runs) manifest[run.label] = report::ManifestJson(run.provenance);
  return manifest;
}

void WritePage(const std::vector<report::ComparedRun>& runs, const variants::VariantStudy& study,
               const std::vector<std::string>& departures, const Options& options) {
  const report::FoundBundle found = report::FindWebBundle("report");
  if (!found.bundle) {
    Tell("note: {}", found.why_not);
    return;
  }
  const std::string command = fmt::format("ed3r compare {} --out {}{}", fmt::join(options.dirs, " "),
                                          options.out, options.claims ? " --claims" : "");
  WriteFile(fs::path(options.out) / "index.html",
            report::SelfContainedPage(
                fmt::format("{} compared", fmt::join(study.variants, ", ")), *found.bundle,
                report::ComparePageData(runs, study, departures, command),
                "<p>This page is a program: it needs scripts. The same is in compare.txt.</p>"));
}

void WriteFolder(const std::string& text, const std::vector<report::ComparedRun>& runs,
                 const variants::VariantStudy& study, const std::vector<std::string>& notes,
                 const Options& options) {
  const fs::path out(options.out);
  MakeFolder(out);
  const auto alone = store::LockToWrite(out.string());
  RemoveFile(out / "index.html");  // it comes last: where it is, all is of its runs
  FileSet files;
  files.Add(out / "compare.txt", text);
  files.Add(out / "differences.csv", variants::DifferenceCsv(study));
  files.Add(out / "verdicts.csv", variants::VariantVerdictCsv(study));
  files.Add(out / "manifest.json", JsonText(ManifestOf(runs)) + "\n");
  files.Commit();
  WritePage(runs, study, notes, options);
}

int Compare(const Options& options) {
  if (options.dirs.size() < 2)
    throw UserError(fmt::format("compare: {} is one run; at least two are needed", options.dirs.front()));
  std::vector<metrics::ArmData> arms;
  std::vector<report::ComparedRun> runs;
  std::vector<std::unique_ptr<store::GatheredShards>> stores;
  std::vector<std::string> labels, other_contents, shard_notes;
  std::set<std::uint64_t> seeds;
  Fingerprints first_inputs;
  report::RunDepartures departures;
  for (const std::string& dir : options.dirs) {
    const std::string label = labels.emplace_back(NewLabel(dir, labels));
    const store::GatheredShards& gathered =
        *stores.emplace_back(std::make_unique<store::GatheredShards>(dir));
    shard_notes.insert(shard_notes.end(), gathered.notes().begin(), gathered.notes().end());
    store::ResultReader reader(gathered.dir());
    const store::Transaction moment = reader.Moment();  // all of a run is of one
    auto [run, provenance] = report::LoadWhole(reader, dir);
    std::vector<figures::ArmPlan> plans = figures::ReadArmPlans(reader.StoredRecipe().plan_text);
    figures::FoundScene scene = runs.empty() ? report::SceneOf(reader, plans) : figures::FoundScene();
    seeds.insert(reader.Layout().seed);
    TellLacking(reader, provenance.stored, dir + ": is compared by");
    const Fingerprints inputs = reader.StoredRecipe().inputs;
    if (labels.size() == 1) first_inputs = inputs;
    for (std::string& line : OtherContents(first_inputs, labels.front(), inputs, label))
      other_contents.push_back(std::move(line));
    if (!variants::VariantsOf(run.arms).empty())
      throw UserError(fmt::format("{}: has variants of its own; 'ed3r report {}' compares them", dir, dir));
    if (provenance.mixed_code)
      other_contents.push_back(
          fmt::format("{}: several versions of the program flew it (--accept-mixed): {}.", label,
                      provenance.code_version));
    departures[label] = report::ReadDepartures(reader)[""];
    for (metrics::ArmData& arm : variants::AsVariant(run.arms, label)) arms.push_back(std::move(arm));
    runs.push_back({label, std::move(run), std::move(provenance), std::move(plans), std::move(scene)});
  }
  std::vector<std::string> notes = DepartureLines(departures, labels, options.claims);
  variants::VariantStudy study = variants::CompareVariants(
      arms, notes.empty() || options.claims ? variants::Verdicts::kJudged : variants::Verdicts::kLeftOut);
  study.same_draws = seeds.size() == 1;
  if (study.differences.empty())
    throw UserError(
        fmt::format("{}: no arm of the other runs has the name of one of its arms", options.dirs.front()));
  const std::vector<std::string> departure_lines = notes;
  for (std::size_t r = runs.size(); r-- > 1;) {
    const std::vector<std::string> left_out = variants::PairingNotes(
        {runs[0].label, runs[0].results.arms}, {runs[r].label, runs[r].results.arms}, study.same_draws);
    notes.insert(notes.begin(), left_out.begin(), left_out.end());
  }
  notes.insert(notes.begin(), other_contents.begin(), other_contents.end());
  const std::string text = Wrapped(notes) + variants::VariantText(study);
  if (!options.out.empty()) WriteFolder(text, runs, study, notes, options);
  fmt::print("{}", options.json ? JsonText(JsonOf(study, departure_lines, other_contents)) + "\n" : text);
  FlushOutput();
  TellNotes(shard_notes);
  if (const std::string& why = runs.front().scene.why_not; !why.empty())
    Tell("note: {}: its world is not shown: {}", options.dirs.front(), why);
  return kDone;
}

}  // namespace

Command AddCompare(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "compare",
      "Runs of the same arms, each compared with the first: differences paired by scenario, and the paper's "
      "claims that are judged otherwise");
  parser.Option("DIR", options->dirs, "Run directories; shards in them count, merged or not").Required();
  parser.Option("--out", options->out,
                "Folder for index.html, compare.txt, differences.csv, verdicts.csv and manifest.json");
  parser.Flag(
      "--claims", options->claims,
      "Judge the paper's claims though a run flew another robot, world or parameter than the paper's");
  parser.Flag("--json", options->json, "Print JSON");
  parser.Footer(
      "Runs of one seed meet the same scenarios; runs of different seeds are compared as independent draws "
      "at the same places. Where an arm flew with a single trained network on one side, the luck of training "
      "is not in the interval (training.seeds).");
  return {parser, [options] { return Compare(*options); }};
}

}  // namespace ed3r::app
