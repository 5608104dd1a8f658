#include "engine/store/shape.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/check.h"
#include "engine/mission/record.h"
#include "engine/store/columns.h"

namespace ed3r::store {
namespace {

struct ColumnShape {
  std::string name;
  std::string_view type;
  int since = 1;          // the format that has it
  bool may_lack = false;  // it was added within its format, or readers know what to take in its place
};

struct TableShape {
  const char* name;
  int since;
  std::vector<std::string> key;
  std::vector<ColumnShape> columns;
};

constexpr std::string_view kInt = "INTEGER", kReal = "REAL", kText = "TEXT", kBlob = "BLOB";

template <class Record>
std::vector<ColumnShape> WithRecord(std::vector<ColumnShape> columns) {
  for (const Column& column : ColumnsOf<Record>())
    columns.push_back({column.name, column.is_real ? kReal : kInt, 1, true});
  return columns;
}

std::vector<TableShape> Tables() {
  return {
      {"recipe", 1, {"key"}, {{"key", kText}, {"value", kText}}},
      {"code", 2, {"subsystem", "identity"}, {{"subsystem", kText}, {"identity", kText}}},
      {"inputs", 2, {"name"}, {{"name", kText}, {"fingerprint", kText}}},
      {"places", 2, {"called"}, {{"called", kText}, {"file", kText}}},
      {"files", 2, {"name"}, {{"name", kText}, {"sha256", kText}, {"content", kBlob}}},
      {"stages", 1, {"stage"}, {{"stage", kInt}, {"name", kText}, {"missions", kInt}}},
      {"runs",
       1,
       {"run"},
       {{"run", kInt}, {"stage", kInt}, {"arm", kInt}, {"name", kText}, {"first_scenario", kInt}}},
      {"networks",
       2,
       {"sha256"},
       {{"sha256", kText}, {"name", kText}, {"model", kBlob}, {"checksum", kText}}},
      {"flown_networks",
       2,
       {"run", "seed", "agent"},
       {{"run", kInt}, {"seed", kInt}, {"agent", kText}, {"sha256", kText}}},
      {"sessions",
       1,
       {"session"},
       {{"session", kInt}, {"host", kText}, {"process", kInt}, {"begun_utc", kText}, {"ended_utc", kText}}},
      {"session_notes", 1, {"session", "key"}, {{"session", kInt}, {"key", kText}, {"value", kText}}},
      {"failures",
       1,
       {"run", "mission"},
       {{"run", kInt},
        {"mission", kInt},
        {"scenario", kInt},
        {"seed", kInt},
        {"message", kText},
        {"kind", kText, 2, true}}},
      {"timings",
       1,
       {"run", "mission"},
       {{"run", kInt}, {"mission", kInt}, {"session", kInt}, {"wall_s", kReal}}},
      {"missions",
       1,
       {"run", "mission"},
       WithRecord<mission::MissionRecord>({{"run", kInt},
                                           {"mission", kInt},
                                           {"checksum", kText, 2},
                                           {"steps_checksum", kText, 2},
                                           {"seal", kText, 2, true}})},
      {"timesteps",
       1,
       {"run", "mission", "k"},
       WithRecord<mission::TimestepRecord>({{"run", kInt}, {"mission", kInt}})},
  };
}

[[noreturn]] void Refuse(const Connection& database, const std::string& what) {
  throw UserError(
      fmt::format("{}: an ed3r file that somebody has changed: {}; fly it again into another --out",
                  database.file(), what));
}

// A view may compute without end and a trigger may change what is written: whoever gives a file away decides what they do.
void RefuseForeignSchema(Connection& database) {
  Statement select(
      database,
      "SELECT type, name FROM sqlite_schema WHERE type = 'trigger' OR (rootpage = 0 AND lower(name) IN ("
      "'recipe', 'code', 'inputs', 'places', 'files', 'stages', 'runs', 'networks', 'flown_networks', "
      "'sessions', 'session_notes', 'failures', 'timings', 'missions', 'timesteps', 'finished', 'worlds'))");
  if (select.Step())
    throw UserError(fmt::format("{}: an ed3r file that somebody has changed: '{}' is a {}, where ed3r has {}",
                                database.file(), select.Text(1), select.Text(0),
                                select.Text(0) == "trigger" ? "none" : "a table"));
}

void CheckTable(Connection& database, const TableShape& table, int version) {
  // Columns that compute are hidden ones.
  Statement columns(
      database,
      fmt::format("SELECT name, type, pk FROM pragma_table_xinfo('{}') WHERE hidden = 0 ORDER BY pk",
                  table.name));
  std::map<std::string, std::string> found;
  std::vector<std::string> key;
  while (columns.Step()) {
    found[columns.Text(0)] = columns.Text(1);
    if (columns.Int(2) > 0) key.push_back(columns.Text(0));
  }
  const bool has_it = version >= table.since;
  if (has_it && found.empty()) Refuse(database, fmt::format("it has no table {}", table.name));
  if (has_it && key != table.key)
    Refuse(database,
           fmt::format("its table {} has lost its key ({})", table.name, fmt::join(table.key, ", ")));
  for (const ColumnShape& column : table.columns) {
    const auto there = found.find(column.name);
    const bool asked = has_it && version >= column.since;
    if (there != found.end() && !asked)
      Refuse(database, fmt::format("its table {} has a column {}, and it says that it is of format {}, which "
                                   "has none",
                                   table.name, column.name, version));
    if (there == found.end() && asked && !column.may_lack)
      Refuse(database, fmt::format("its table {} has no column {}", table.name, column.name));
    if (there != found.end() && there->second != column.type)
      Refuse(database, fmt::format("its table {} has a column {} of type '{}', not {}", table.name,
                                   column.name, there->second, column.type));
  }
}

}  // namespace

void CheckIndexes(Connection& database) {
  Statement select(database,
                   "SELECT name FROM sqlite_schema WHERE type = 'index' AND sql LIKE 'CREATE UNIQUE%'");
  if (select.Step())
    throw UserError(fmt::format(
        "{0}: an ed3r file that somebody has changed: its index '{1}' allows a value only once, where "
        "ed3r has no such index; 'DROP INDEX {1}' takes it away",
        database.file(), select.Text(0)));
}

void CheckShape(Connection& database, int version) {
  RefuseForeignSchema(database);
  for (const TableShape& table : Tables()) CheckTable(database, table, version);
}

}  // namespace ed3r::store
