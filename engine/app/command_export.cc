#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <set>

#include "engine/app/commands.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/file.h"
#include "engine/rfnn/model_file.h"
#include "engine/rfnn/onnx_network.h"
#include "engine/store/reader.h"
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

void ExportNetworks(store::ResultReader& reader, const std::filesystem::path& folder) {
  const store::FlownNetworks flown = reader.Networks();
  if (flown.files.empty())
    throw UserError(fmt::format("{}: --networks: no trained network flew here", reader.dir()));
  MakeFolder(folder);
  const std::map<std::string, std::string> names = FileNames(flown);
  std::set<std::string> done;
  for (const store::NetworkUse& use : flown.uses) {
    if (!done.insert(use.sha256).second) continue;
    const store::NetworkFile& file = flown.files.at(use.sha256);
    const rfnn::Model model =
        rfnn::OpenModel(file.model, fmt::format("{}: network '{}'", reader.dir(), file.name),
                        use.agent == "rc" ? rfnn::kRcNetwork : rfnn::kRobotNetwork);
    const std::filesystem::path path = folder / names.at(use.sha256);
    WriteFile(path, rfnn::OnnxBytes(model));
    fmt::print("{}: {}\n", path.string(), file.name);
  }
}

int Export(const Options& options) {
  if (!options.csv && !options.numpy && !options.networks)
    throw UserError("ed3r export: nothing to write; allowed: --csv, --numpy, --networks, or several");
  store::ResultReader reader(options.dir);
  const std::filesystem::path folder = options.out.empty() ? std::filesystem::path(options.dir) / "export"
                                                           : std::filesystem::path(options.out);
  const auto tables = [&](exports::ExportFormat format) {
    for (const exports::ExportedTable& table : exports::ExportTables(reader, format, folder))
      fmt::print("{}: {}\n", table.file.string(), Counted(table.rows, "row"));
  };
  if (options.csv) tables(exports::ExportFormat::kCsv);
  if (options.numpy) tables(exports::ExportFormat::kNumpy);
  if (options.networks) ExportNetworks(reader, folder);
  return kDone;
}

}  // namespace

Command AddExport(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "export", "Missions and timesteps as tables for other tools, networks as ONNX files");
  parser.Option("DIR", options->dir, "Run directory").Required();
  parser.Flag("--csv", options->csv, "missions.csv and timesteps.csv");
  parser.Flag("--numpy", options->numpy, "missions.npy and timesteps.npy: structured arrays");
  parser.Flag("--networks", options->networks,
              "The networks that flew, for networks.rc and networks.robot of another sweep");
  parser.Option("--out", options->out, "Folder to write to; default DIR/export").Path();
  parser.Footer(
      "Columns have their units in their names; stage, arm, outcome, motion_rule and execution are words. "
      "Parquet is not "
      "written: Debian 12 packages no library for it.");
  return {parser, [options] { return Export(*options); }};
}

}  // namespace ed3r::app
