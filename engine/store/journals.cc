#include "engine/store/journals.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <random>
#include <thread>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/files/descriptor.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {
namespace {

constexpr std::uint32_t kMostSchemaChanges = 4096;  // of one session; they are a few dozen
constexpr int kLooks = 10;
constexpr std::chrono::milliseconds kBetweenLooks{20};

// A journal, on which SQLite has no locks. Numbers are big-endian; places are those of SQLite's file format. StoreError where the
// system fails to give it: it would be taken for none, and SQLite might take it up later.
class BinaryFile {
 public:
  explicit BinaryFile(const std::string& name)
      : name_(name), descriptor_(open(name.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (!there()) CheckError();
  }

  bool there() const { return descriptor_.number() >= 0; }
  std::int64_t Size() const { return lseek(descriptor_.number(), 0, SEEK_END); }
  bool Read(std::int64_t at, void* bytes, std::size_t size) const {
    const ssize_t got = pread(descriptor_.number(), bytes, size, at);
    if (got < 0) CheckError();
    return got == static_cast<ssize_t>(size);
  }
  std::optional<std::uint32_t> Number(std::int64_t at) const {
    std::array<unsigned char, 4> bytes = {};
    if (!Read(at, bytes.data(), bytes.size())) return std::nullopt;
    std::uint32_t number = 0;
    for (const unsigned char byte : bytes) number = number << 8 | byte;
    return number;
  }

 private:
  // What is not there, or nobody's to read, SQLite finds so, too.
  void CheckError() const {
    if (errno == ENOENT || errno == EACCES || errno == EISDIR || errno == ELOOP) return;
    throw StoreError(fmt::format("{}: cannot be read: {}", name_, std::strerror(errno)));
  }

  std::string name_;
  Descriptor descriptor_;
};

std::optional<FileState> StateAt(const BinaryFile& file, std::int64_t page) {
  const auto changes = file.Number(page + 24), pages = file.Number(page + 28), mark = file.Number(page + 40);
  if (!changes || !pages || !mark) return std::nullopt;
  return FileState{*changes, *mark, *pages};
}

// The states of the file by its first page in the commits of a write-ahead log; none where it holds none.
std::optional<std::pair<FileState, FileState>> StatesOfLog(const std::string& name) {
  constexpr std::int64_t kHeaderBytes = 32, kFrameHeaderBytes = 24;
  const BinaryFile log(name);
  std::array<char, 8> salt = {}, salt_of_frame = {};
  const auto page_bytes = log.there() ? log.Number(8) : std::nullopt;
  if (!page_bytes || *page_bytes < 512 || !log.Read(16, salt.data(), salt.size())) return std::nullopt;
  std::optional<FileState> first, last, committed;
  for (std::int64_t at = kHeaderBytes;; at += kFrameHeaderBytes + *page_bytes) {
    const auto page = log.Number(at), pages_after_commit = log.Number(at + 4);
    if (!page || !pages_after_commit || !log.Read(at + 8, salt_of_frame.data(), salt_of_frame.size()) ||
        salt != salt_of_frame)
      break;  // the rest is of a round before
    if (*page == 1) last = StateAt(log, at + kFrameHeaderBytes);
    if (!first) first = last;
    if (*pages_after_commit != 0) committed = last;
  }
  if (!first || !committed) return std::nullopt;
  return std::pair{*first, *committed};
}

struct JournalledPage {
  FileState state;
  bool alone = false;  // nothing else was about to change
};

// The first page as a rollback journal would restore it; none where it would restore nothing, or not that page.
std::optional<JournalledPage> FirstPageOfJournal(const std::string& name) {
  constexpr std::array<unsigned char, 8> kMagic = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
  const BinaryFile journal(name);
  if (!journal.there()) return std::nullopt;
  const std::int64_t size = journal.Size();
  std::uint32_t records_before = 0;
  for (std::int64_t segment = 0;;) {
    std::array<unsigned char, 8> magic = {};
    const auto records = journal.Number(segment + 8), sector = journal.Number(segment + 20),
               page_bytes = journal.Number(segment + 24);
    if (!journal.Read(segment, magic.data(), magic.size()) || magic != kMagic || !records || !sector ||
        !page_bytes || *sector < 32 || *page_bytes < 512)
      return std::nullopt;
    const std::int64_t record_bytes = 4 + std::int64_t{*page_bytes} + 4;
    std::int64_t at = segment + *sector;
    const std::int64_t in_file = (size - at) / record_bytes;
    const std::int64_t count = *records == 0xffffffff ? in_file : std::min<std::int64_t>(*records, in_file);
    for (std::int64_t i = 0; i < count; ++i, at += record_bytes)
      if (journal.Number(at) == 1u) {
        const auto state = StateAt(journal, at + 4);
        if (!state) return std::nullopt;
        return JournalledPage{*state, records_before == 0 && count == 1};
      }
    if (count <= 0) return std::nullopt;
    records_before += static_cast<std::uint32_t>(count);
    segment = (at + *sector - 1) / *sector * *sector;  // the next one begins a sector
  }
}

bool SameMark(std::uint32_t before, std::uint32_t after) { return after - before < kMostSchemaChanges; }

// A log is written back from time to time: the file is at a state from that before its first commit to that after its last.
// One that is of an earlier round ends before the file does; only a change of the schema (VACUUM is one) may make a file
// smaller. A session that takes up a killed one's log marks the file in it.
bool IsOf(const FileState& file, const std::pair<FileState, FileState>& log) {
  const auto& [first, last] = log;
  const bool same_mark =
      SameMark(file.mark, first.mark) || SameMark(file.mark, last.mark) || SameMark(first.mark, file.mark);
  return same_mark && (file.mark != last.mark || file.pages <= last.pages) &&
         file.changes - (first.changes - 1) <= last.changes - (first.changes - 1);
}

// The file is as it was before the commit that would be undone, or as it would have been after it. Giving the file a new mark
// is a commit of its own.
bool IsOf(const FileState& file, const JournalledPage& before) {
  return file.changes - before.state.changes <= 1 && (before.alone || SameMark(before.state.mark, file.mark));
}

// "-wal" or "-journal" where that is another file's.
std::string StrangeJournal(const std::string& name, const std::optional<FileState>& state) {
  const auto log = StatesOfLog(name + "-wal");
  if (log && (!state || !IsOf(*state, *log))) return "-wal";
  const auto journal = FirstPageOfJournal(name + "-journal");
  if (journal && (!state || !IsOf(*state, *journal))) return "-journal";
  return "";
}

}  // namespace

std::int64_t DrawMark() {
  std::random_device random;
  return std::uniform_int_distribution<std::int64_t>(1, std::int64_t{1} << 30)(random);
}

bool IsSameMark(std::int64_t before, std::int64_t after) {
  return SameMark(static_cast<std::uint32_t>(before), static_cast<std::uint32_t>(after));
}

void CheckJournals(const std::string& file, const std::function<std::optional<FileState>()>& state) {
  std::string strange = StrangeJournal(file, state());
  for (int look = 1; !strange.empty() && look < kLooks; ++look) {
    std::this_thread::sleep_for(kBetweenLooks);
    strange = StrangeJournal(file, state());
  }
  if (!strange.empty())
    throw UserError(fmt::format(
        "{0}: {0}{1} is of another results file than this one, which was put in its place since; "
        "SQLite would write over this one what is in it: take {0}{1} out of the folder to read this file as "
        "it is, or put the file back that it is of",
        file, strange));
}

void CheckNoJournals(const std::string& file, const std::string& owner) {
  const bool has_log = StatesOfLog(file + "-wal").has_value();
  if (has_log || FirstPageOfJournal(file + "-journal"))
    throw UserError(
        fmt::format("{0}{1}: holds commits of {2}: put the two beside each other under these names, or take "
                    "{0}{1} away where its commits are not wanted",
                    file, has_log ? "-wal" : "-journal", owner));
}

}  // namespace ed3r::store
