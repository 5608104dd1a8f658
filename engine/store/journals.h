// SQLite takes whatever lies beside a file under the name of its journal for the file's own, and finishes or undoes with it what
// a killed writer has left. Where another results file was put in the place of that one (a backup, a shard that was brought
// home), that would bury or cut its missions. So each session gives the file a mark of its own, which its journals repeat.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace ed3r::store {

// The mark, in SQLite's schema cookie: changes of the schema count on from it.
std::int64_t DrawMark();

// What the first page of a file tells of its state.
struct FileState {
  std::uint32_t changes = 0, mark = 0;
  std::uint32_t pages = 0;
  bool operator==(const FileState&) const = default;
};

// Whether `after` is `before`, with changes of the schema of one session.
bool IsSameMark(std::int64_t before, std::int64_t after);

// UserError where FILE-wal or FILE-journal holds commits of another file, or of another state of it, than FILE as it is. Files
// of before have no marks: their counts of changes are compared alone. Reads headers; while somebody writes it looks again.
// `state` looks at FILE itself, without what is in its journals; none where it is empty. By SQLite's own descriptor: closing
// another one would give back the locks that this process has on it.
void CheckJournals(const std::string& file, const std::function<std::optional<FileState>()>& state);

// UserError where FILE-wal or FILE-journal holds commits though SQLite would not look there, or would take them away: they are of
// `owner`, which lies elsewhere.
void CheckNoJournals(const std::string& file, const std::string& owner);

}  // namespace ed3r::store
