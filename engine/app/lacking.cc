#include "engine/app/lacking.h"

#include <algorithm>

#include "engine/app/words.h"
#include "engine/sweep/plan_text.h"

namespace ed3r::app {

void TellLacking(const store::ResultReader& reader, std::int64_t missions, const std::string& before) {
  const std::int64_t planned = reader.Layout().Missions();
  if (missions >= planned) return;
  const auto& stages = sweep::ReadPlanText(reader.StoredRecipe().plan_text).stages;
  const bool may_end = std::any_of(stages.begin(), stages.end(), [](const sweep::WrittenPlan::Stage& stage) {
    return stage.precision.has_value();
  });
  Tell("note: {} {} of {} planned missions{}", before, missions, planned,
       may_end ? "; a stage ends when it is known well enough, so that the others may not be needed" : "");
}

}  // namespace ed3r::app
