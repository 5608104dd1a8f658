#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "engine/app/commands.h"
#include "engine/app/lacking.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/files/csv_table.h"
#include "engine/core/files/file.h"
#include "engine/core/files/new_folder.h"
#include "engine/core/files/remove_file.h"
#include "engine/core/parse_number.h"
#include "engine/rfnn/model_file.h"
#include "engine/rfnn/onnx_network.h"
#include "engine/store/directory_lock.h"
#include "engine/store/reader.h"
#include "engine/store/shards/gathered_shards.h"
#include "engine/sweep/plan_text.h"
#include "studies/export/export_tables.h"

namespace ed3r::app {
namespace {

struct Options {
  std::string dir, out;
  bool csv = false, numpy = false, networks = false;
};

// "rc from random, eta_min 0.75, seed 1" -> "rc-from-random-eta_min-0.75-seed-1"
std::string Stem(const std::string& network) {
  std::string name;
  for (const char c : network) {
    const bool kept = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
    if (kept) name += c;
    if (!kept && !name.empty() && name.back() != '-') name += '-';
  }
  return name;
}

// By the networks' hashes. Arms that were trained otherwise have networks of one name, which differ in their files' names by
// the beginning of their hash.
std::map<std::string, std::string> FileNames(const store::FlownNetworks& flown) {
  constexpr std::size_t kHashLetters = 12;
  std::map<std::string, int> called;
  for (const auto& [sha256, file] : flown.files) ++called[Stem(file.name)];
  std::map<std::string, std::string> names;
  for (const auto& [sha256, file] : flown.files) {
    const std::string stem = Stem(file.name);
    names[sha256] = (called[stem] == 1 ? stem : stem + '-' + sha256.substr(0, kHashLetters)) + ".onnx";
  }
  return names;
}

// The seed that an arm's network number `use.seed` was trained with; "" in plans of before there was one.
std::string TrainingSeed(const sweep::WrittenPlan::Arm& arm, const store::NetworkUse& use) {
  const auto first = arm.settings.find("training.seed");
  const std::optional<std::int64_t> seed =
      first == arm.settings.end() ? std::nullopt : ParseNumber<std::int64_t>(first->second);
  return seed ? std::to_string(*seed + use.seed) : "";
}

// Networks of one name part by their hash alone: a row for each arm that flew one says which it is. `network` is the column of
// that name in missions.csv.
std::string NetworkIndex(store::ResultReader& reader, const store::FlownNetworks& flown,
                         const std::map<std::string, std::string>& names) {
  const sweep::WrittenPlan plan = sweep::ReadPlanText(reader.StoredRecipe().plan_text);
  std::string csv = "file,agent,training_seed,stage,arm,network,sha256\n";
  for (const store::NetworkUse& use : flown.uses) {
    const sweep::WrittenPlan::Stage& stage = plan.stages.at(static_cast<std::size_t>(use.stage));
    const sweep::WrittenPlan::Arm& arm = stage.arms.at(static_cast<std::size_t>(use.arm));
    csv +=
        fmt::format("{},{},{},{},{},{},{}\n", CsvField(names.at(use.sha256)), use.agent,
                    TrainingSeed(arm, use), CsvField(stage.name), CsvField(arm.name), use.seed, use.sha256);
  }
  return csv;
}

// The networks of a run as files. There may be more of them than a process may have open, so that the index tells whether they
// are whole: it is gone before the first is written, and comes last.
struct ExportedNetworks {
  std::filesystem::path index;
  std::string index_text;
  std::int64_t rows = 0;
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  std::vector<std::string> names;  // for people

