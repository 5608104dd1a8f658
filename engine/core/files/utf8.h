// UTF-8 as Unicode defines it: no overlong forms, no surrogates, nothing beyond U+10FFFF.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ed3r {

// Bytes of the character that `text` begins with, 0 when it is malformed. `text` is not empty.
std::size_t Utf8Length(std::string_view text);

bool IsUtf8(std::string_view text);

// The text with each byte that is no part of a character as \xff.
std::string AsUtf8(std::string_view text);

}  // namespace ed3r
