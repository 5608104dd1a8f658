#include "studies/export/export_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/csv_table.h"
#include "engine/core/files/file.h"
#include "engine/store/columns.h"
#include "engine/store/words.h"

namespace ed3r::exports {
namespace {

// "code 9" for one that this version does not know.
std::string WordOf(std::string_view column, std::int64_t code) {
  for (const auto& [known, word] : store::WordsOf(column))
    if (known == code) return std::string(word);
  return fmt::format("code {}", code);
}

struct RowKey {
  std::string_view stage, arm;
  std::int64_t mission = 0;
};

// One table on its way into a file.
class TableFile {
 public:
  virtual ~TableFile() = default;
  virtual void Word(std::string_view word) = 0;
  virtual void Integer(std::int64_t value) = 0;
  virtual void Real(double value) = 0;
  virtual void EndRow() = 0;
};

class CsvFile final : public TableFile {
 public:
  CsvFile(AtomicFile& file, const std::vector<store::Column>& columns) : file_(file) {
    for (const store::Column& column : columns) Word(column.name);
    EndRow();
  }
  void Word(std::string_view word) override { Field(CsvField(word)); }
  void Integer(std::int64_t value) override { Field(fmt::format("{}", value)); }
  void Real(double value) override { Field(std::isnan(value) ? "" : fmt::format("{}", value)); }
  void EndRow() override {
    file_.Write(row_ + "\n");
    row_.clear();
    first_ = true;
  }

 private:
  void Field(std::string_view text) {
    if (!first_) row_ += ',';
    first_ = false;
    row_ += text;
  }

  AtomicFile& file_;
  std::string row_;
  bool first_ = true;
};

// Format 1.0 of numpy.lib.format: a header of Python text, padded to 64 bytes, then the rows, packed.
class NumpyFile final : public TableFile {
 public:
  // `width`: characters of a word.
  NumpyFile(AtomicFile& file, const std::vector<store::Column>& columns, std::int64_t rows, std::size_t width)
      : file_(file), width_(width) {
    std::string fields;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const bool word = i < 2 || !store::WordsOf(columns[i].name).empty();
      fields += fmt::format("('{}', '{}'), ", columns[i].name,
                            word                 ? fmt::format("<U{}", width)
                            : columns[i].is_real ? "<f8"
                                                 : "<i8");
    }
    std::string header =
        fmt::format("{{'descr': [{}], 'fortran_order': False, 'shape': ({},)}}", fields, rows);
    constexpr std::size_t kBefore = 12, kAlign = 64;
    header.append(kAlign - (kBefore + header.size() + 1) % kAlign, ' ');
    header += '\n';
    const auto size = static_cast<std::uint32_t>(header.size());
    std::string start("\x93NUMPY\x02\x00", 8);
    for (int i = 0; i < 4; ++i) start += static_cast<char>(size >> (8 * i));
    file_.Write(start + header);
  }
  void Word(std::string_view word) override {
    for (std::size_t i = 0; i < width_; ++i) {  // names are ASCII: a character is a code point of four bytes
      row_ += i < word.size() ? word[i] : '\0';
      row_.append(3, '\0');
    }
  }
  void Integer(std::int64_t value) override { store::AppendInt(row_, value); }
  void Real(double value) override { store::AppendInt(row_, std::bit_cast<std::int64_t>(value)); }
  void EndRow() override {
    file_.Write(row_);
    row_.clear();
  }

 private:
  AtomicFile& file_;
  const std::size_t width_;
  std::string row_;
};

template <class Record>
void WriteRow(const RowKey& key, const Record& record, TableFile& table) {
  table.Word(key.stage), table.Word(key.arm), table.Integer(key.mission);
  Record::Describe(record, [&](std::string_view name, const auto& field) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, double>) {
      table.Real(field);
    } else if (!store::WordsOf(name).empty()) {
      table.Word(WordOf(name, field));
    } else {
      table.Integer(field);
    }
  });
  table.EndRow();
}

