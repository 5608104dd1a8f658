// Messages as the user meets them: one line of bounded length, whatever a file or a name brought into them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ed3r {

inline constexpr std::size_t kMaxMessageBytes = 500;

// The text as one line of at most kMaxMessageBytes: control characters escaped as \x0a, the middle of a long one left
// out, because a message begins with the place and ends with what is allowed.
std::string OneLine(std::string_view text);

}  // namespace ed3r
