// One parameter value as someone wrote it: in a sweep file's `set`, on an axis, or after --set.
// Errors: UserError, one line that starts with where it was written. Threads: nothing is shared.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/config/config.h"
#include "engine/core/files/yaml_reader.h"

namespace ed3r::sweep {

// A check that the parameters' own description cannot make, such as the names of the strategies, which a
// later layer knows: "" or a clause as SetParameter's ("mission.strategy: 'rsb' ...; did you mean rbs?").
using ValueCheck = std::function<std::string(const std::string& key, const std::string& value)>;

struct Setting {
  std::string key;        // full: "mission.strategy" even where "strategy" was written
  std::string text;       // read by SetParameter; a file is a path that can be opened from here
  std::string canonical;  // the same wherever the sweep lies: differs from text for files only
  std::string at;         // where the value was written
  // An axis may vary it, as nobody wrote it beside that axis: of an airframe file, a base file, the level above. Points of the
  // axis that do not name the key keep it.
  bool is_default = false;
  std::string airframe_at = {};  // of an airframe file: where that was named
};

// `robot: FILE` includes an airframe file; it is no parameter.
inline constexpr std::string_view kAirframeKey = "robot";

// `strategy` is short for mission.strategy; all other keys are written in full.
std::string FullKey(std::string_view written);

// The folder that holds a file, "" for the present one.
std::string FolderOf(const std::string& file);

// A path as it can be opened, when it is written in a file of this folder.
std::string PathFrom(const std::string& folder, const std::string& written);

// Whether a parameter may name a file: a world, a detector, a network. FileNotNeeded: the word that stands for none
// ("builtin" for detectors, "trained" for networks), "" for worlds.
bool NamesAFile(std::string_view key);
std::string_view FileNotNeeded(std::string_view key);

// Whether an airframe file brought any of them.
bool NameAnAirframe(const std::vector<Setting>& settings);

// Without those that an airframe file brought: another airframe file replaces it whole.
std::vector<Setting> WithoutAirframe(std::vector<Setting> settings);

// The parameters of an airframe file, which 'robot: FILE' includes: a YAML map of robot.*, energy.*, environment.* and
// cpu.* keys, as `ed3r fit` writes it. Positions are those in that file. `above`: the airframe files that include it.
std::vector<Setting> ReadAirframeFile(const std::string& path, const std::string& at,
                                      std::vector<std::string> above = {});

// Reads the settings of one file (or of the command line).
class SettingReader {
 public:
  // Paths are relative to `folder`. Their canonical form is relative to `top_folder`, the sweep file's,
  // unless they are absolute as written or `keep_absolute` says that the way to `folder` was. `airframes`: the file, if it is
  // an airframe's, and those that include it.
  SettingReader(std::string folder, std::string top_folder, bool keep_absolute, ValueCheck check,
                std::vector<std::string> airframes = {})
      : folder_(std::move(folder)),
        top_folder_(std::move(top_folder)),
        keep_absolute_(keep_absolute),
        check_(std::move(check)),
        airframes_(std::move(airframes)) {}

  // Checks key and value. `key_at` and `at` say where each was written.
  Setting Read(const std::string& written_key, const std::string& key_at, const std::string& text,
               const std::string& at) const;

  // A map of key: value; nested maps and dotted keys mean the same. Keys in `skipped` are left out.
  std::vector<Setting> ReadMap(const YamlNode& map, std::string_view what,
                               const std::vector<std::string>& skipped = {}) const;

 private:
  void AppendMap(const YamlNode& map, const std::string& prefix, const std::vector<std::string>& skipped,
                 std::vector<Setting>& settings) const;
  void ResolveFile(Setting& setting) const;

  std::string folder_;
  std::string top_folder_;
  bool keep_absolute_;
  ValueCheck check_;
  std::vector<std::string> airframes_;
};

}  // namespace ed3r::sweep
