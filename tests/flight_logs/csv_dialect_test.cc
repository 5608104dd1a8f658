#include "studies/flight_logs/csv_dialect.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "studies/flight_logs/read_log.h"
#include "tests/flight_logs/complaint.h"

namespace ed3r::flight_logs {
namespace {

std::string Standard(const std::string& text, bool skip_bad = false) {
  return ToStandardCsv("x.csv", text, skip_bad).text;
}

LogTable WithPoints(const std::string& text, const std::vector<std::string>& columns) {
  LogTable log = ParseLog("x.csv", text, {});
  log.DecimalCommasToPoints(columns);
  return log;
}

TEST(CsvDialectTest, SemicolonsAndTabsWithDecimalCommas) {
  for (const std::string text : {"t;p\n0,5;400,25\n", "t\tp\n0,5\t400,25\n"}) {
    const LogTable log = WithPoints(text, {"t", "p", "not there"});
    EXPECT_EQ(log.Number(0, 0, 0, 10), 0.5);
    EXPECT_EQ(log.Number(0, 1, 0, 1000), 400.25);
  }
  EXPECT_EQ(Standard("sep=;\nt;p\n1;2\n"), "#ep=;\nt;p\n1;2\n");
  const LogTable log = WithPoints("\xEF\xBB\xBF\"time\";\"speed\"\r\n0,5;1,25\r\n1;2\r\n", {"time", "speed"});
  EXPECT_EQ(log.columns(), (std::vector<std::string>{"time", "speed"}));
  EXPECT_DOUBLE_EQ(log.Number(0, 1, 0, 10), 1.25);
}

// Were words with points, and columns that no format could name.
TEST(CsvDialectTest, CommasOfWordsStay) {
  for (const char delimiter : {';', '\t'}) {
    std::string text = "t|current, A|state\n0,5|1,25|cruise, fast\n1|2,5|\"hover, low\"\n";
    std::replace(text.begin(), text.end(), '|', delimiter);
    const LogTable log = WithPoints(text, {"t", "current, A", "state"});
    EXPECT_EQ(log.columns(), (std::vector<std::string>{"t", "current, A", "state"}));
    EXPECT_EQ(log.Number(0, 1, 0, 10), 1.25);
    EXPECT_EQ(log.Cell(0, 2), "cruise, fast");
    EXPECT_EQ(log.Cell(1, 2), "hover, low");
  }
}

TEST(CsvDialectTest, ThousandsCommasAreRefused) {
  const auto complaint = [](const std::string& text) {
    return Complaint([&] { WithPoints(text, {"t", "p"}); });
  };
  EXPECT_EQ(
      complaint("t\tp\n0.5\t900\n1\t1,023\n"),
      "x.csv:3:3: p: '1,023' here and '0.5' in line 2: a decimal comma and a decimal point, or thousands? "
      "allowed: "
      "one decimal sign in the columns that are read, and none for thousands");
  EXPECT_EQ(complaint("t;p\n0;900\n1;\"1,023\"\n2;12,345,678\n"),
            "x.csv:3:3: p: '1,023': every number with a comma has three digits after it in the columns that "
            "are read: decimals or thousands? "
            "allowed: no sign for thousands (1234), and decimal points where all have three decimals");
  for (const char* sure : {"0,125", "1234,125", "1,5", "-0,5", "1,2345", ",125"})
    EXPECT_EQ(complaint(fmt::format("t;p\n0;1,023\n1;{}\n", sure)), "") << sure;
}

// Was a number, and so made sure that the commas of all others are decimal ones.
TEST(CsvDialectTest, ACommaWithoutDecimalsIsNone) {
  EXPECT_EQ(Complaint([] {
              WithPoints("t;p\n0;1,023\n1;2,\n", {"t", "p"});
            }).substr(0, 30),
            "x.csv:2:3: p: '1,023': every n");
  EXPECT_EQ(Complaint([] {
              WithPoints("t;p\n0;1,5\n1;2,\n", {"t", "p"}).Number(1, 1, 0, 10);
            }).substr(0, 32),
            "x.csv:3:3: p: '2,' is not a numb");
}

TEST(CsvDialectTest, ColumnsThatAreNotReadTellNothingOfCommas) {
  for (const char* firmware : {"4.1", "1,4", "1,400"}) {
    const std::string text = fmt::format("t;p;firmware\n0,5;400,25;{}\n", firmware);
    EXPECT_EQ(WithPoints(text, {"t", "p"}).Number(0, 1, 0, 1000), 400.25);
  }
  EXPECT_EQ(Complaint([] {
              WithPoints("t;p;code\n0;1,023;1,4\n", {"t", "p"});
            }).substr(0, 19),
            "x.csv:2:3: p: '1,02");
}

TEST(CsvDialectTest, CommentsBlankLinesAndLineEnds) {
  EXPECT_EQ(Standard("t,p\r1,2\r3,4\r"), "t,p\n1,2\n3,4\n");
  const LogTable log =
      ParseLog("x.csv", "# flown by us\n% too\n// and this\n\nt,p\n1,2\n\n# pause\n3,4\n", {});
  ASSERT_EQ(log.rows(), 2u);
  EXPECT_DOUBLE_EQ(log.Number(1, 1, 0, 10), 4.0);
  EXPECT_EQ(log.WhereRow(1), "x.csv:9:1: ");
}

TEST(CsvDialectTest, CommentsThatMayBeRowsAreCounted) {
  const LogTable log = ParseLog("x.csv", "# a,b\nt,p\n1,2\n// leg,2\n# no row\n#3,4\n", {});
  EXPECT_EQ(log.rows(), 1u);
  EXPECT_EQ(log.notes(),
            std::vector<std::string>{"x.csv: 2 lines left out as comments, though with as many cells as the "
                                     "header: lines that begin with #, % or //"});
  EXPECT_TRUE(ParseLog("x.csv", "# a,b\nt,p\n1,2\n# no row\n", {}).notes().empty());
}

TEST(CsvDialectTest, TablesOfPandasAndWithADelimiterAtTheEndOfEveryLine) {
  for (const char* text :
       {",t,p\n0,1,2\n1,3,4\n", "t,p,\n1,2,\n3,4,\n,,\n", "\"\";t;p\n\"a\";1;2\n\"b\";3;4\n;;\n"}) {
    const LogTable log = ParseLog("x.csv", text, {});
    ASSERT_EQ(log.rows(), 2u) << text;
    EXPECT_EQ(log.Number(1, log.Column("p", ""), 0, 10), 4.0) << text;
  }
}

TEST(CsvDialectTest, NamesWhatItCannotRead) {
  const auto complaint = [](const std::string& text) { return Complaint([&] { Standard(text); }); };
  EXPECT_EQ(complaint("t,p\n0,5,400,25\n"),
            "x.csv:2:1: 4 numbers, but the header names 2 columns: these look like decimal commas between "
            "commas; write decimal "
            "points, or separate the columns by semicolons");
  EXPECT_NE(complaint("t,p,state\n0,5,400,25,flying\n")
                .find("4 numbers, but the header names 3 columns: these look"),
            std::string::npos);
  EXPECT_EQ(complaint("t,state\n1,\"flying\n2,flying\n"),
            "x.csv:2:1: a quotation mark is not closed; cells over several lines are not read; --skip-bad "
            "leaves such "
            "rows out");
  EXPECT_EQ(complaint("time power speed\n1 2 3\n"),
            "x.csv:1:1: no comma, semicolon or tab separates the names of the columns");
  EXPECT_EQ(
      complaint("1,2\n3,4\n"),
      "x.csv:1:1: a line of numbers where the names of the columns were expected; a header line is needed");
  EXPECT_EQ(complaint("t,p\n1,2\n3\n"),
            "x.csv:3:1: 1 cells, but the header names 2 columns; --skip-bad leaves such rows out");
}

TEST(CsvDialectTest, SkipsAndCountsRaggedRows) {
  const LogTable log = ParseLog("x.csv", "t,p\n1,2\n3\n4,5\n6,", {.skip_bad = true});
  EXPECT_EQ(log.rows(), 3u) << "a last line that is cut off after the comma still has its cells";
  EXPECT_EQ(log.bad(), 1);
  EXPECT_EQ(ParseLog("x.csv", "t,state\n1,\"up\n2,up\n", {.skip_bad = true}).bad(), 1);
}

TEST(CsvDialectTest, CellsThatAreOtherThanNumbersSayWhatTheyLookLike) {
  const auto complaint = [](const std::string& cell) {
    const LogTable log = ParseLog("x.csv", "t,p\n" + cell + ",1\n", {});
    return Complaint([&] { log.Number(0, 0, 0, 1e9); });
  };
  EXPECT_EQ(complaint("\"0,5\""),
            "x.csv:2:1: t: '0,5' is not a number (decimal or thousands commas? a decimal point is wanted, or "
            "semicolons between the columns)");
  EXPECT_EQ(complaint("12:00:01.5"),
            "x.csv:2:1: t: '12:00:01.5' is not a number (a date or a time of day? seconds are wanted)");
  EXPECT_EQ(complaint("NaN"), "x.csv:2:1: t: 'NaN' is not a number");
}

TEST(CsvDialectTest, KnowsWhatIsNoLog) {
  EXPECT_NE(Complaint([] {
              ParseLog("x", std::string("PK\0\0", 4), {});
            }).find("neither PX4 ULog, ArduPilot DataFlash"),
            std::string::npos);
  EXPECT_EQ(Complaint([] { ParseLog("x.csv", std::string("\xFF\xFEt\0,\0p\0", 8), {}); }),
            "x.csv: UTF-16 text; save it as UTF-8");
  EXPECT_NE(Complaint([] { ParseLog("x.gz", "\x1f\x8b\x08\x01", {}); }).find("nor CSV"), std::string::npos);
  EXPECT_EQ(Complaint([] { ParseLog("x.log", "FMT, 128, 89, FMT\n", {}); }),
            "x.log: ArduPilot's log as text; give the .bin file that it was made from");
}

}  // namespace
}  // namespace ed3r::flight_logs
