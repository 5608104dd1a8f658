// Which code this is. Generated at build time from the source tree.
#pragma once

namespace ed3r {

struct CodeVersion {
  const char* release;      // e.g. 1.0.0, of CMakeLists.txt
  const char* source_hash;  // of all four below
  // Of the sources that can decide a result, comments and layout apart, by subsystem: equal hashes give equal results.
  // cmake/code_identity.py says which source belongs where.
  const char* flight;  // every mission: world, robot, radio, perception on the profile tier, agents, schedule
  const char* pixels;  // missions that look at pixels: renderer, detectors
  const char* training;   // networks
  const char* precision;  // where an arm with a precision stops: metrics, statistics
  const char* commit;     // "unknown" outside a git checkout
  bool dirty;             // the checkout had uncommitted changes
  const char* compiler;
  const char* flags;
};

CodeVersion ThisCode();

}  // namespace ed3r
