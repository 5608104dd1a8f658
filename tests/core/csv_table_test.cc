#include "engine/core/files/csv_table.h"

#include <gtest/gtest.h>

#include "engine/core/check.h"

namespace ed3r {
namespace {

std::string Refusal(const std::string& text, CsvComments comments = CsvComments::kNone) {
  try {
    CsvTable::Parse("t.csv", text, comments);
  } catch (const UserError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CsvTableTest, ADuplicateColumnIsRefused) {
  EXPECT_EQ(Refusal("a,b,a\n1,2,3\n"), "t.csv:1:5: column 'a' is there twice");
  EXPECT_EQ(Refusal("# note\na,a\n", CsvComments::kHash), "t.csv:2:3: column 'a' is there twice");
}

TEST(CsvTableTest, CommentsAndBlankLinesStandAnywhereWhereTheyAreAllowed) {
  const CsvTable table = CsvTable::Parse("t.csv", "# note\n\na,b\n1,2\n# more\n\n3,4\n", CsvComments::kHash);
  EXPECT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.Line(1), 7);
  EXPECT_EQ(table.Number(1, 1, 0, 10), 4.0);
  EXPECT_EQ(Refusal("a\n1\n\n2\n"), "t.csv:3:1: blank line inside the table");
}

// pandas writes its row numbers so; other programs end every line with a delimiter.
TEST(CsvTableTest, AColumnWithoutANameIsCalledByItsPlaceInTablesOfOtherPrograms) {
  const CsvTable table = CsvTable::Parse("t.csv", ",a,b,\n0,1,2,\n", CsvComments::kHash);
  EXPECT_EQ(table.columns(), (std::vector<std::string>{"column 1", "a", "b", "column 4"}));
  EXPECT_EQ(table.Number(0, 2, 0, 10), 2.0);
  EXPECT_EQ(Refusal("a,,b\n"), "t.csv:1:3: column 2 has no name");
}

TEST(CsvTableTest, OnePlusMayStandBeforeANumberAndNoOtherSign) {
  const CsvTable table = CsvTable::Parse("t.csv", "a,b,c\n+1,+.5,+-1\n");
  EXPECT_EQ(table.Number(0, 0, -9, 9), 1.0);
  EXPECT_EQ(table.Number(0, 1, -9, 9), 0.5);
  try {
    table.Number(0, 2, -9, 9);
    ADD_FAILURE() << "it was -1";
  } catch (const UserError& error) {
    EXPECT_STREQ(error.what(), "t.csv:2:8: c: '+-1' is not a number");
  }
}

TEST(CsvTableTest, RowsOfDelimitersAloneAtTheEndAreLeftOut) {
  const std::string text = "a;b\n1;2\n;\n3;4\n;\n \"\";\n\n";
  EXPECT_EQ(CsvTable::Parse("t.csv", text, CsvComments::kHash, ';').rows(), 3u) << "not those between";
  EXPECT_EQ(CsvTable::Parse("t.csv", "a,b\n,\n").rows(), 1u);
  EXPECT_EQ(CsvTable::Parse("t.csv", "a,b\n,\n", CsvComments::kHash).rows(), 0u);
}

TEST(CsvTableTest, TextComesBackAsItWasWritten) {
  for (const std::string text : {"plain", "a,b", "say \"x\"", "\"\"", "\"", ",\",\"", ""}) {
    const CsvTable table = CsvTable::Parse("t.csv", "a,b\n" + CsvField(text) + ",end\n");
    EXPECT_EQ(table.Text(0, 0), text);
    EXPECT_EQ(table.Text(0, 1), "end");
  }
  EXPECT_EQ(CsvField("plain"), "plain");
  EXPECT_EQ(CsvField("two\nlines"), "\"two\nlines\"") << "for other readers: this one takes a line for a row";
}

TEST(CsvTableTest, VeryManyColumnsAreRefusedAtOnce) {
  std::string header;
  for (int i = 0; i < 2'000'000; ++i) header += "c" + std::to_string(i) + ",";
  EXPECT_EQ(Refusal(header + "z\n"), "t.csv:1:58891: more columns than are allowed (10000)");
}

TEST(CsvTableTest, AMessageStaysShortWhateverTheColumnsAreCalled) {
  const CsvTable table = CsvTable::Parse("t.csv", std::string(1'000'000, 'x') + "\n1\n");
  try {
    table.Column("height_m", "wanted");
    ADD_FAILURE();
  } catch (const UserError& error) {
    EXPECT_LE(std::string(error.what()).size(), 500u);
  }
}

}  // namespace
}  // namespace ed3r
