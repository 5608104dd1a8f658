#include "engine/app/kept_inputs.h"

#include <functional>

#include "engine/core/check.h"
#include "engine/schedule/training_stage.h"

namespace ed3r::app {

std::vector<std::string> DamageBesideMissions(store::ResultReader& reader, const std::string& dir) {
  const std::function<void()> checks[] = {[&] { reader.CheckViews(); }, [&] { reader.Files(); },
                                          [&] { schedule::NetworkShelf::From(reader.Networks(), dir); }};
  std::vector<std::string> lines;
  for (const auto& check : checks) try {
      check();
    } catch (const UserError& error) {
      lines.emplace_back(error.what());
    }
  return lines;
}

}  // namespace ed3r::app
