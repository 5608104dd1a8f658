#include "engine/app/lacking.h"

#include "engine/app/words.h"

namespace ed3r::app {

void TellLacking(std::int64_t missions, std::int64_t planned, const std::string& before) {
  if (missions < planned) Tell("note: {} {} of {} planned missions", before, missions, planned);
}

void TellLacking(store::ResultReader& reader, const std::string& before) {
  TellLacking(reader.CountMissions(), reader.Layout().Missions(), before);
}

}  // namespace ed3r::app
