// JSON as it is printed and written. A template, so that only those who have JSON need its header.
#pragma once

#include <string>

namespace ed3r {

// Names of files and folders need not be UTF-8, which JSON is: what is not becomes U+FFFD. `indent` -1: on one line.
template <class Json>
std::string JsonText(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace ed3r
