#include "engine/schedule/input_files.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <set>
#include <vector>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/sha256.h"
#include "engine/sweep/setting.h"
#include "engine/world/terrain.h"
#include "engine/world/world_file.h"

namespace ed3r::schedule {
namespace {

namespace fs = std::filesystem;

fs::path Located(const std::string& file) { return fs::absolute(file).lexically_normal(); }

// What the arms call a file -> where it lies.
std::map<std::string, fs::path> CalledFiles(const sweep::SweepPlan& plan) {
  std::map<std::string, fs::path> called;
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms)
      for (const std::string& key : ParameterKeys()) {
        if (!sweep::NamesAFile(key)) continue;
        const std::string path = GetParameter(arm.config, key);
        if (path != sweep::FileNotNeeded(key))
          called[GetParameter(arm.CanonicalConfig(), key)] = Located(path);
      }
  return called;
}

std::set<std::string> Worlds(const sweep::SweepPlan& plan) {
  std::set<std::string> worlds;
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms) worlds.insert(arm.config.mission.world);
  return worlds;
}

// The deepest folder that holds all of them.
fs::path CommonFolder(const std::set<fs::path>& paths) {
  fs::path common = paths.begin()->parent_path();
  for (const fs::path& path : paths)
    while (common != common.root_path() && path.lexically_relative(common).string().starts_with(".."))
      common = common.parent_path();
  return common;
}

store::InputFile Kept(const fs::path& path, const std::string& name) {
  std::string bytes = ReadFile(path.string(), std::numeric_limits<std::uintmax_t>::max());
  Sha256 sha;
  sha.Update(bytes);
  store::InputFile file{name, sha.Hex(), std::nullopt};
  if (static_cast<std::int64_t>(bytes.size()) <= kLargestKeptFile) file.content = std::move(bytes);
  return file;
}

// What stands beside an elevation grid and says how it is to be read (.prj, .tfw, masks), where it will have to stand
// again -> where it lies: perhaps beside the file that a link leads to.
std::map<fs::path, fs::path> BesideGrid(const world::GridTerrainSpec& grid) {
  const fs::path place = Located(grid.file);
  std::map<fs::path, fs::path> beside;
  const std::vector<std::string> files = world::ElevationGridFiles(grid);
  const std::string stem = fs::path(files.front()).stem().string();
  for (std::size_t i = 1; i < files.size(); ++i) {
    std::string name = fs::path(files[i]).filename().string();
    if (name.starts_with(stem)) name.replace(0, stem.size(), place.stem().string());
    beside[place.parent_path() / name] = files[i];
  }
  return beside;
}

}  // namespace

InputFiles ReadInputFiles(const sweep::SweepPlan& plan) {
  const std::map<std::string, fs::path> called = CalledFiles(plan);
  std::set<fs::path> paths;
  std::map<fs::path, fs::path> elsewhere;
  for (const auto& [name, path] : called) paths.insert(path);
  for (const std::string& world : Worlds(plan)) {
    const world::WorldSpec spec = world::ReadWorldFile(world);
    for (const std::string& base : spec.bases) paths.insert(Located(base));
    if (spec.grid) {
      paths.insert(Located(spec.grid->file));
      for (const auto& [place, lies] : BesideGrid(*spec.grid)) {
        paths.insert(place);
        elsewhere[place] = lies;
      }
    }
    if (spec.forest && spec.forest->stem_map) paths.insert(Located(spec.forest->stem_map->file));
  }
  InputFiles kept;
  if (paths.empty()) return kept;
  const fs::path folder = CommonFolder(paths);
  for (const fs::path& path : paths) {
    const auto lies = elsewhere.find(path);
    kept.files.push_back(
        Kept(lies == elsewhere.end() ? path : lies->second, path.lexically_relative(folder).string()));
  }
  for (const auto& [name, path] : called) kept.places[name] = path.lexically_relative(folder).string();
  return kept;
}

}  // namespace ed3r::schedule
