#include "engine/app/settings.h"

#include <fmt/format.h>

#include <map>

#include "engine/core/check.h"
#include "engine/sweep/setting.h"

namespace ed3r::app {

namespace {

using Places = std::map<std::string, std::string>;  // key to the --set that gave it

void Remember(const std::string& key, const std::string& setting, Places& places) {
  const auto [first, is_new] = places.emplace(key, setting);
  if (!is_new)
    throw UserError(
        fmt::format("--set {}: {}: is set twice, first by --set {}", setting, key, first->second));
}

}  // namespace

void CheckSetOnce(const std::vector<std::string>& settings) {
  Places places;
  for (const std::string& setting : settings) Remember(setting.substr(0, setting.find('=')), setting, places);
}

void ApplySettings(const std::vector<std::string>& settings, Scope scope, Config& config) {
  Places places;
  const auto set = [&](const std::string& setting, const std::string& key, std::string_view value) {
    if (const std::string problem = SetParameter(config, key, value, scope); !problem.empty())
      throw UserError(fmt::format("--set {}: {}", setting, problem));
    Remember(key, setting, places);
  };
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos || equals == 0)
      throw UserError(fmt::format("--set {}: expected KEY=VALUE, e.g. robot.mass_kg=2.1", setting));
    if (setting.substr(0, equals) != sweep::kAirframeKey) {
      set(setting, setting.substr(0, equals), std::string_view(setting).substr(equals + 1));
      continue;
    }
    Remember(std::string(sweep::kAirframeKey), setting, places);
    for (const sweep::Setting& part : sweep::ReadAirframeFile(setting.substr(equals + 1), "--set " + setting))
      set(setting, part.key, part.text);
  }
  if (const std::string problem = CheckParameters(config); !problem.empty())
    throw UserError(fmt::format("--set: {}", problem));
}

}  // namespace ed3r::app
