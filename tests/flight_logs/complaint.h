#pragma once

#include <functional>
#include <string>

#include "engine/core/check.h"

namespace ed3r::flight_logs {

// The one-line message of the UserError that reading throws; "" when it does not.
inline std::string Complaint(const std::function<void()>& read) {
  try {
    read();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

}  // namespace ed3r::flight_logs
