#include <fmt/format.h>
#include <unistd.h>

#include <exception>

#include "engine/app/commands.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/version.h"
#include "kernels/simd_level.h"

namespace ed3r {
namespace {

std::vector<Command> AddCommands(CLI::App& program) {
  return {AddRun(program),     AddPlan(program),   AddStatus(program),  AddReport(program),
          AddCompare(program), AddDigest(program), AddMerge(program),   AddVerify(program),
          AddDiff(program),    AddReplay(program), AddExplain(program), AddParams(program),
          AddPhysics(program), AddFit(program),    AddWorld(program),   AddFrames(program),
          AddDetect(program),  AddDoctor(program)};
}

// What is wrong with a command line that the parser refuses. A word left over that no command took should have been a
// command.
std::string Refusal(const CLI::App& program, const CLI::ParseError& error) {
  const std::vector<std::string> left_over = program.remaining();
  if (left_over.empty()) return fmt::format("{}; 'ed3r --help' tells more", error.what());
  const std::string& word = left_over.front();
  if (word.starts_with('-')) return fmt::format("no option '{}'; 'ed3r --help' tells more", word);
  std::vector<std::string> known;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    known.push_back(command->get_name());
  const std::string suggestion = DidYouMean(word, known);
  return fmt::format("no command '{}'{}", word,
                     suggestion.empty() ? "; 'ed3r --help' lists the commands" : suggestion);
}

int Main(int argc, char** argv) {
  CLI::App program(
      "ed3r: flies declared studies of energy-aware wildfire detection and reports them with intervals");
  program.name("ed3r");
  program.require_subcommand(1);
  const CodeVersion code = ThisCode();
  program.set_version_flag("--version", fmt::format("ed3r {}{} source {}", code.commit,
                                                    code.dirty ? "+changes" : "", code.source_hash));
  const std::vector<Command> commands = AddCommands(program);
  try {
    program.parse(argc, argv);
    for (const Command& command : commands)
      if (command.parser->parsed()) return command.run();
    return kBadInput;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
    fmt::print(stderr, "ed3r: {}\n", Refusal(program, error));
    return kBadInput;
  } catch (const SimdLevelError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return kBadInput;
  } catch (const UserError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "ed3r: failed inside: {}\n", error.what());
    return kFailedInside;
  }
}

}  // namespace
}  // namespace ed3r

int main(int argc, char** argv) { return ed3r::Main(argc, argv); }
