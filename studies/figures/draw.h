// Draws figures by calling a script of scripts/.
#pragma once

#include <string>

namespace ed3r::figures {

enum class Drawing {
  kDone,
  kUnavailable,  // no interpreter, no script or no matplotlib: the data is there, the pictures are not
  kFailed
};

struct DrawResult {
  Drawing outcome = Drawing::kDone;
  std::string message;  // one line where it is not done
};

// Lets a script ("plot.py": data.json, "plot_fit.py": fit.json and its tables) turn a folder's data into pictures beside
// them. It works on copies in a folder of its own, from which the pictures are moved. The interpreter is $ED3R_PYTHON,
// else /usr/bin/python3 (whose packages Debian installs); the script lies in $ED3R_SCRIPTS, else in the scripts/ of the
// source tree that this program was built from. Takes some seconds; one call at a time per folder. Throws UserError where
// the folder cannot be written.
DrawResult DrawFigures(const std::string& folder, const std::string& script = "plot.py");

}  // namespace ed3r::figures
