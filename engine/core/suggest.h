// The nearest known word for a misspelt one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ed3r {

// Returns the candidate with the smallest edit distance (insert, delete, replace, swap of neighbours), or ""
// when none is within a third of the word's length (at least 2 edits): a far-fetched suggestion is worse than
// none. A dotted key whose last part matches exactly ("mass_kg" for "robot.mass_kg") is suggested whatever
// its distance.
std::string NearestWord(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace ed3r
