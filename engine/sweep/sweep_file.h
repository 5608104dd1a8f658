// Sweep files (YAML): strict parse and expansion into a SweepPlan.
//
//   # Does the threshold pay?                the first line's comment is the study's question
//   name: thresholds                         of the study and of its results
//   base: paper_base.yaml                    optional: another sweep file, merged underneath
//   missions: 850                            per arm
//   precision: {metric: msr_pct, half_width: 1.5}            optional: an arm stops when it is known this well (plan.h)
//   store: {timesteps: none}                 optional: whose timesteps are stored: all | failed | none (kept_timesteps.h)
//   seed: 20260101                           64 bits; 0 when nobody says
//   set: {robot.speed_mps: 4}                fixed values; `ed3r params` lists the keys; may nest
//   sweep:                                   axes, see axis.h; `strategy` is short for mission.strategy
//     strategy: [rbs, ed3r]
//     agents.eta_min: [0.65, 0.75, 0.85]
//   where: [strategy == ed3r or agents.eta_min == 0.75]      all must hold, see condition.h
//
// Without stages there is one, "online", with all of the above. Stages that build on one another:
//
//   stages:
//     - {name: warmup, missions: 2040, set: {strategy: random}}
//     - {name: training, kind: train, after: warmup, sweep: {agents.eta_min: [0.65, 0.75]}}
//     - {name: online, after: [training], set: {strategy: ed3r}, sweep: {agents.eta_min: [0.65, 0.75]}}
//
// A stage's set, sweep and where add to those of the top level; its values win over those of the top level's
// set. Merging of base files: sweep_source.h. Names of arms: arm_name.h. Files (worlds, detectors) are relative
// to the file that they are written in, after --set to the present folder; the default world to the sweep file.
// Anything else is refused: unknown and duplicate keys, wrong types, values out of range, empty axes, a fixed
// value or --set for a parameter that an axis varies, YAML anchors, aliases and tags (yaml_reader.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/sweep/plan.h"
#include "engine/sweep/setting.h"

namespace ed3r::sweep {

struct MissionsOverride {
  std::string stage;  // "" for every flying stage that no other override names
  int value = 0;      // per arm
};

struct SweepOverrides {
  std::vector<std::string> set;  // "key=value", each key once; wins over every `set`, but may not set an axis
  std::optional<std::uint64_t> seed;
  std::vector<MissionsOverride> missions;
};

constexpr std::int64_t kMaxMissions = 10'000'000;  // a plan with more is refused
constexpr int kMaxArms = 10'000;                   // in all stages, counted before `where`

// Reads, checks and expands. `check` sees every value that is written, for what only a later layer knows (the
// names of the strategies). Throws UserError with one line "file:line:column: ..." (or "--set ...: ...") that
// names the key, the value, the allowed range and the nearest known key. Reads only; writes nothing.
// Threads: may be called from any thread; nothing is shared.
SweepPlan LoadSweep(const std::string& file, const SweepOverrides& overrides = {},
                    const ValueCheck& check = {});

}  // namespace ed3r::sweep
