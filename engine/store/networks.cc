#include "engine/store/networks.h"

#include <fmt/format.h>

#include <optional>

#include "engine/core/check.h"
#include "engine/store/columns.h"
#include "engine/store/schema.h"

namespace ed3r::store {
namespace {

// Stage and arm of a run; none where the layout has no such run.
std::optional<std::pair<int, int>> ArmOf(const RunLayout& layout, std::int64_t run) {
  for (std::size_t s = 0; s < layout.stages.size(); ++s)
    for (std::size_t a = 0; a < layout.stages[s].arms.size(); ++a)
      if (layout.RunIndex(static_cast<int>(s), static_cast<int>(a)) == run)
        return std::pair{static_cast<int>(s), static_cast<int>(a)};
  return std::nullopt;
}

[[noreturn]] void FailNetworkFiles(const Connection& database) {
  throw UserError(
      fmt::format("{}: the file is damaged: the names of its networks, or which file is whose, do not "
                  "match their checksum; 'ed3r run SWEEP' puts them again",
                  database.file()));
}

// The seal is over all of them: those that are not put anew must be as they were put.
bool MaySeal(Connection& database, const FlownNetworks& networks) {
  if (NetworkFilesMatch(database)) return true;
  Statement there(database, "SELECT sha256 FROM networks");
  while (there.Step())
    if (!networks.files.contains(there.Text(0))) return false;
  return true;
}

}  // namespace

void PutNetworks(Connection& database, const RunLayout& layout, const FlownNetworks& networks) {
  const bool may_seal = MaySeal(database, networks);
  // What is put is whole, whatever has become of what is there.
  Statement put_file(database,
                     "INSERT OR REPLACE INTO networks (sha256, name, model, checksum) VALUES (?, ?, ?, ?)");
  for (const auto& [sha256, file] : networks.files) {
    put_file.Bind(0, sha256);
    put_file.Bind(1, file.name);
    put_file.BindBlob(2, file.model);
    put_file.Bind(3, HashOf(file.model));
    put_file.Run();
  }
  Statement put_use(database,
                    "INSERT OR IGNORE INTO flown_networks (run, seed, agent, sha256) VALUES (?, ?, ?, ?)");
  Statement select(database, "SELECT sha256 FROM flown_networks WHERE run = ? AND seed = ? AND agent = ?");
  for (const NetworkUse& use : networks.uses) {
    const std::int64_t run = layout.RunIndex(use.stage, use.arm), seed = use.seed;
    put_use.Run(run, seed, use.agent, use.sha256);
    select.Bind(0, run);
    select.Bind(1, seed);
    select.Bind(2, use.agent);
    const std::string there = select.Step() ? select.Text(0) : "";
    select.Reset();
    if (there != use.sha256)
      throw UserError(fmt::format(
          "{}: arm {} has flown with another {} network ({:.16}) than this one ({:.16})", database.file(),
          layout.stages[static_cast<std::size_t>(use.stage)].arms[static_cast<std::size_t>(use.arm)].name,
          use.agent, there, use.sha256));
  }
  SealUses(database);
  if (may_seal) SealNetworkFiles(database);  // else what is damaged is still to be seen
}

FlownNetworks ReadNetworks(Connection& database, const RunLayout& layout) {
  FlownNetworks networks;
  if (database.Int("PRAGMA user_version") < 2) return networks;
  Statement files(database, "SELECT sha256, name, model, checksum FROM networks");
  while (files.Step()) {
    const NetworkFile& file = networks.files[files.Text(0)] = {files.Text(1), files.Blob(2)};
    if (HashOf(file.model) != files.Text(3))
      throw UserError(
          fmt::format("{}: the file is damaged: its network '{}' does not match its checksum; 'ed3r run "
                      "SWEEP' trains it again",
                      database.file(), file.name));
  }
  Statement uses(database, "SELECT run, seed, agent, sha256 FROM flown_networks ORDER BY run, seed, agent");
  while (uses.Step()) {
    const auto arm = ArmOf(layout, uses.Int(0));
    const NetworkUse use{arm ? arm->first : 0, arm ? arm->second : 0, static_cast<int>(uses.Int(1)),
                         uses.Text(2), uses.Text(3)};
    if (!arm || !networks.files.contains(use.sha256))
      throw UserError(fmt::format("{}: the file is damaged: it does not hold the {} network {:.16} that flew",
                                  database.file(), use.agent, use.sha256));
    networks.uses.push_back(use);
  }
  if (!NetworkFilesMatch(database)) FailNetworkFiles(database);
  return networks;
}

}  // namespace ed3r::store
