// Stored results by column.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/store/reader.h"
#include "engine/store/shards/gathered_shards.h"

namespace ed3r::python {

// One column of a table: integers or reals.
struct ResultColumn {
  std::string name;
  bool is_real = false;
  std::vector<std::int64_t> integers = {};
  std::vector<double> reals = {};
};

struct ArmCount {
  std::string stage, arm;
  std::int64_t planned = 0, done = 0, failed = 0;
};

// Reads a run directory; every mission is compared with its checksum. Shards that are not merged are joined when it is opened.
// Throws UserError, also where the directory holds another run than when it was opened.
class RunReader {
 public:
  explicit RunReader(const std::string& dir) : dir_(dir), run_(dir), reader_(run_.dir()) {}

  const std::string& Name() const { return reader_.Layout().name; }
  const std::vector<std::string>& Notes() const { return run_.notes(); }  // on shards that are not counted
  std::vector<ArmCount> Arms();

  // Of the arm "ARM", which one stage alone may have, or "STAGE/ARM", or of all ("") in plan order. The columns "arm" (index into Arms()) and "mission",
  // then those of MissionRecord or TimestepRecord.
  std::vector<ResultColumn> Missions(const std::string& arm);
  std::vector<ResultColumn> Timesteps(const std::string& arm);

  std::string ReportText();  // the JSON of 'ed3r report --json'
  std::string Digest();

 private:
  std::vector<sweep::RunId> Selected(const std::string& arm) const;
  // Takes stages that fly nothing out. UserError where several are left.
  void CheckOneStage(const std::string& arm, std::vector<sweep::RunId>& selected) const;

  std::string dir_;
  store::GatheredShards run_;
  store::ResultReader reader_;
};

// What the codes of stored columns stand for: {"outcome": {0: "success", ...}, ...}.
std::map<std::string, std::map<std::int64_t, std::string>> CodeNames();

}  // namespace ed3r::python
