// What made the results of a run directory.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace ed3r {

// Stores may be continued and merged only when all but the notes is equal.
struct Recipe {
  std::string plan_text;                      // SweepPlan::CanonicalText()
  std::string code_version;                   // commit, with a dirty flag and source hash
  std::map<std::string, std::string> inputs;  // world files, detectors -> fingerprint
  // What may differ from session to session and changes no result: compiler, CPU, SIMD level, threads,
  // library versions.
  std::map<std::string, std::string> notes;
};

// Half a sentence on the first thing that differs ("the code is 4be1+dirty there and 9c02 here"), or nothing
// when results of both belong together.
std::optional<std::string> Difference(const Recipe& there, const Recipe& here);

}  // namespace ed3r
