#include <gtest/gtest.h>

#include "engine/core/files/yaml_reader.h"
#include "tests/sweep/scratch.h"

namespace ed3r::sweep {
namespace {

std::string Unreadable(const std::string& file) {
  try {
    LoadSweep(file);
  } catch (const UserError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(UnreadableFilesTest, FilesThatAreNone) {
  const ScratchFolder scratch;
  EXPECT_EQ(Unreadable("nowhere/x.yaml"), "nowhere/x.yaml: cannot be read: No such file or directory");
  EXPECT_EQ(Unreadable(scratch.Path()), scratch.Path() + ": cannot be read: Is a directory");
  EXPECT_EQ(Unreadable("/dev/null"), "/dev/null: cannot be read: a device, not a file");
  EXPECT_EQ(Unreadable(""), ": cannot be read: No such file or directory");
  const std::string below_file = scratch.Write("x.yaml", "name: x") + "/y.yaml";
  EXPECT_EQ(Unreadable(below_file), below_file + ": cannot be read: Not a directory");
}

// Each file was compared with all before it.
TEST(UnreadableFilesTest, AChainOfThousandsOfBasesEnds) {
  const ScratchFolder scratch;
  for (int i = 0; i < 3000; ++i)
    scratch.Write("b" + std::to_string(i) + ".yaml", "base: b" + std::to_string(i + 1) + ".yaml\n");
  scratch.Write("b3000.yaml", "missions: 1\n");
  const std::string top = scratch.Write("x.yaml", "name: x\nbase: b0.yaml\n");
  EXPECT_EQ(Unreadable(top),
            scratch.Path() +
                "/b18.yaml:1:7: base: 'b19.yaml' is one file too many; allowed: a chain of at most 20");
}

// Was an endless recursion.
TEST(UnreadableFilesTest, AirframeFilesThatIncludeEachOther) {
  const ScratchFolder scratch;
  const auto says = [&](const std::string& airframe) {
    return Unreadable(scratch.Write("x.yaml", "name: x\nmissions: 1\nset: {robot: " + airframe + "}\n"));
  };
  const std::string folder = scratch.Path() + "/";
  scratch.Write("a.yaml", "robot: b.yaml\n");
  scratch.Write("b.yaml", "robot: a.yaml\n");
  scratch.Write("c.yaml", "robot: c.yaml\n");
  EXPECT_EQ(says("a.yaml"),
            folder + "b.yaml:1:8: robot: '" + folder + "a.yaml' is not allowed; it includes this file");
  EXPECT_EQ(says("c.yaml"),
            folder + "c.yaml:1:8: robot: '" + folder + "c.yaml' is not allowed; it includes this file");
  for (int i = 0; i < 25; ++i)
    scratch.Write("d" + std::to_string(i) + ".yaml", "robot: d" + std::to_string(i + 1) + ".yaml\n");
  EXPECT_EQ(says("d0.yaml"), folder + "d19.yaml:1:8: robot: '" + folder +
                                 "d20.yaml' is one file too many; allowed: a chain of at most 20");
  scratch.Write("d19.yaml", "robot.mass_kg: 3\n");
  EXPECT_EQ(says("d0.yaml"), "accepted");
}

TEST(UnreadableFilesTest, FilesThatHoldNothing) {
  for (const char* text : {"", "\n\n", "# Only a question\n", "---\n", "~\n"})
    EXPECT_TRUE(Refusal(text).ends_with("the file is empty; a sweep has at least a name and missions"))
        << text;
}

TEST(UnreadableFilesTest, FilesThatAreNoText) {
  EXPECT_EQ(Refusal(std::string("name: x\nmi\0ssions: 1\n", 20)),
            "x.yaml:2:3: byte 0x00 is not allowed; a YAML file is UTF-8 text");
  EXPECT_EQ(Refusal("\x7f"
                    "ELF\x02"),
            "x.yaml:1:1: byte 0x7f is not allowed; a YAML file is UTF-8 text");
  EXPECT_EQ(Refusal("\xff\xfen\0a\0"), "x.yaml:1:1: byte 0xff is not allowed; a YAML file is UTF-8 text");
  for (const char* bad : {"\xc3", "\xc3(", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                          "\xf8\x88\x80\x80\x80", "\x80", "\xe2\x82"})
    EXPECT_TRUE(Refusal(std::string("# ") + bad).starts_with("x.yaml:1:3: byte 0x"));
  for (const char* good : {"\xc2\xb3", "\xe2\x82\xac", "\xf0\x9f\x9a\x81", "\xed\x9f\xbf"})
    EXPECT_EQ(LoadText(std::string("# ") + good + "\nname: x\nmissions: 1\n").question, good);
}

TEST(UnreadableFilesTest, FilesAndValuesThatAreTooLong) {
  EXPECT_EQ(Refusal(std::string(kMaxYamlFileLength + 1, '#')),
            "x.yaml: is too long; allowed: at most 1048576 bytes");
  EXPECT_EQ(Refusal("name: " + std::string(kMaxScalarLength + 1, 'x') + "\nmissions: 1\n"),
            "x.yaml:1:7: a value of 1001 bytes is not allowed; allowed: at most 1000");
}

TEST(UnreadableFilesTest, NestingWithoutEnd) {
  for (const char* opening : {"[", "{", "{a: ", "- ", "? ", "[{a: "}) {
    std::string deep = "name: ";
    for (int i = 0; i < 50000; ++i) deep += opening;
    EXPECT_FALSE(Refusal(deep).empty()) << opening;
  }
}

TEST(UnreadableFilesTest, LineEndsOfOtherSystems) {
  EXPECT_EQ(LoadText("# Why?\r\nname: x\r\nmissions: 4\r\n").Missions(), 4);
  EXPECT_EQ(LoadText("# Why?\rname: x\rmissions: 4\r").Missions(), 4);
  // What stands behind a comment was part of it.
  EXPECT_EQ(LoadText("name: x # short\rmissions: 4\n").Missions(), 4);
  EXPECT_EQ(Refusal("name: x # short\rmissions: no\n"),
            "x.yaml:2:11: missions: 'no' is not allowed; allowed: 1 .. 10000000");
  EXPECT_EQ(Refusal("name: x\r\nmissions: no\r\n"),
            "x.yaml:2:11: missions: 'no' is not allowed; allowed: 1 .. 10000000");
}

}  // namespace
}  // namespace ed3r::sweep