std::size_t LongestWord(const store::RunLayout& layout) {
  std::size_t longest = 0;
  const auto see = [&](std::string_view word) { longest = std::max(longest, word.size()); };
  for (const store::RunLayout::Stage& stage : layout.stages) {
    see(stage.name);
    for (const store::RunLayout::Arm& arm : stage.arms) see(arm.name);
  }
  for (const std::string_view column : {"outcome", "motion_rule", "execution"})
    for (const auto& [code, word] : store::WordsOf(column)) see(word);
  return longest;
}

template <class Record>
std::unique_ptr<TableFile> Open(ExportFormat format, const std::filesystem::path& stem, std::int64_t rows,
                                std::size_t width, FileSet& files, ExportedTable& written) {
  std::vector<store::Column> columns = {{"stage"}, {"arm"}, {"mission"}};
  for (const store::Column& column : store::ColumnsOf<Record>()) columns.push_back(column);
  written = {stem.string() + (format == ExportFormat::kCsv ? ".csv" : ".npy"), rows};
  AtomicFile& file = files.Add(written.file);
  if (format == ExportFormat::kCsv) return std::make_unique<CsvFile>(file, columns);
  return std::make_unique<NumpyFile>(file, columns, rows, width);
}

}  // namespace

std::vector<ExportedTable> ExportTables(store::ResultReader& reader, ExportFormat format,
                                        const std::filesystem::path& folder, FileSet& files) {
  std::vector<sweep::RunId> counted;
  std::int64_t timesteps = 0;
  reader.ForEachMission(store::Steps::kSkip, [&](const store::StoredMission& mission) {
    counted.push_back(mission.id);
    if (mission.keeps_timesteps) timesteps += mission.record.timesteps;
  });
  const std::int64_t missions = std::ssize(counted);
  const store::RunLayout layout = reader.Layout();
  const std::size_t width = LongestWord(layout);
  std::vector<ExportedTable> written(2);
  const auto mission_table =
      Open<mission::MissionRecord>(format, folder / "missions", missions, width, files, written[0]);
  const auto step_table =
      Open<mission::TimestepRecord>(format, folder / "timesteps", timesteps, width, files, written[1]);
  std::int64_t missions_written = 0, timesteps_written = 0;
  reader.ForEachMission(store::Steps::kLoad, [&](const store::StoredMission& mission) {
    // One that has been stored since they were counted may stand anywhere.
    if (!std::binary_search(counted.begin(), counted.end(), mission.id)) return;
    const store::RunLayout::Stage& stage = layout.stages[static_cast<std::size_t>(mission.id.stage)];
    const RowKey key{stage.name, stage.arms[static_cast<std::size_t>(mission.id.arm)].name,
                     mission.id.mission};
    WriteRow(key, mission.record, *mission_table);
    for (const mission::TimestepRecord& step : mission.record.steps) WriteRow(key, step, *step_table);
    ++missions_written;
    timesteps_written += std::ssize(mission.record.steps);
  });
  if (missions_written != missions || timesteps_written != timesteps)
    throw UserError(
        fmt::format("{}: missions were taken out while it was exported; the same command again exports it",
                    reader.dir()));
  return written;
}

std::vector<std::string> TimestepNotes(store::ResultReader& reader) {
  std::vector<std::string> notes;
  const std::vector<store::RunLayout::Stage>& stages = reader.Layout().stages;
  for (int s = 0; s < static_cast<int>(stages.size()); ++s) {
    const sweep::KeptTimesteps rule = reader.Tables().KeptOf(s);
    if (rule == sweep::KeptTimesteps::kAll) continue;
    const store::RunLayout::Stage& stage = stages[static_cast<std::size_t>(s)];
    std::int64_t missions = 0, kept = 0;
    for (int a = 0; a < static_cast<int>(stage.arms.size()); ++a)
      reader.ForEachMission(s, a, store::Steps::kSkip, [&](const store::StoredMission& mission) {
        ++missions, kept += mission.keeps_timesteps ? 1 : 0;
      });
    if (kept < missions)
      notes.push_back(fmt::format(
          "stage {}: timesteps of {} of {} missions were kept (store: {{timesteps: {}}}): what is "
          "computed from its timesteps is of those alone; missions has all",
          stage.name, kept, missions, NameOf(rule)));
  }
  return notes;
}

}  // namespace ed3r::exports
