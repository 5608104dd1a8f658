#include "engine/store/digest.h"

#include <fmt/format.h>

#include "engine/core/sha256.h"
#include "engine/store/columns.h"
#include "engine/store/reader.h"

namespace ed3r::store {
namespace {

std::string BytesOfFormat1(const ResultReader& reader, const sweep::RunId& id,
                           const mission::MissionRecord& record) {
  const RunLayout::Stage& stage = reader.Layout().stages[static_cast<std::size_t>(id.stage)];
  std::string bytes;
  AppendText(bytes, stage.name);
  AppendText(bytes, stage.arms[static_cast<std::size_t>(id.arm)].name);
  AppendInt(bytes, id.mission);
  reader.Tables().missions().Append(bytes, record);
  AppendInt(bytes, static_cast<std::int64_t>(record.steps.size()));
  for (const mission::TimestepRecord& step : record.steps) reader.Tables().timesteps().Append(bytes, step);
  return bytes;
}

}  // namespace

std::string CanonicalBytes(const mission::MissionRecord& record) {
  std::string bytes;
  AppendColumns(bytes, record);
  AppendInt(bytes, static_cast<std::int64_t>(record.steps.size()));
  for (const mission::TimestepRecord& step : record.steps) AppendColumns(bytes, step);
  return bytes;
}

std::string DigestOf(const mission::MissionRecord& record) {
  Sha256 sha;
  sha.Update(CanonicalBytes(record));
  return sha.Hex();
}

ResultDigest::ResultDigest(const ResultReader& reader) : reader_(reader) {
  std::string header;
  AppendText(header, fmt::format("ed3r results {}", reader.Format()));
  if (reader.Format() == 1) {
    AppendText(header, reader.Tables().missions().names());
    AppendText(header, reader.Tables().timesteps().names());
  }
  sha_.Update(header);
}

void ResultDigest::Add(const sweep::RunId& id, const mission::MissionRecord& record,
                       const std::string& checksum) {
  sha_.Update(reader_.Format() == 1 ? BytesOfFormat1(reader_, id, record) : checksum);
}

std::string DigestOf(ResultReader& reader) {
  ResultDigest digest(reader);
  reader.ForEachMission(Steps::kLoad, [&](const StoredMission& mission) {
    digest.Add(mission.id, mission.record, mission.checksum);
  });
  return digest.Hex();
}

}  // namespace ed3r::store