  void Write() const {
    RemoveFile(index);
    for (const auto& [path, bytes] : files) WriteFile(path, bytes);
  }
  void Tell() const {
    for (std::size_t i = 0; i < files.size(); ++i) fmt::print("{}: {}\n", files[i].first.string(), names[i]);
    fmt::print("{}: {}: which arm flew which of them\n", index.string(), Counted(rows, "row"));
  }
};

ExportedNetworks NetworksOf(store::ResultReader& reader, const std::string& dir,
                            const std::filesystem::path& folder) {
  const store::FlownNetworks flown = reader.Networks();
  if (flown.files.empty()) throw UserError(fmt::format("{}: --networks: no trained network flew here", dir));
  const std::map<std::string, std::string> names = FileNames(flown);
  ExportedNetworks exported{folder / "networks.csv",
                            NetworkIndex(reader, flown, names),
                            static_cast<std::int64_t>(flown.uses.size()),
                            {},
                            {}};
  std::set<std::string> done;
  for (const store::NetworkUse& use : flown.uses) {
    if (!done.insert(use.sha256).second) continue;
    const store::NetworkFile& file = flown.files.at(use.sha256);
    const rfnn::Model model = rfnn::OpenModel(file.model, fmt::format("{}: network '{}'", dir, file.name),
                                              use.agent == "rc" ? rfnn::kRcNetwork : rfnn::kRobotNetwork);
    exported.files.emplace_back(folder / names.at(use.sha256), rfnn::OnnxBytes(model));
    exported.names.push_back(file.name);
  }
  return exported;
}

int Export(const Options& options) {
  if (!options.csv && !options.numpy && !options.networks)
    throw UserError("ed3r export: nothing to write; allowed: --csv, --numpy, --networks, or several");
  const store::GatheredShards run(options.dir);
  store::ResultReader reader(run.dir());
  const std::filesystem::path folder = options.out.empty() ? std::filesystem::path(options.dir) / "export"
                                                           : std::filesystem::path(options.out);
  const NewFolder made(folder);  // a damaged run is refused below
  const auto alone = store::LockToWrite(folder.string());
  FileSet files;
  std::vector<exports::ExportedTable> tables;
  const auto write_tables = [&](exports::ExportFormat format) {
    for (exports::ExportedTable& table : exports::ExportTables(reader, format, folder, files))
      tables.push_back(std::move(table));
  };
  if (options.csv) write_tables(exports::ExportFormat::kCsv);
  if (options.numpy) write_tables(exports::ExportFormat::kNumpy);
  std::optional<ExportedNetworks> networks;
  if (options.networks) networks = NetworksOf(reader, options.dir, folder);
  if (networks) {
    files.Add(networks->index, networks->index_text);
    networks->Write();
  }
  files.Commit();
  for (const exports::ExportedTable& table : tables)
    fmt::print("{}: {}\n", table.file.string(), Counted(table.rows, "row"));
  if (networks) networks->Tell();
  FlushOutput();
  TellNotes(run.notes());
  if (!options.csv && !options.numpy) return kDone;
  TellLacking(reader, tables.front().rows, options.dir + ": the tables are of");
  for (const std::string& note : exports::TimestepNotes(reader)) Tell("note: {}: {}", options.dir, note);
  return kDone;
}

}  // namespace

Command AddExport(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "export", "Missions and timesteps as tables for other tools, networks as ONNX files");
  parser.Option("DIR", options->dir, "Run directory; shards in it count, merged or not").Required();
  parser.Flag("--csv", options->csv, "missions.csv and timesteps.csv");
  parser.Flag("--numpy", options->numpy, "missions.npy and timesteps.npy: structured arrays");
  parser.Flag(
      "--networks", options->networks,
      "The networks that flew, for networks.rc and networks.robot of another sweep, and networks.csv: "
      "which arm flew which");
  parser.Option("--out", options->out, "Folder to write to; default DIR/export");
  parser.Footer(
      "Columns have their units in their names; stage, arm, outcome, motion_rule and execution are words. "
      "Parquet is not "
      "written: Debian 12 packages no library for it.");
  return {parser, [options] { return Export(*options); }};
}

}  // namespace ed3r::app
