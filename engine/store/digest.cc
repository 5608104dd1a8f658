#include "engine/store/digest.h"

#include "engine/core/sha256.h"
#include "engine/store/columns.h"
#include "engine/store/reader.h"

namespace ed3r {
std::string CanonicalBytes(const MissionRecord& record) {
  std::string bytes;
  AppendColumns(bytes, record);
  AppendInt(bytes, static_cast<std::int64_t>(record.steps.size()));
  for (const TimestepRecord& step : record.steps) AppendColumns(bytes, step);
  return bytes;
}

std::string DigestOf(const MissionRecord& record) {
  Sha256 sha;
  sha.Update(CanonicalBytes(record));
  return sha.Hex();
}

std::string DigestOf(ResultReader& reader) {
  std::string header;
  AppendText(header, "ed3r results 1");
  AppendText(header, ColumnNames<MissionRecord>());
  AppendText(header, ColumnNames<TimestepRecord>());
  Sha256 sha;
  sha.Update(header);
  const RunLayout& layout = reader.Layout();
  reader.ForEachMission(Steps::kLoad, [&](const StoredMission& mission) {
    const RunLayout::Stage& stage = layout.stages[mission.id.stage];
    header.clear();
    AppendText(header, stage.name);
    AppendText(header, stage.arms[mission.id.arm].name);
    AppendInt(header, mission.id.mission);
    sha.Update(header);
    sha.Update(CanonicalBytes(mission.record));
  });
  return sha.Hex();
}

}  // namespace ed3r
