#include "engine/app/kept_inputs.h"

#include "engine/core/check.h"
#include "engine/schedule/training_stage.h"

namespace ed3r::app {

std::string DamageBesideMissions(store::ResultReader& reader, const std::string& dir) {
  try {
    reader.CheckViews();
    reader.Files();
    schedule::NetworkShelf::From(reader.Networks(), dir);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

}  // namespace ed3r::app
