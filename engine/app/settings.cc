#include "engine/app/settings.h"

#include <fmt/format.h>

#include "engine/core/check.h"
#include "engine/sweep/setting.h"

namespace ed3r::app {

void ApplySettings(const std::vector<std::string>& settings, Scope scope, Config& config) {
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos || equals == 0)
      throw UserError(fmt::format("--set {}: expected KEY=VALUE, e.g. robot.mass_kg=2.1", setting));
    if (setting.substr(0, equals) == sweep::kAirframeKey) {
      for (const sweep::Setting& part :
           sweep::ReadAirframeFile(setting.substr(equals + 1), "--set " + setting))
        if (const std::string problem = SetParameter(config, part.key, part.text, scope); !problem.empty())
          throw UserError(fmt::format("--set {}: {}", setting, problem));
      continue;
    }
    const std::string problem =
        SetParameter(config, setting.substr(0, equals), std::string_view(setting).substr(equals + 1), scope);
    if (!problem.empty()) throw UserError(fmt::format("--set {}: {}", setting, problem));
  }
  if (const std::string problem = CheckParameters(config); !problem.empty())
    throw UserError(fmt::format("--set: {}", problem));
}

}  // namespace ed3r::app
