// The networks that flew, kept with what they flew. Their content is the business of whoever trains them: here each is a
// name, the bytes of a model file and the hash of what it computes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/store/layout.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

struct NetworkFile {
  std::string name;   // for people
  std::string model;  // a whole model file
};

// Which network an arm asks with which of its training seeds.
struct NetworkUse {
  int stage = 0, arm = 0, seed = 0;
  std::string agent;  // "rc" or "robot"
  std::string sha256;
};

struct FlownNetworks {
  std::map<std::string, NetworkFile> files;  // by sha256
  std::vector<NetworkUse> uses;              // by stage, arm, seed, agent
};

// Adds them. UserError when the file says that an arm has flown with another network. Call it in a transaction.
void PutNetworks(Connection& database, const RunLayout& layout, const FlownNetworks& networks);

// None in files of format 1. UserError when the tables do not fit together.
FlownNetworks ReadNetworks(Connection& database, const RunLayout& layout);

}  // namespace ed3r::store
