// Seals: beside its checksum each mission has a hash of that checksum, of the recipe that it was flown by and of the networks that
// it asked, so that a mission of another run is known, whole as it is. A run may grow, and be continued by other code on purpose,
// and its missions stay what they were: a file keeps a hash of every recipe that it has had, its origins.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/store/recipe.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

// False in files that were begun before missions had seals.
bool HasSeals(Connection& database);

// In the order in which they came, the present one last; none in files of before. Within a transaction of the caller's, who
// seals the recipe afterwards.
std::vector<std::string> ReadOrigins(Connection& database);
void WriteOrigins(Connection& database, const std::vector<std::string>& origins);

// The same with this recipe's plan, inputs and code as the present one.
std::vector<std::string> WithOrigin(std::vector<std::string> origins, const Recipe& recipe);

// Makes and compares the seals of one file. Threads: one at a time, as its connection.
class Seals {
 public:
  explicit Seals(Connection& database);

  bool there() const { return there_; }

  // Of a mission with this checksum, by the recipe that the file has now. `run` is its arm's key and `network` the training seed
  // that it asked, -1 for none: their networks must have been put.
  std::string Of(const std::string& mission_checksum, std::int64_t run, std::int64_t network);
  // Whether it is one by any recipe that the file has had.
  bool Fits(const std::string& mission_checksum, std::int64_t run, std::int64_t network,
            const std::string& seal);

 private:
  const std::string& NetworksOf(std::int64_t run, std::int64_t network);

  bool there_;
  std::vector<std::string> origins_;
  Statement select_networks_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::string> networks_;  // once put they stay
};

}  // namespace ed3r::store
