#include "engine/store/digest.h"

#include <fmt/format.h>

#include "engine/core/sha256.h"
#include "engine/store/columns.h"
#include "engine/store/reader.h"

namespace ed3r::store {
namespace {

std::string BytesOfFormat1(const ResultReader& reader, const StoredMission& mission) {
  const RunLayout::Stage& stage = reader.Layout().stages[static_cast<std::size_t>(mission.id.stage)];
  std::string bytes;
  AppendText(bytes, stage.name);
  AppendText(bytes, stage.arms[static_cast<std::size_t>(mission.id.arm)].name);
  AppendInt(bytes, mission.id.mission);
  reader.Tables().missions().Append(bytes, mission.record);
  AppendInt(bytes, static_cast<std::int64_t>(mission.record.steps.size()));
  for (const mission::TimestepRecord& step : mission.record.steps)
    reader.Tables().timesteps().Append(bytes, step);
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

std::string DigestOf(ResultReader& reader) {
  std::string header;
  Sha256 sha;
  AppendText(header, fmt::format("ed3r results {}", reader.Format()));
  if (reader.Format() == 1) {
    AppendText(header, reader.Tables().missions().names());
    AppendText(header, reader.Tables().timesteps().names());
  }
  sha.Update(header);
  reader.ForEachMission(Steps::kLoad, [&](const StoredMission& mission) {
    sha.Update(reader.Format() == 1 ? BytesOfFormat1(reader, mission) : mission.checksum);
  });
  return sha.Hex();
}

}  // namespace ed3r::store
