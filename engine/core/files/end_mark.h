// YAML that this program writes to be read again ends with a line that a line at its top announces: a file that was cut short
// in between would be another airframe, without a word.
#pragma once

#include <string_view>

namespace ed3r {

inline constexpr char kEndAnnounced[] = "# The last line of this file is '# end of file'.";
inline constexpr char kEndMark[] = "# end of file";

// Whether a text announces its end and lacks it. Files without the announcement are anybody's.
bool IsCutShort(std::string_view text);

}  // namespace ed3r
