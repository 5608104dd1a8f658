// Files that are none, or hold what no program wrote: one line, the right exit status, nothing touched.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

const std::string kCorpus = ED3R_SOURCE_DIR "/tests/fuzz/corpus/";

void ExpectOneLine(const CommandResult& result, int status, const std::string& part) {
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("failed inside"), std::string::npos) << result.err;
  EXPECT_LE(result.err.size(), 501u);
}

// A small run, and copies of it with one statement of SQL.
class StoredFilesTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    flown_ = new ScratchFolder;
    const CommandResult result = Ed3r(fmt::format("run {}/sweeps/rbs.yaml --missions 4 --quiet --out {}",
                                                  ED3R_SOURCE_DIR, (*flown_ / "run").string()));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  static void TearDownTestSuite() { delete flown_; }

  std::string Altered(const std::string& sql) {
    fs::remove_all(scratch_ / "run");
    fs::copy(*flown_ / "run", scratch_ / "run", fs::copy_options::recursive);
    sqlite3* database = nullptr;
    EXPECT_EQ(sqlite3_open((scratch_ / "run" / "results.sqlite").c_str(), &database), SQLITE_OK);
    char* problem = nullptr;
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &problem), SQLITE_OK) << problem;
    sqlite3_close(database);
    return (scratch_ / "run").string();
  }

  static ScratchFolder* flown_;
  ScratchFolder scratch_;
};
ScratchFolder* StoredFilesTest::flown_ = nullptr;

TEST_F(StoredFilesTest, TablesThatCannotBeAreRefusedInOneLine) {
  for (const char* sql :
       {"UPDATE recipe SET value = 'many' WHERE key = 'seed'", "DELETE FROM recipe WHERE key = 'plan'",
        "DELETE FROM recipe WHERE key = 'seed'", "UPDATE runs SET stage = 7",
        "UPDATE runs SET arm = 1073741824", "UPDATE runs SET run = 1099511627776",
        "UPDATE stages SET missions = -1", "UPDATE stages SET stage = 3",
        "UPDATE runs SET first_scenario = -5", "UPDATE session_notes SET value = CAST(x'ff41' AS TEXT)"}) {
    SCOPED_TRACE(sql);
    ExpectOneLine(Ed3r("report --no-figures " + Altered(sql)), 2, "results.sqlite: the file is damaged");
  }
  for (const char* table : {"recipe", "runs"}) {
    SCOPED_TRACE(table);
    ExpectOneLine(
        Ed3r("report --no-figures " + Altered(fmt::format("DROP TABLE {}", table))), 2,
        fmt::format("results.sqlite: an ed3r file that somebody has changed: it has no table {}", table));
  }
}

TEST_F(StoredFilesTest, EveryValueOfAStoreIsEscapedInThePage) {
  const std::string run = Altered(
      "UPDATE sessions SET begun_utc = '<b>now', host = '<script>alert(1)</script>'; "
      "UPDATE session_notes SET value = '<q>' || value");
  ASSERT_EQ(Ed3r("report --no-figures " + run, "ED3R_WEB=/nonexistent").status, 0);
  const std::string page = ReadAll(fs::path(run) / "report" / "index.html");
  EXPECT_NE(page.find("&lt;b&gt;now"), std::string::npos);
  for (const char* raw : {"<script", "<b>now", "<q>"}) EXPECT_EQ(page.find(raw), std::string::npos) << raw;

  std::ofstream(scratch_ / "report.js") << "program";
  std::ofstream(scratch_ / "report.css") << "style";
  ASSERT_EQ(Ed3r("report --no-figures " + run, "ED3R_WEB=" + scratch_.Path().string()).status, 0);
  const std::string interactive = ReadAll(fs::path(run) / "report" / "index.html");
  for (const char* raw : {"<b>now", "<q>", "<script>alert"})
    EXPECT_EQ(interactive.find(raw), std::string::npos) << raw;
  EXPECT_NE(interactive.find("\\u003cq>"), std::string::npos);
}

