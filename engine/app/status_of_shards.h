// The status of a run whose missions lie in many stores: the merged run and the shards of a batch system's tasks.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/store/reader.h"

namespace ed3r::app {

// As 'ed3r status --json' lists them.
nlohmann::ordered_json ArmsJson(const std::vector<store::ArmStatus>& arms);

// Whether there are shards, or more missions than can be compared with their checksums in a second.
bool IsTallied(const std::string& dir);

// Prints missions done, failed and missing over all stores, how many stores grow at present, which of them cannot be read, and
// when all should be done by the pace of those that grow. Returns kDone, or kFailedInside where a store cannot be read.
int TellTally(const std::string& dir, bool json);

}  // namespace ed3r::app
