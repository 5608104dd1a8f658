#include "engine/app/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/utf8.h"
#include "engine/core/parse_number.h"

namespace ed3r::app {
namespace {

constexpr const char* kNoValue = "'' is not allowed; allowed: a value (was a variable not set?)";

// CLI11 takes '' for the default, 010 for eight, -1 for the largest number where there are none below 0, and for what is
// too large or too small the nearest that there is.
template <class Number>
std::string NoNumber(const std::string& text) {
  if (text.empty()) return kNoValue;
  if (ParseNumber<Number>(text)) return "";
  constexpr Number kMax = std::numeric_limits<Number>::max();
  return fmt::format("'{}' is not allowed; allowed: {}", text,
                     std::is_floating_point_v<Number> ? "a number"
                     : std::is_unsigned_v<Number>     ? fmt::format("0 .. {}", kMax)
                                                      : fmt::format("a whole number up to {}", kMax));
}

std::string NoText(const std::string& text) { return text.empty() ? kNoValue : ""; }

// Without quotes, the value of a variable that was not set is the option that comes next.
std::string AnOption(const std::string& text) {
  if (!text.starts_with("--")) return "";
  return fmt::format("'{}' is not allowed; allowed: a value (was a variable not set?), or ./{} for a path",
                     text, text);
}

}  // namespace

Argument& Argument::Required() {
  option_->required();
  return *this;
}

Argument& Argument::OneValue() {
  option_->allow_extra_args(false);
  return *this;
}

Argument& Argument::Range(std::int64_t low, std::int64_t high) {
  option_->check(CLI::Range(low, high));
  return *this;
}

Argument& Argument::Numbers(const std::string& shown) {
  option_->delimiter(',')
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->type_name(shown);
  return *this;
}

Argument& Argument::Needs(const std::string& other) {
  option_->needs(command_->get_option(other));
  return *this;
}

Argument& Argument::Excludes(const std::vector<std::string>& others) {
  for (const std::string& other : others) option_->excludes(command_->get_option(other));
  return *this;
}

template <class Value>
Argument CommandLine::Option(const std::string& name, Value& value, const std::string& about) {
  CLI::Option* option = command_->add_option(name, value, about);
  const auto refuse = [option](std::string (*problem)(const std::string&)) {
    option->check(CLI::Validator([problem](std::string& text) { return problem(text); }, ""));
  };
  if constexpr (std::is_arithmetic_v<Value>)
    refuse(NoNumber<Value>);
  else if constexpr (std::is_same_v<Value, std::vector<int>>)
    refuse(NoNumber<int>);
  else
    refuse(NoText);
  if (name.starts_with("--")) refuse(AnOption);
  return Argument(command_, option);
}

template Argument CommandLine::Option(const std::string&, std::string&, const std::string&);
template Argument CommandLine::Option(const std::string&, int&, const std::string&);
template Argument CommandLine::Option(const std::string&, std::int64_t&, const std::string&);
template Argument CommandLine::Option(const std::string&, std::uint64_t&, const std::string&);
template Argument CommandLine::Option(const std::string&, double&, const std::string&);
template Argument CommandLine::Option(const std::string&, std::vector<std::string>&, const std::string&);
template Argument CommandLine::Option(const std::string&, std::vector<int>&, const std::string&);

Argument CommandLine::Flag(const std::string& name, bool& value, const std::string& about) {
  return Argument(command_, command_->add_flag(name, value, about));
}

void CommandLine::Footer(const std::string& text) { command_->footer(text); }

bool CommandLine::Chosen() const { return command_->parsed(); }

std::vector<std::string> Words(int argc, char** argv) {
  std::vector<std::string> words;
  for (int i = argc - 1; i > 0; --i) {
    std::string word = argv[i];
    // It ends up in notes, tables and JSON, which are UTF-8.
    if (!IsUtf8(word)) throw UserError(fmt::format("ed3r: argument {} is not UTF-8 text", i));
    // CLI11 would take the next word for the value.
    if (word.starts_with("--") && word.find('=') == word.size() - 1)
      throw CLI::ValidationError(word.substr(0, word.size() - 1), kNoValue);
    // CLI11 reads '[a,b]' as a and b where several values may stand.
    if (word.starts_with('[') && word.ends_with(']')) word.insert(0, "./");
    words.push_back(std::move(word));
  }
  return words;
}

CommandLine Program::AddCommand(const std::string& name, const std::string& about) {
  return CommandLine(program_->add_subcommand(name, about));
}

}  // namespace ed3r::app
