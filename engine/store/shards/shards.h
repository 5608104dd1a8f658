// Where the tasks of a batch system leave their stores: RUN/shards/STAGE/TASK, one folder each.
#pragma once

#include <string>
#include <vector>

namespace ed3r::store {

// Whether DIR has a results file that is not empty. UserError where that cannot be seen.
bool HoldsResults(const std::string& dir);

// Folders below RUN/shards with a results file that is not empty, in order of their names. None where there is no such
// folder; UserError where one cannot be looked into.
std::vector<std::string> ShardDirs(const std::string& run_dir);
std::vector<std::string> ShardDirs(const std::string& run_dir, const std::string& stage);
// Those whose file is empty: of a task that was killed at its very start, or cut.
std::vector<std::string> EmptyShardDirs(const std::string& run_dir);

}  // namespace ed3r::store
