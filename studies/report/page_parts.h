// Parts of the page that html.h puts together.
#pragma once

#include <string>
#include <string_view>

#include "studies/claims/verdicts.h"

namespace ed3r::report {

// &, <, > and quotes as entities.
std::string HtmlText(std::string_view text);

// How many claims got which verdict, and every claim that was measured; "" where the run has none of the paper's arms.
std::string VerdictSection(const claims::ClaimStudy& study);

}  // namespace ed3r::report
