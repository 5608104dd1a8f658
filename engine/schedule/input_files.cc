#include "engine/schedule/input_files.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/core/sha256.h"
#include "engine/sweep/setting.h"
#include "engine/world/world_file.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

fs::path Located(const std::string& file) { return fs::absolute(file).lexically_normal(); }

// What the arms call a file -> where it lies.
std::map<std::string, fs::path> CalledFiles(const SweepPlan& plan) {
  std::map<std::string, fs::path> called;
  for (const Stage& stage : plan.stages)
    for (const Arm& arm : stage.arms)
      for (const std::string& key : ParameterKeys()) {
        if (!NamesAFile(key)) continue;
        const std::string path = GetParameter(arm.config, key);
        if (path != FileNotNeeded(key)) called[GetParameter(arm.CanonicalConfig(), key)] = Located(path);
      }
  return called;
}

std::set<std::string> Worlds(const SweepPlan& plan) {
  std::set<std::string> worlds;
  for (const Stage& stage : plan.stages)
    for (const Arm& arm : stage.arms) worlds.insert(arm.config.mission.world);
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

InputFile Kept(const fs::path& path, const std::string& name) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  if (!in) throw UserError(fmt::format("{}: cannot be read", path.string()));
  Sha256 sha;
  sha.Update(bytes);
  InputFile file{name, sha.Hex(), std::nullopt};
  if (static_cast<std::int64_t>(bytes.size()) <= kLargestKeptFile) file.content = std::move(bytes);
  return file;
}

}  // namespace

InputFiles ReadInputFiles(const SweepPlan& plan) {
  const std::map<std::string, fs::path> called = CalledFiles(plan);
  std::set<fs::path> paths;
  for (const auto& [name, path] : called) paths.insert(path);
  for (const std::string& world : Worlds(plan)) {
    const WorldSpec spec = ReadWorldFile(world);
    for (const std::string& base : spec.bases) paths.insert(Located(base));
    if (spec.grid) paths.insert(Located(spec.grid->file));
    if (spec.forest && spec.forest->stem_map) paths.insert(Located(spec.forest->stem_map->file));
  }
  InputFiles kept;
  if (paths.empty()) return kept;
  const fs::path folder = CommonFolder(paths);
  for (const fs::path& path : paths)
    kept.files.push_back(Kept(path, path.lexically_relative(folder).string()));
  for (const auto& [name, path] : called) kept.places[name] = path.lexically_relative(folder).string();
  return kept;
}

}  // namespace ed3r
