// Errors in the words of Python: the engine's messages name options of the command line.
#pragma once

#include <string>

namespace ed3r::python {

// "--out" as "out", "--set KEY" as "settings: KEY", and so on for what ed3r.fly and ed3r.VectorEnv take; what they do not
// take is left out. Commands in quotes ('ed3r run SWEEP --repair') stay: they are for a terminal. Any thread.
std::string InPythonWords(const std::string& message);

}  // namespace ed3r::python
