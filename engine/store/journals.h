// SQLite takes whatever lies beside a file under the name of its journal for the file's own, and finishes or undoes with it what
// a killed writer has left. Where another results file was put in the place of that one (a backup, a shard that was brought
// home), that would bury or cut its missions. So each session gives the file a mark of its own, which its journals repeat.
#pragma once

#include <cstdint>
#include <string>

namespace ed3r::store {

// The mark, in SQLite's schema cookie: changes of the schema count on from it.
std::int64_t DrawMark();

// UserError where FILE-wal or FILE-journal holds commits of another file, or of another state of it, than FILE as it is. Files
// of before have no marks: their counts of changes are compared alone. Reads headers; while somebody writes it looks again.
void CheckJournals(const std::string& file);

}  // namespace ed3r::store
