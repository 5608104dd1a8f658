#include "engine/app/lacking.h"

#include "engine/app/words.h"

namespace ed3r::app {

void TellLacking(store::ResultReader& reader, const std::string& before) {
  const std::int64_t missions = reader.CountMissions(), planned = reader.Layout().Missions();
  if (missions < planned) Tell("note: {} {} of {} planned missions", before, missions, planned);
}

}  // namespace ed3r::app
