// Where results come from: what a reader needs to make them again.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "engine/store/reader.h"

namespace ed3r::report {

struct Provenance {
  std::string dir, sweep;
  std::string sweep_file, command;  // of the last of `sessions`; "" where it left no notes
  std::string question;  // of the study, from its notes or its sweep file where that is still there; or ""
  std::string seed;
  std::string code_version;   // identity of the code that decided results, by subsystem
  bool mixed_code = false;    // several versions of one subsystem flew
  bool unchecked = false;     // its missions have no checksums (format 1)
  std::string time_by_phase;  // of the last session that was flown with --profile; "" where none
  std::string commit;         // of the last of `sessions`; "unknown" outside a checkout
  std::string digest;         // of what is stored
  std::vector<store::ArmStatus> status;
  std::vector<std::pair<std::string, std::string>>
      broken;  // missions that threw inside the program, with their own words
  std::int64_t planned = 0, stored = 0, failed = 0;
  double simulated_h = 0;                     // flown time of all missions
  double wall_h = 0;                          // spent on them, summed over threads
  std::map<std::string, std::string> inputs;  // file -> fingerprint
  struct Session {
    std::string host, begun_utc, ended_utc;
    std::map<std::string, std::string> notes;  // machine, compiler, libraries
  };
  // In order of their begin; those that found everything flown already are left out, as they made nothing.
  std::vector<Session> sessions;
};

// Of a store whose `digest` is known (ResultReader::CheckWhole); `called`: the run's name for people.
Provenance ReadProvenance(store::ResultReader& reader, const std::string& digest, const std::string& called);

// What made the results: {"sweep", "command", "seed", "code", "commit", "digest", "missions", "failed", "simulated_h",
// "wall_h", "inputs", "machine": the last session's notes}. Without hosts and times of day.
nlohmann::ordered_json ManifestJson(const Provenance& provenance);

}  // namespace ed3r::report
