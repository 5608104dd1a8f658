// Words of a shell script.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ed3r::schedule {

// As one word of a POSIX shell, whatever is in it; left as it is where it needs no quotes.
std::string ShellWord(std::string_view text);
// Words with blanks between them.
std::string ShellWords(const std::vector<std::string>& words);

// Whether it can stand in an #SBATCH line as it is: letters, digits and "._:,=@%+/[]-".
bool IsDirectiveWord(std::string_view text);

}  // namespace ed3r::schedule
