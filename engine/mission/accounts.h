// From what happened to what is recorded: filling timestep records and summing them.
#pragma once

#include "engine/agents/remote_controller.h"
#include "engine/agents/robot_agent.h"
#include "engine/mission/record.h"
#include "engine/mission/scenario.h"
#include "engine/radio/link.h"
#include "engine/robot/ledger.h"

namespace ed3r::mission {

TimestepRecord OpenStep(std::uint32_t k, const agents::MotionDecision& motion, const robot::FlownMove& move,
                        const agents::ExecutionDecision& execution);
void RecordLink(const Conditions& conditions, double rc_distance_m, const radio::Link& link,
                TimestepRecord& step);
void RecordLedger(const robot::StepTime& time, const robot::StepEnergy& energy, double battery_left_j,
                  TimestepRecord& step);

// Of one timestep: all movement, hovering included, and all of its time.
double MovementJ(const TimestepRecord& step);
double DurationS(const TimestepRecord& step);

// Fills every sum of the mission from its steps.
void SumSteps(double eta_min, MissionRecord& record);

}  // namespace ed3r::mission
