// Fingerprints of results. They depend on what was flown and on nothing else: not on threads, order, shards,
// interruptions, times, machine, or the way in which SQLite laid it out.
#pragma once

#include <string>

#include "engine/core/sha256.h"
#include "engine/mission/record.h"
#include "engine/sweep/plan.h"

namespace ed3r::store {

class ResultReader;

// The bytes of one record with its timesteps that enter a digest: each column by Describe(), eight bytes,
// least significant first. Two records are identical when these are. The same before storing and after
// reading back.
std::string CanonicalBytes(const mission::MissionRecord& record);

// SHA-256 of CanonicalBytes in hexadecimal.
std::string DigestOf(const mission::MissionRecord& record);

// The digest of a store, of its missions in canonical order.
class ResultDigest {
 public:
  // `reader` must outlive it.
  explicit ResultDigest(const ResultReader& reader);
  // With its timesteps; `checksum` is "" in files of format 1.
  void Add(const sweep::RunId& id, const mission::MissionRecord& record, const std::string& checksum);
  // The last call.
  std::string Hex() { return sha_.Hex(); }

 private:
  const ResultReader& reader_;
  Sha256 sha_;
};

// SHA-256 of everything stored: the format's name; then each finished mission's checksum (checksums.h, hexadecimal), by
// stage, arm and mission, each compared with what it is the checksum of. Failures, sessions and timings are not part of
// it. Files of format 1 have no checksums: there it is over the column names and, for each mission, the names of stage
// and arm, its number, its columns and its timesteps by k, so that they keep the digest with which they were published.
std::string DigestOf(ResultReader& reader);

}  // namespace ed3r::store
