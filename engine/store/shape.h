// The tables of a file as they must be before a row of them is believed: tables and nothing that computes, with their keys and
// with every column that their format has, of its type.
#pragma once

#include "engine/store/sqlite.h"

namespace ed3r::store {

// `version` is what the file says of its format (schema.h). UserError where somebody has changed the tables: without the
// column of checksums nothing would be compared, without its key a table holds rows twice. Columns of records may be fewer
// (columns.h): checksums are over their names, too.
void CheckShape(Connection& database, int version);

// UserError for an index of somebody's that allows a value only once: what is to be written may have it twice.
void CheckIndexes(Connection& database);

}  // namespace ed3r::store
