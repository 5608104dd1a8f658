// A folder of its own for one test, and short ways to load what is written there.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/sweep/sweep_file.h"

namespace ed3r::sweep {

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "ed3r_sweep_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no scratch folder: " + pattern);
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::string& Path() const { return path_; }

  // Writes a file, with its folders, and returns its path.
  std::string Write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = std::filesystem::path(path_) / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  }

 private:
  std::string path_;
};

inline SweepPlan LoadText(const std::string& text, const SweepOverrides& overrides = {}) {
  const ScratchFolder scratch;
  return LoadSweep(scratch.Write("x.yaml", text), overrides);
}

// The message of the refusal, with the folder left out; fails the test when nothing is refused.
inline std::string Refusal(const std::string& text, const SweepOverrides& overrides = {}) {
  const ScratchFolder scratch;
  try {
    LoadSweep(scratch.Write("x.yaml", text), overrides);
  } catch (const UserError& error) {
    std::string message = error.what();
    const std::string folder = scratch.Path() + "/";
    for (std::size_t at; (at = message.find(folder)) != std::string::npos;) message.erase(at, folder.size());
    return message;
  }
  ADD_FAILURE() << "not refused:\n" << text;
  return "";
}

inline std::vector<std::string> ArmNames(const Stage& stage) {
  std::vector<std::string> names;
  for (const Arm& arm : stage.arms) names.push_back(arm.name);
  return names;
}

}  // namespace ed3r::sweep
