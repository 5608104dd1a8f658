// What made the results of a run directory.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace ed3r::store {

// The code that decided results, by subsystem ("flight", "training"): one identity, or several where a run was continued
// by other code on purpose. Files of format 1 know one subsystem, "sources".
using CodeIdentities = std::map<std::string, std::set<std::string>>;
inline constexpr const char* kMathLibrary =
    "libm";  // the subsystem that is not ours (engine/core/math_library.h)

// "flight 0123abcd, training 4567 and 89ab"
std::string CodeText(const CodeIdentities& code);

// Adds the identities of `other`: what was made by both.
void Join(CodeIdentities& code, const CodeIdentities& other);

// Whether any subsystem has several identities.
bool MixedCode(const CodeIdentities& code);

// What to do with a run that other code has begun: refuse it, or go on and remember both.
enum class OtherCode { kRefuse, kAccept };

// A file that missions read (a world, its elevation grid, a detector), kept with the results.
struct InputFile {
  std::string name;                    // relative to a folder that is common to all of them
  std::string sha256;                  // of its content
  std::optional<std::string> content;  // none where it is too large to be kept
  bool operator==(const InputFile&) const = default;
};

// The note in which a session tells where its time went, where that was asked.
inline constexpr const char* kProfileNote = "time by phase";

// Stores may be continued and merged only when all but files and notes is equal.
struct Recipe {
  std::string plan_text;  // SweepPlan::CanonicalText()
  CodeIdentities code;
  std::map<std::string, std::string> inputs = {};  // world files, detectors -> fingerprint
  // What the plan calls a file -> its name among `files`.
  std::map<std::string, std::string> places = {};
  std::vector<InputFile> files = {};
  // What may differ from session to session and changes no result: compiler, CPU, SIMD level, threads,
  // library versions.
  std::map<std::string, std::string> notes = {};
};

// Half a sentence on the first thing that differs ("the plan differs at its line 3: ..."), code aside, or nothing when
// results of both belong together.
std::optional<std::string> Difference(const Recipe& there, const Recipe& here);

// Likewise for the code: a subsystem of `here` whose identity is not among those of `there`, or that `there` lacks.
std::optional<std::string> CodeDifference(const CodeIdentities& there, const CodeIdentities& here);

}  // namespace ed3r::store