TEST_F(StoredFilesTest, WhatStandsInTheStoresPlaceIsNamed) {
  fs::create_directories(scratch_ / "a" / "results.sqlite");
  ExpectOneLine(Ed3r("digest " + (scratch_ / "a").string()), 2,
                "results.sqlite: cannot be read: Is a directory");
  fs::create_directories(scratch_ / "b");
  ASSERT_EQ(mkfifo((scratch_ / "b" / "results.sqlite").c_str(), 0600), 0);
  ExpectOneLine(Ed3r("status " + (scratch_ / "b").string()), 2,
                "results.sqlite: cannot be read: a FIFO, not a file");
  const std::string sweep = ED3R_SOURCE_DIR "/sweeps/rbs.yaml --missions 1 --out ";
  ExpectOneLine(Ed3r("run " + sweep + (scratch_ / "b").string()), 2, "a FIFO, not a file");
}

TEST_F(StoredFilesTest, APlaceThatCannotBeWrittenIsBadInput) {
  const std::string run = (*flown_ / "run").string();
  ExpectOneLine(Ed3r("replay " + run + " rbs/0 --out /proc/nowhere"), 2, "/proc/nowhere: cannot be made");
  ExpectOneLine(Ed3r("report --no-figures " + run + " --out /proc/nowhere"), 2,
                "/proc/nowhere: cannot be made");
}

TEST_F(StoredFilesTest, OutputThatDoesNotArriveIsAnError) {
  for (const char* command : {"digest", "status", "report --no-figures", "status --json"}) {
    const std::string line = fmt::format("{} {} {} >/dev/full 2>{}", ED3R_BINARY, command,
                                         (*flown_ / "run").string(), (scratch_ / "err").string());
    const int status = std::system(line.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1) << command;
    const std::string said = ReadAll(scratch_ / "err");
    EXPECT_EQ(said, "ed3r: standard output cannot be written: No space left on device\n") << command;
  }
}

// What was printed went into the file that was opened next, and the table was lost with it.
TEST_F(StoredFilesTest, AClosedOutputIsAnError) {
  const fs::path out = scratch_ / "out";
  for (const std::string& command :
       {"digest " + (*flown_ / "run").string(),
        "export --csv " + (*flown_ / "run").string() + " --out " + out.string(), std::string("params")}) {
    const std::string line = fmt::format("{} {} >&- 2>{}", ED3R_BINARY, command, (scratch_ / "err").string());
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 1) << command;
    EXPECT_EQ(ReadAll(scratch_ / "err"), "ed3r: standard output cannot be written: Bad file descriptor\n")
        << command;
  }
  EXPECT_TRUE(ReadAll(out / "missions.csv").starts_with("stage,arm,mission,"));
}

// Beyond the limit of a file's size, or of the disk.
TEST_F(StoredFilesTest, AFileThatMayNotGrowIsAnErrorOfOneLine) {
  const std::string sweep = ED3R_SOURCE_DIR "/sweeps/rbs.yaml --missions 3 --quiet --out ";
  CommandResult result = Ed3r("run " + sweep + (scratch_ / "small").string(), "ulimit -f 80;");
  ExpectOneLine(result, 1,
                "(SQLite code 778; files may have 40960 bytes here, by ulimit -f); what is stored is kept");
  result = Ed3r("export --csv " + (*flown_ / "run").string() + " --out " + (scratch_ / "out").string(),
                "ulimit -f 1;");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("cannot be written: File too large"), std::string::npos) << result.err;
}

// Commits that a killed writer left beside the store can be read only with a -shm file.
TEST_F(StoredFilesTest, AStoreThatThisUserMayNotReadIsNamedWithTheReason) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become a user who may not";
#ifdef ED3R_COVERAGE
  GTEST_SKIP() << "another user may not write this build's counts, and is told so in many lines";
#endif
  const std::string store = (scratch_ / "run" / "results.sqlite").string();
  const std::string nobody = "setpriv --reuid=65534 --regid=65534 --clear-groups ";
  if (std::system((nobody + ED3R_BINARY " --version >/dev/null 2>&1").c_str()) != 0)
    GTEST_SKIP() << "no other user, or the program lies where one may not go";
  fs::permissions(scratch_.Path(), fs::perms::others_read | fs::perms::others_exec, fs::perm_options::add);
  Altered("PRAGMA journal_mode = WAL");
  fs::copy_file(store, store + "-wal");  // no valid one, but not empty
  ExpectOneLine(
      Ed3r("digest " + (scratch_ / "run").string(), nobody), 2,
      "results.sqlite-shm cannot be made: Permission denied; read it as a user who may write there, or copy");
  std::ofstream(store + "-shm") << "x";
  fs::permissions(store + "-shm", fs::perms::none);
  ExpectOneLine(Ed3r("digest " + (scratch_ / "run").string(), nobody), 2,
                "results.sqlite-shm cannot be opened: Permission denied");
  fs::permissions(store, fs::perms::none);
  ExpectOneLine(Ed3r("digest " + (scratch_ / "run").string(), nobody), 2,
                "results.sqlite: cannot be read: Permission denied");
}

