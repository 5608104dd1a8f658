// What `ed3r status` says of missions that have failed or are damaged.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/store/layout.h"
#include "engine/store/records.h"

namespace ed3r::app {

// One block per kind, the largest first: how many, and the first of them. "" for none.
std::string FailuresText(const store::RunLayout& layout, const std::vector<store::FailedMission>& failures);
// Every failure; and how many there are of each kind, the largest first.
nlohmann::ordered_json FailuresJson(const store::RunLayout& layout,
                                    const std::vector<store::FailedMission>& failures);
nlohmann::ordered_json FailureKindsJson(const std::vector<store::FailedMission>& failures);

}  // namespace ed3r::app
