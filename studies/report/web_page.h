// index.html with everything in it: style, program, libraries and data. Opens from a folder, asks no host for anything.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace ed3r::report {

// What `scripts/setup --web` makes of studies/report/web/.
struct WebBundle {
  std::string script, style;
};

struct FoundBundle {
  std::optional<WebBundle> bundle;
  std::string why_not;  // one sentence with the command that makes it
};

// NAME.js and NAME.css ("report", "viewer") in $ED3R_WEB, else in build/web of the source tree that this program was
// built from.
FoundBundle FindWebBundle(const std::string& name);

// What the title of a mission's page ends with, after STAGE/ARM/NUMBER.
inline constexpr char kMissionTitle[] = " – ED³R mission";

// `plain` is what browsers without scripts show, HTML already. Data and title are escaped here.
std::string SelfContainedPage(const std::string& title, const WebBundle& bundle,
                              const nlohmann::ordered_json& data, const std::string& plain);

}  // namespace ed3r::report
