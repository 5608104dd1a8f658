// Tables for other tools, of a run that goes on while they are written.
#include <atomic>
#include <fstream>
#include <iterator>
#include <regex>
#include <thread>

#include "studies/export/export_tables.h"
#include "tests/store/store_fixture.h"

namespace ed3r::exports {
namespace {

namespace fs = std::filesystem;

// Bytes that the file's header promises: its own, and those of its rows.
std::int64_t PromisedBytes(const std::string& file) {
  constexpr std::int64_t kBefore = 12, kNumberBytes = 8, kLetterBytes = 4;
  const auto header_bytes = static_cast<std::int64_t>(static_cast<std::uint8_t>(file[8]) +
                                                      256 * static_cast<std::uint8_t>(file[9]));
  const std::string header = file.substr(kBefore, static_cast<std::size_t>(header_bytes));
  std::int64_t row = 0;
  const std::regex field("'<([Uif])([0-9]+)'"), shape("'shape': \\(([0-9]+),\\)");
  for (auto it = std::sregex_iterator(header.begin(), header.end(), field); it != std::sregex_iterator();
       ++it)
    row += (*it)[1] == "U" ? kLetterBytes * std::stoll((*it)[2]) : kNumberBytes;
  std::smatch rows;
  EXPECT_TRUE(std::regex_search(header, rows, shape)) << header;
  return kBefore + header_bytes + row * std::stoll(rows[1]);
}

std::string Content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Flies a run from the end of its plan to its beginning, so that what comes in stands before what is there, and exports it
// all the while.
void ExportWhileItFlies(const std::string& dir, const std::string& out) {
  const store::RunLayout layout = store::TestLayout();
  const auto writer = store::ResultStore::Open(dir, store::TestRecipe(), layout);
  writer->Commit();
  fs::create_directories(out);
  std::atomic<bool> ended = false;
  const std::jthread flying([&] {
    std::vector<sweep::RunId> missions = store::AllMissions(layout);
    for (auto id = missions.rbegin(); id != missions.rend(); ++id) {
      mission::MissionRecord record = store::TestRecord(*id);
      record.timesteps = std::ssize(record.steps);
      writer->Put(*id, record, 0.25);
      writer->Commit();
    }
    ended = true;
  });
  for (bool last = false; !last;) {
    last = ended;
    store::ResultReader reader(dir);
    FileSet files;
    const std::vector<ExportedTable> tables = ExportTables(reader, ExportFormat::kNumpy, out, files);
    files.Commit();
    EXPECT_EQ(tables.size(), 2u);
    for (const ExportedTable& table : tables) {
      const std::string file = Content(table.file);
      EXPECT_EQ(PromisedBytes(file), std::ssize(file)) << table.file << ", " << table.rows << " rows";
    }
  }
}

// A mission must come in between the counting and the writing: one try in three meets that.
TEST(ExportTest, ARunThatGoesOnIsExportedAsItWasCounted) {
  const store::TempDir temp;
  for (int run = 0; run < 8; ++run) ExportWhileItFlies(temp / fmt::format("run{}", run), temp / "out");
}

TEST(ExportTest, ADamagedRunLeavesNoFile) {
  const store::TempDir temp;
  store::WriteStore(temp / "run", store::AllMissions(store::TestLayout()));
  store::Connection(temp / "run/results.sqlite", store::Connection::Access::kReadWrite)
      .Execute("UPDATE timesteps SET total_j = 1 WHERE k = 1");
  store::ResultReader reader(temp / "run");
  fs::create_directories(temp / "there");
  {
    FileSet files;
    EXPECT_THROW(ExportTables(reader, ExportFormat::kCsv, temp / "there", files), UserError);
  }
  EXPECT_TRUE(fs::is_empty(temp / "there"));
}

}  // namespace
}  // namespace ed3r::exports