// CLI11 reads words in brackets as lists: '[flat]' was the folder flat.
TEST_F(StoredFilesTest, AFolderInBracketsIsItself) {
  const fs::path folder = scratch_ / "work";
  for (const char* name : {"flat", "[flat]", "[a,b]"}) fs::create_directories(folder / name);
  for (const char* name : {"[flat]", "[a,b]"})
    fs::copy(*flown_ / "run", folder / name, fs::copy_options::recursive);
  const std::string there = "cd " + folder.string() + " &&";
  const std::string digest = Ed3r("digest " + (*flown_ / "run").string()).out;
  for (const char* name : {"'[flat]'", "'[a,b]'"}) {
    const CommandResult merged = Ed3r(fmt::format("merge '[out]' {}", name), there);
    EXPECT_EQ(merged.status, 0) << merged.err;
    EXPECT_EQ(Ed3r("digest '[out]'", there).out, digest);
    fs::remove_all(folder / "[out]");
  }
  EXPECT_EQ(Ed3r("compare '[flat]' '[a,b]'", there).status, 0);
  ExpectOneLine(Ed3r("compare '[flat,x]' '[flat]'", there), 2, "[flat,x]");
  ExpectOneLine(Ed3r("fit '[flat]'", there), 2, "[flat]");
}

TEST(FilesTest, ArgumentsAreText) {
  ExpectOneLine(Ed3r("digest \xff"), 2, "ed3r: argument 2 is not UTF-8 text");
}

TEST(FilesTest, PicturesFramesAndModelsOfImpossibleSizesAreRefused) {
  const ScratchFolder scratch;
  const auto frames = [&](const std::string& npy) {
    fs::create_directories(scratch / npy);
    fs::copy_file(kCorpus + "npy/" + npy, scratch / npy / "frames.npy");
    std::ofstream(scratch / npy / "labels.csv")
        << "index,view,frame,world,site,distance_m,fire_px,smoke_px,occluded,label\n";
    return Ed3r("detect " + (scratch / npy).string());
  };
  ExpectOneLine(frames("overflow.npy"), 2, "frames of 65536 x 65536 pixels");
  ExpectOneLine(frames("empty_frames.npy"), 2, "2 frames of 3 x 0 pixels");
  ExpectOneLine(Ed3r("detect " + kCorpus + "picture/huge.png"), 2, "a picture of 60000 x 60000 pixels");
  ExpectOneLine(Ed3r("detect " + kCorpus + "picture/small.png --set perception.detector.full=" + kCorpus +
                     "onnx/hugedim.onnx"),
                2, "has a tensor 'w' with the shape [1099511627776, 1]");
  ASSERT_EQ(mkfifo((scratch / "pipe.png").c_str(), 0600), 0);
  ExpectOneLine(Ed3r("detect " + (scratch / "pipe.png").string()), 2, "a FIFO, not a file");
  ExpectOneLine(Ed3r("detect " + kCorpus + "picture/small.png --set perception.detector.full=/dev/zero"), 2,
                "a device, not a file");
  ExpectOneLine(Ed3r("fit " + (scratch / "pipe.png").string()), 2, "a FIFO, not a file");
}

TEST(FilesTest, TooLittleMemoryIsSaidInOneLine) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer needs more than any limit";
#endif
  const ScratchFolder scratch;
  std::ofstream(scratch / "labels.csv") << "x";
  std::ofstream(scratch / "frames.npy") << "x";
  fs::resize_file(scratch / "frames.npy", 8'000'000'000);  // takes no place on the disk
  ExpectOneLine(Ed3r("detect " + scratch.Path().string(), "ulimit -v 6000000;"), 1, "ed3r: out of memory");
}

}  // namespace
}  // namespace ed3r::app
