#include "engine/core/files/file.h"

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "engine/core/check.h"
#include "engine/core/files/temporary_file.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

class FileTest : public ::testing::Test {
 protected:
  FileTest() {
    std::string pattern = (fs::temp_directory_path() / "ed3r_file_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~FileTest() override { fs::remove_all(folder_); }

  static std::string Content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  // What the call says, with the test's folder cut away.
  template <class Call>
  std::string Refusal(Call call) const {
    try {
      call();
    } catch (const UserError& error) {
      std::string text = error.what();
      const std::string prefix = folder_.string() + "/";
      if (const auto at = text.find(prefix); at != std::string::npos) text.erase(at, prefix.size());
      return text;
    }
    return "accepted";
  }

  std::ptrdiff_t Entries() const { return std::distance(fs::directory_iterator(folder_), {}); }

  fs::path folder_;
};

TEST_F(FileTest, OnlyRegularFilesAreRead) {
  const auto read = [&](const fs::path& path) { return Refusal([&] { ReadFile(path.string()); }); };
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  fs::create_symlink(folder_ / "pipe", folder_ / "link");
  EXPECT_EQ(read(folder_ / "none"), "none: cannot be read: No such file or directory");
  EXPECT_EQ(read(folder_), folder_.string() + ": cannot be read: Is a directory");
  EXPECT_EQ(read(folder_ / "pipe"), "pipe: cannot be read: a FIFO, not a file");
  EXPECT_EQ(read(folder_ / "link"), "link: cannot be read: a FIFO, not a file");
  EXPECT_EQ(read("/dev/zero"), "/dev/zero: cannot be read: a device, not a file");
  EXPECT_EQ(read(""), ": cannot be read: No such file or directory");
}

TEST_F(FileTest, ContentComesWholeAndWithinItsBound) {
  const std::string content(200'000, 'x');
  WriteFile(folder_ / "x", content);
  EXPECT_EQ(ReadFile((folder_ / "x").string(), content.size()), content);
  EXPECT_EQ(Refusal([&] { ReadFile((folder_ / "x").string(), content.size() - 1); }),
            "x: is too long; allowed: at most 199999 bytes");
  fs::create_symlink(folder_ / "x", folder_ / "link");
  EXPECT_EQ(ReadFile((folder_ / "link").string()), content);
}

TEST_F(FileTest, AFileIsReplacedWholeOrNotAtAll) {
  WriteFile(folder_ / "x", "old");
  {
    AtomicFile file(folder_ / "x");
    file.Write("new, but never finished");
  }
  EXPECT_EQ(Content(folder_ / "x"), "old");
  EXPECT_EQ(Entries(), 1);
  WriteFile(folder_ / "x", "new");
  EXPECT_EQ(Content(folder_ / "x"), "new");
  EXPECT_EQ(Entries(), 1);
}

// What whoever looks may see, in the order of events: all old ones are gone before the first new one is there.
TEST_F(FileTest, FilesThatBelongTogetherAreNeverOfTwoSets) {
  WriteFile(folder_ / "a", "old");
  WriteFile(folder_ / "b", "old");
  const int watch = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  ASSERT_GE(inotify_add_watch(watch, folder_.c_str(), IN_DELETE | IN_MOVED_TO), 0);
  {
    FileSet files;
    files.Add(folder_ / "a", "new a");
    AtomicFile& b = files.Add(folder_ / "b");
    b.Write("new b");
    EXPECT_EQ(Content(folder_ / "a"), "old");
    files.Commit();
  }
  alignas(inotify_event) char bytes[4096];
  const ssize_t size = read(watch, bytes, sizeof bytes);
  std::string seen;
  for (ssize_t at = 0; at < size;) {
    const auto* event = reinterpret_cast<const inotify_event*>(bytes + at);
    seen += std::string(event->mask & IN_DELETE ? "-" : "+") + event->name + " ";
    at += static_cast<ssize_t>(sizeof *event + event->len);
  }
  close(watch);
  EXPECT_EQ(seen, "-b -a +a +b ");
  EXPECT_EQ(Content(folder_ / "a") + ", " + Content(folder_ / "b"), "new a, new b");
}

TEST_F(FileTest, FilesThatBelongTogetherAreKeptWhereOneOfTheNewCannotBe) {
  WriteFile(folder_ / "a", "old");
  fs::create_directory(folder_ / "b");
  EXPECT_EQ(Refusal([&] {
              FileSet files;
              files.Add(folder_ / "a", "new");
              files.Add(folder_ / "b", "new");
            }),
            "b: cannot be written: Is a directory");
  EXPECT_EQ(Content(folder_ / "a"), "old");
  EXPECT_EQ(Entries(), 2);
}

TEST_F(FileTest, ALinkIsReplacedAndItsTargetStays) {
  WriteFile(folder_ / "victim", "mine");
  fs::create_symlink(folder_ / "victim", folder_ / "x");
  WriteFile(folder_ / "x", "new");
  EXPECT_EQ(Content(folder_ / "victim"), "mine");
  EXPECT_EQ(Content(folder_ / "x"), "new");
  EXPECT_FALSE(fs::is_symlink(folder_ / "x"));
}

TEST_F(FileTest, PlacesThatCannotBeWrittenAreNamed) {
  const auto write = [&](const fs::path& path) { return Refusal([&] { WriteFile(path, "x"); }); };
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  fs::create_directory(folder_ / "sub");
  EXPECT_EQ(write(folder_ / "pipe"), "pipe: cannot be written: a FIFO, not a file");
  EXPECT_EQ(write(folder_ / "sub"), "sub: cannot be written: Is a directory");
  EXPECT_EQ(write(folder_ / "none" / "x"), "none/x: cannot be written: No such file or directory");
  EXPECT_EQ(write("/dev/null"), "/dev/null: cannot be written: a device, not a file");
  WriteFile(folder_ / "file", "x");
  EXPECT_EQ(Refusal([&] { MakeFolder(folder_ / "file" / "below"); }),
            "file/below: cannot be made: Not a directory");
}

// As a process leaves one behind that is killed while it writes.
fs::path KilledWhileWriting(const fs::path& path) {
  const pid_t child = fork();
  if (child == 0) {
    AtomicFile file(path);
    file.Write(std::string(200'000, 'x'));
    std::raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  for (const auto& entry : fs::directory_iterator(path.parent_path()))
    if (entry.path().filename().string().starts_with(".ed3r-")) return entry.path();
  return {};
}

TEST_F(FileTest, WhatAKilledProcessLeftIsRemovedAndNothingElse) {
  const fs::path left = KilledWhileWriting(folder_ / "x");
  ASSERT_FALSE(left.empty());
  AtomicFile writing(folder_ / "y");
  for (const char* other : {".ed3r-notes.tmp", "ed3r-0123456789abcdef.tmp", ".ed3r-0123456789abcdef.txt"})
    std::ofstream(folder_ / other) << "mine";
  EXPECT_EQ(RemoveLeftovers(folder_), 1);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_EQ(Entries(), 4) << "of another writer, and three that are not ours";
  writing.Commit();
  EXPECT_EQ(RemoveLeftovers(folder_), 0);
  EXPECT_EQ(RemoveLeftovers(folder_ / "none"), 0);
}

TEST_F(FileTest, AFolderThatIsToBeWrittenIsRidOfWhatKilledProcessesLeft) {
  KilledWhileWriting(folder_ / "x");
  fs::path film;
  close(MakeTemporaryFile(folder_, kTemporaryFilm, film));
  EXPECT_EQ(film.extension(), ".mp4");
  fs::path held;
  const int descriptor = MakeTemporaryFile(folder_, kTemporaryFilm, held);
  MakeFolder(folder_);
  EXPECT_EQ(Entries(), 1);
  EXPECT_TRUE(fs::exists(held)) << "somebody writes it";
  close(descriptor);
}

TEST_F(FileTest, AFolderThatAKilledProcessLeftGoesWithTheNextOne) {
  if (const pid_t child = fork(); child == 0) {
    const TemporaryFolder left(folder_);
    WriteFile(left.path() / "x", "half");
    fs::create_directory_symlink(folder_, left.path() / "out");
    std::raise(SIGKILL);
  } else {
    waitpid(child, nullptr, 0);
  }
  EXPECT_EQ(Entries(), 1);
  WriteFile(folder_ / "mine", "kept");
  const TemporaryFolder first(folder_);
  WriteFile(first.path() / "x", "1");
  const TemporaryFolder second(folder_);
  EXPECT_EQ(Entries(), 3) << "mine, and two that are used";
  EXPECT_EQ(Content(first.path() / "x"), "1");
}

TEST_F(FileTest, WhatAnotherMachineLeftIsRemovedAfterADay) {
  const fs::path left = KilledWhileWriting(folder_ / "x");
  std::string name = left.filename().string();
  name[6] = name[6] == '0' ? '1' : '0';  // the first digit of the machine
  fs::rename(left, folder_ / name);
  EXPECT_EQ(RemoveLeftovers(folder_), 0) << "its locks cannot be seen from here";
  fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - std::chrono::hours(25));
  EXPECT_EQ(RemoveLeftovers(folder_), 1);
}

TEST_F(FileTest, ADiskThatIsFullLeavesTheOldFile) {
  WriteFile(folder_ / "x", "old");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before = {};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 1000;
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string refusal = Refusal([&] { WriteFile(folder_ / "x", std::string(100'000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_DFL);
  EXPECT_EQ(refusal, "x: cannot be written: File too large");
  EXPECT_EQ(Content(folder_ / "x"), "old");
  EXPECT_EQ(Entries(), 1);
}

}  // namespace
}  // namespace ed3r
