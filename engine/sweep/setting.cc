#include "engine/sweep/setting.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "engine/config/parameters.h"

namespace ed3r::sweep {
namespace {

// Null for what is no file, and for an unknown key.
const ParameterInfo* FindFileKey(std::string_view key) {
  const std::vector<ParameterInfo>& all = Parameters();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const ParameterInfo& p) { return p.key == key; });
  return found == all.end() || !found->is_file ? nullptr : &*found;
}

std::filesystem::path Absolute(const std::string& path, const std::string& at) {
  std::error_code error;
  // "" is the present folder, which std::filesystem::absolute does not take.
  const std::filesystem::path absolute = std::filesystem::absolute(path.empty() ? "." : path, error);
  if (error) FailAt(at, fmt::format("'{}': {}", path, error.message()));
  return (absolute / "").lexically_normal();
}

}  // namespace

std::string FullKey(std::string_view written) {
  return written == "strategy" ? "mission.strategy" : std::string(written);
}

std::string FolderOf(const std::string& file) { return std::filesystem::path(file).parent_path().string(); }

std::string PathFrom(const std::string& folder, const std::string& written) {
  return (std::filesystem::path(folder) / written).lexically_normal().string();
}

Setting SettingReader::Read(const std::string& written_key, const std::string& key_at,
                            const std::string& text, const std::string& at) const {
  Setting setting{FullKey(written_key), text, text, at};
  const auto& keys = ParameterKeys();
  const bool known = std::find(keys.begin(), keys.end(), setting.key) != keys.end();
  Config scratch;
  if (const std::string problem = SetParameter(scratch, setting.key, text); !problem.empty())
    FailAt(known ? at : key_at, problem);
  if (check_) {
    if (const std::string problem = check_(setting.key, text); !problem.empty()) FailAt(at, problem);
  }
  if (NamesAFile(setting.key) && text != FileNotNeeded(setting.key)) {
    ResolveFile(setting);
  } else {
    setting.text = setting.canonical = GetParameter(scratch, setting.key);  // 1e0, 1.0 and 1 are one value
  }
  return setting;
}

bool NamesAFile(std::string_view key) { return FindFileKey(key) != nullptr; }

std::string_view FileNotNeeded(std::string_view key) {
  const ParameterInfo* found = FindFileKey(key);
  return found == nullptr ? std::string_view() : found->or_else;
}

void SettingReader::ResolveFile(Setting& setting) const {
  const std::filesystem::path written(setting.text);
  setting.text = PathFrom(folder_, setting.text);
  const std::string_view other = FileNotNeeded(setting.key);
  std::error_code error;
  if (!std::filesystem::is_regular_file(setting.text, error))
    FailAt(setting.at,
           fmt::format("{}: '{}' is not a file; looked for '{}'{}", setting.key, setting.canonical,
                       setting.text, other.empty() ? "" : fmt::format("; '{}' is allowed too", other)));
  if (written.is_absolute() || keep_absolute_) {
    setting.canonical = setting.text;
  } else {
    // Both ends absolute: the path must not depend on how the command named the sweep file.
    std::filesystem::path target = Absolute(FolderOf(setting.text), setting.at);
    target /= std::filesystem::path(setting.text).filename();
    setting.canonical = target.lexically_relative(Absolute(top_folder_, setting.at)).generic_string();
  }
}

bool NameAnAirframe(const std::vector<Setting>& settings) {
  return std::any_of(settings.begin(), settings.end(),
                     [](const Setting& setting) { return !setting.airframe_at.empty(); });
}

std::vector<Setting> WithoutAirframe(std::vector<Setting> settings) {
  std::erase_if(settings, [](const Setting& setting) { return !setting.airframe_at.empty(); });
  return settings;
}

std::vector<Setting> ReadAirframeFile(const std::string& path, const std::string& at,
                                      std::vector<std::string> above) {
  constexpr std::size_t kMaxAirframes = 20;
  std::error_code error;
  for (const std::string& file : above)
    if (std::filesystem::equivalent(file, path, error))
      FailAt(at, fmt::format("robot: '{}' is not allowed; it includes this file", path));
  if (above.size() == kMaxAirframes)
    FailAt(at, fmt::format("robot: '{}' is one file too many; allowed: a chain of at most {}", path,
                           kMaxAirframes));
  above.push_back(path);
  if (!std::filesystem::is_regular_file(path, error))
    FailAt(at,
           fmt::format("robot: '{}' is not a file; allowed: an airframe file as 'ed3r fit --out' writes it",
                       path));
  std::vector<Setting> settings = SettingReader(FolderOf(path), FolderOf(path), false, {}, std::move(above))
                                      .ReadMap(ReadYamlFile(path).root, "an airframe file");
  if (settings.empty())
    FailAt(at, fmt::format("robot: '{}' sets nothing; allowed: an airframe file with a key at least", path));
  for (Setting& setting : settings) {
    setting.is_default = true;
    setting.airframe_at = at;
    const std::string subject = setting.key.substr(0, setting.key.find('.'));
    if (subject != "robot" && subject != "energy" && subject != "environment" && subject != "cpu")
      FailAt(setting.at,
             fmt::format(
                 "{}: is not allowed in an airframe file; allowed: robot.*, energy.*, environment.*, cpu.*",
                 setting.key));
  }
  return settings;
}

std::vector<Setting> SettingReader::ReadMap(const YamlNode& map, std::string_view what,
                                            const std::vector<std::string>& skipped) const {
  if (map.kind != YamlNode::Kind::kMap)
    FailAt(map.at, fmt::format("{}: {} is not allowed; allowed: a map of parameters", what, Described(map)));
  std::vector<Setting> settings;
  AppendMap(map, "", skipped, settings);
  std::map<std::string, std::string> places;
  for (const Setting& setting : settings) {
    const auto [first, is_new] = places.emplace(setting.key, setting.at);
    if (!is_new)
      FailAt(setting.at, fmt::format("{}: duplicate key; it stands first at {}", setting.key, first->second));
  }
  return settings;
}

void SettingReader::AppendMap(const YamlNode& map, const std::string& prefix,
                              const std::vector<std::string>& skipped, std::vector<Setting>& settings) const {
  for (const YamlEntry& entry : map.entries) {
    if (std::find(skipped.begin(), skipped.end(), entry.key) != skipped.end()) continue;
    const std::string key = prefix + entry.key;
    if (entry.value.kind == YamlNode::Kind::kMap) {
      AppendMap(entry.value, key + ".", {}, settings);
    } else if (key == kAirframeKey && entry.value.kind == YamlNode::Kind::kScalar) {
      for (Setting& setting :
           ReadAirframeFile(PathFrom(folder_, entry.value.text), entry.value.at, airframes_))
        settings.push_back(std::move(setting));
    } else if (entry.value.kind == YamlNode::Kind::kScalar) {
      settings.push_back(Read(key, entry.at, entry.value.text, entry.value.at));
    } else {
      FailAt(entry.value.at,
             fmt::format("{}: {} is not allowed here; allowed: one value (several make an axis, "
                         "under sweep)",
                         FullKey(key), Described(entry.value)));
    }
  }
}

}  // namespace ed3r::sweep
