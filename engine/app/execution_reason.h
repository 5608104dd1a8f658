// Why the robot executed a detection where and how it did (decision-making stage 2), for `ed3r explain`.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/mission/mission.h"

namespace ed3r::app {

// Lines, each indented by two: the rule's inputs of a rule-based arm, the predicted rewards where a network was asked,
// then "> " and the choice with what made it. The probe must have been reached by a flight of the task.
std::string ExecutionText(const mission::MissionTask& task, const mission::DecisionProbe& probe);

// The same as members "execution", "execution_by" (rules | network | draw | strategy) and, where they exist, "rules"
// and "robot_predicted_rewards".
void AddExecution(const mission::MissionTask& task, const mission::DecisionProbe& probe,
                  nlohmann::ordered_json& object);

}  // namespace ed3r::app
