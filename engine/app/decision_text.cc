#include "engine/app/decision_text.h"

#include "engine/agents/decisions.h"

namespace ed3r::app {

std::string_view CodeName(std::string_view column, std::int64_t code) {
  if (column == "motion_rule") return NameOf(static_cast<agents::MotionRule>(code));
  if (column == "execution") return NameOf(static_cast<agents::Execution>(code));
  if (column != "band") return "";
  const std::string_view text = BandText(code);
  return text.substr(0, text.find(':'));
}

std::string_view BandText(std::int64_t band) {
  switch (static_cast<agents::ConfidenceBand>(band)) {
    case agents::ConfidenceBand::kReliable:
      return "reliable: hover (Algorithm line 4)";
    case agents::ConfidenceBand::kIntermediate:
      return "intermediate: ranges shrink (Algorithm line 9)";
    case agents::ConfidenceBand::kPersisting:
      return "persisting: intermediate again, ranges widen, explore (Algorithm line 11)";
    case agents::ConfidenceBand::kLow:
      return "low: normal operation (Algorithm line 14)";
    case agents::ConfidenceBand::kNone:
      break;
  }
  return "none: early completion is off";
}

}  // namespace ed3r::app
