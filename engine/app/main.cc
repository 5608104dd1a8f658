#include <fmt/format.h>
#include <unistd.h>

#include <exception>

#include "engine/app/commands.h"
#include "engine/core/check.h"
#include "engine/core/version.h"
#include "kernels/simd_level.h"

namespace ed3r {
namespace {

std::vector<Command> AddCommands(CLI::App& program) {
  return {AddRun(program),     AddPlan(program),   AddStatus(program),  AddReport(program),
          AddCompare(program), AddDigest(program), AddMerge(program),   AddReplay(program),
          AddExplain(program), AddParams(program), AddPhysics(program), AddFit(program),
          AddWorld(program),   AddFrames(program), AddDetect(program),  AddDoctor(program)};
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
    fmt::print(stderr, "ed3r: {}; 'ed3r --help' tells more\n", error.what());
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
