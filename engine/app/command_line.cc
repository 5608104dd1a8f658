#include "engine/app/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <type_traits>
#include <vector>

namespace ed3r::app {
namespace {

// CLI11 takes '' for the default and 010 for eight.
std::string NoDecimalNumber(const std::string& text) {
  const std::string digits = text.substr(text.starts_with('-') ? 1 : 0);
  const bool decimal = !digits.empty() && (digits == "0" || digits.front() != '0') &&
                       std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
  return decimal ? "" : fmt::format("'{}' is not allowed; allowed: a whole number", text);
}

}  // namespace

Argument& Argument::Required() {
  option_->required();
  return *this;
}

Argument& Argument::Path() { return NotEmpty("a path"); }

Argument& Argument::NotEmpty(const std::string& allowed) {
  const std::string refusal = "'' is not allowed; allowed: " + allowed;
  option_->check(CLI::Validator([refusal](std::string& text) { return text.empty() ? refusal : ""; }, ""));
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
  if constexpr (std::is_integral_v<Value> || std::is_same_v<Value, std::vector<int>>)
    option->check(CLI::Validator([](std::string& text) { return NoDecimalNumber(text); }, ""));
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

CommandLine Program::AddCommand(const std::string& name, const std::string& about) {
  return CommandLine(program_->add_subcommand(name, about));
}

}  // namespace ed3r::app
