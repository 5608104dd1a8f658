#include "engine/app/command_line.h"

#include <CLI/CLI.hpp>
#include <vector>

namespace ed3r::app {

Argument& Argument::Required() {
  option_->required();
  return *this;
}

Argument& Argument::Path() {
  option_->check(CLI::Validator(
      [](std::string& text) { return std::string(text.empty() ? "'' is not allowed; allowed: a path" : ""); },
      ""));
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

Argument& Argument::Excludes(const std::string& other) {
  option_->excludes(command_->get_option(other));
  return *this;
}

template <class Value>
Argument CommandLine::Option(const std::string& name, Value& value, const std::string& about) {
  return Argument(command_, command_->add_option(name, value, about));
}

template Argument CommandLine::Option(const std::string&, std::string&, const std::string&);
template Argument CommandLine::Option(const std::string&, int&, const std::string&);
template Argument CommandLine::Option(const std::string&, std::int64_t&, const std::string&);
template Argument CommandLine::Option(const std::string&, std::uint64_t&, const std::string&);
template Argument CommandLine::Option(const std::string&, std::vector<std::string>&, const std::string&);
template Argument CommandLine::Option(const std::string&, std::vector<int>&, const std::string&);

void CommandLine::Flag(const std::string& name, bool& value, const std::string& about) {
  command_->add_flag(name, value, about);
}

void CommandLine::Footer(const std::string& text) { command_->footer(text); }

bool CommandLine::Chosen() const { return command_->parsed(); }

CommandLine Program::AddCommand(const std::string& name, const std::string& about) {
  return CommandLine(program_->add_subcommand(name, about));
}

}  // namespace ed3r::app
