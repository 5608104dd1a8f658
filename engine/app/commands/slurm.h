// The command that writes batch scripts; see commands.h.
#pragma once

#include "engine/app/commands.h"

namespace ed3r::app {

Command AddSlurm(Program& program);

}  // namespace ed3r::app
