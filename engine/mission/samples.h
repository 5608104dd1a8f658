// Warm-up missions as training rows of both networks (paper: Offline Warmup Phase, Data Logging; R17, R18).
#pragma once

#include "engine/config/config.h"
#include "engine/mission/record.h"
#include "engine/rfnn/data_set.h"

namespace ed3r::mission {

// Appends one row per timestep: what each agent saw, what it did, and the reward as `agents` would give it. The
// reward is recomputed, so that one warm-up log serves every eta_min. `mission_id` keeps the rows of a mission together
// when a data set is split. `flown` is the configuration that the mission was flown with.
void AppendSamples(const MissionRecord& record, std::int64_t mission_id, const Config& flown,
                   const AgentsConfig& agents, rfnn::DataSet& rc, rfnn::DataSet& robot);

}  // namespace ed3r::mission
