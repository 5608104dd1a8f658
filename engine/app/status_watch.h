// `ed3r status --watch` and `--html FILE`: a run that is going on, until it has come to its end.
#pragma once

#include <string>
#include <vector>

#include "engine/store/reader.h"

namespace ed3r::app {

// One look at a run. `seconds` since the first look, and what was done then, give rates and the expected end.
struct StatusLook {
  std::string name;
  std::vector<store::ArmStatus> arms;
  struct Known {
    std::string stage, arm;
    std::string success, energy;  // "97.7 ± 1.6 %"; "" before two missions
  };
  std::vector<Known> known;  // of the arms with missions
  std::int64_t done_at_first = 0;
  double seconds = 0;

  std::int64_t Done() const;
  std::int64_t Missing() const;
  // Missions a minute since the first look; 0 before any came.
  double PerMinute() const;
  // "about 12 min" or "" where nothing tells.
  std::string Left() const;
};

// Shards that are not merged count, too; nothing is `known` of their arms then.
StatusLook LookAt(const std::string& dir);

// For a terminal; every line ends with a line feed.
std::string StatusText(const StatusLook& look);

// A page that asks for itself again every `seconds`; once nothing is missing it no longer does. Every value is escaped.
std::string StatusPage(const StatusLook& look, int seconds);

struct WatchOptions {
  std::string dir;
  bool terminal = false;
  std::string html;  // file; "" for none
  int seconds = 5;
};

// Looks every `seconds` until nothing is missing or Ctrl-C; returns the exit status. Throws UserError as ResultReader.
int WatchStatus(const WatchOptions& options);

}  // namespace ed3r::app
