// What each strategy is, in a sentence for who has not read the paper.
#pragma once

#include <string_view>

namespace ed3r::report {

// "" for a strategy that the engine does not know.
std::string_view AboutStrategy(std::string_view strategy);

}  // namespace ed3r::report
