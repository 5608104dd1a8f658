// The program's command line: commands with their options. A narrow face of CLI11, whose headers are slow to compile in
// every file that reads them. What is wrong on a command line throws; main.cc turns it into one line.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace ed3r::app {

// An option or a positional argument that was just added; its limits are chained to it.
class Argument {
 public:
  explicit Argument(CLI::App* command, CLI::Option* option) : command_(command), option_(option) {}
  Argument& Required();
  Argument& OneValue();  // of a list: '--set A --set B', so that a positional argument may follow
  Argument& Range(std::int64_t low, std::int64_t high);
  Argument& Numbers(const std::string& shown);  // of a list: '1,4', '1 4' or the option twice
  Argument& Needs(const std::string& other);    // names of arguments that stand before this one
  Argument& Excludes(const std::vector<std::string>& others);

 private:
  CLI::App* command_;
  CLI::Option* option_;
};

class CommandLine {
 public:
  explicit CommandLine(CLI::App* command) : command_(command) {}

  // "--name", or "NAME" for a positional argument. `value`: std::string, int, std::int64_t, std::uint64_t, double or a
  // std::vector of std::string or int. It holds the default, must outlive the parsing, and is changed only where the argument
  // is given. Refused: '', an option in the place of a value, and numbers that ParseNumber does not know.
  template <class Value>
  Argument Option(const std::string& name, Value& value, const std::string& about);
  Argument Flag(const std::string& name, bool& value, const std::string& about);
  void Footer(const std::string& text);

  bool Chosen() const;  // after the parsing: whether this is the command that was called

 private:
  CLI::App* command_;
};

// What main was given, the last word first, as CLI11 takes it.
std::vector<std::string> Words(int argc, char** argv);

class Program {
 public:
  explicit Program(CLI::App* program) : program_(program) {}
  CommandLine AddCommand(const std::string& name, const std::string& about);

 private:
  CLI::App* program_;
};

}  // namespace ed3r::app
