// A sweep file as written, its base files merged underneath, before expansion.
//
// Merging: settings of `set` one by one, the nearer file's winning; `missions`, `precision`, `seed`, `sweep`, `where` and
// `stages` each as a whole. `name` and the question are the top file's own. An axis replaces a base file's
// setting of the same key.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/sweep/axis.h"
#include "engine/sweep/condition.h"
#include "engine/sweep/plan.h"
#include "engine/sweep/setting.h"

namespace ed3r::sweep {

struct WrittenCount {
  int value = 0;
  std::string at;
};

struct WrittenTimesteps {
  KeptTimesteps kept = KeptTimesteps::kAll;
  std::string at;
};

// What the top level of a file and each of its stages have in common.
struct SweepSection {
  std::optional<WrittenCount> missions;
  std::optional<Precision> precision;
  std::vector<Setting> set;
  std::optional<std::vector<Axis>> axes;
  std::optional<std::vector<Condition>> where;
  std::optional<WrittenTimesteps> timesteps;
};

struct StageSource {
  std::string name;
  std::string at;
  StageKind kind = StageKind::kFly;
  std::vector<std::string> after;
  SweepSection section;
};

struct SweepSource {
  std::string file;
  std::string at;  // where its first key stands
  std::string question;
  std::optional<std::string> name;
  std::optional<std::uint64_t> seed;
  SweepSection top;
  std::optional<std::vector<StageSource>> stages;
};

// Throws UserError.
SweepSource ReadSweepSource(const std::string& file, const ValueCheck& check);

// Settings of `under` that `over` does not set, then those of `over`. An airframe file of `over` replaces one of `under`
// with all that it brought.
std::vector<Setting> MergedSettings(const std::vector<Setting>& under, const std::vector<Setting>& over);

// The settings, those whose keys are on the axes as defaults that these vary.
std::vector<Setting> DefaultsOf(std::vector<Setting> settings, const std::vector<Axis>& axes);

}  // namespace ed3r::sweep
