#include "engine/core/check.h"

#include <fmt/format.h>

#include <string_view>

namespace ed3r {

void FailCheck(const char* file, int line, const char* condition, const std::string& detail) {
  std::string_view name(file);
  if (const auto slash = name.rfind('/'); slash != std::string_view::npos) name.remove_prefix(slash + 1);
  throw InternalError(fmt::format("{}:{}: {} does not hold: {}", name, line, condition, detail));
}

}  // namespace ed3r
