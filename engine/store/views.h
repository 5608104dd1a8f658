// The views of a results file, which spell its rows out in words for whoever asks it by SQL. No command reads them, and so no
// checksum of a row tells of them: their texts have their own.
#pragma once

#include <string>

#include "engine/store/sqlite.h"

namespace ed3r::store {

// Makes those anew that are missing or are not this program's, and puts their checksums into the recipe, which is to be sealed.
// The tables have all columns of this program.
void PutViews(Connection& database);

// UserError where a view is another than was put. One that is gone tells nothing wrong; files of before have no checksums of them.
void CheckViews(Connection& database);

}  // namespace ed3r::store
