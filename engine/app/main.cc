#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <opencv2/core.hpp>
#include <system_error>

#include "engine/app/command_line.h"
#include "engine/app/commands.h"
#include "engine/app/commands/slurm.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/interrupt.h"
#include "engine/core/message.h"
#include "engine/core/version.h"
#include "engine/store/sqlite.h"
#include "kernels/simd_level.h"

namespace ed3r::app {
namespace {

std::vector<Command> AddCommands(CLI::App& app) {
  Program program(&app);
  return {AddRun(program),     AddPlan(program),    AddStatus(program), AddReport(program),
          AddCompare(program), AddDigest(program),  AddMerge(program),  AddSlurm(program),
          AddVerify(program),  AddDiff(program),    AddReplay(program), AddExplain(program),
          AddParams(program),  AddPhysics(program), AddFit(program),    AddWorld(program),
          AddFrames(program),  AddDetect(program),  AddExport(program), AddDoctor(program)};
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

std::string VersionText() {
  const CodeVersion code = ThisCode();
  return fmt::format("ed3r {} (commit {}{}, source {}, {})", code.release, code.commit,
                     code.dirty ? " with changes" : "", code.source_hash,
                     kernels::SimdLevelName(kernels::ActiveSimdLevel()));
}

int RunCommand(int argc, char** argv, CLI::App& program) {
  program.name("ed3r");
  program.require_subcommand(1);
  program.set_version_flag("--version", VersionText);
  const std::vector<Command> commands = AddCommands(program);
  try {
    std::vector<std::string> words = Words(argc, argv);
    program.parse(words);
    for (const Command& command : commands)
      if (command.parser.Chosen()) return command.run();
    return kBadInput;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
    Tell("{}", OneLine("ed3r: " + Refusal(program, error)));
    return kBadInput;
  }
}

int output_error = 0;  // why a print failed that was more than the buffer holds

int Main(int argc, char** argv) {
  CLI::App program(
      "ed3r: flies declared studies of energy-aware wildfire detection and reports them with intervals");
  try {
    return RunCommand(argc, argv, program);
  } catch (const kernels::SimdLevelError& error) {
    Tell("{}", error.what());
    return kBadInput;
  } catch (const UserError& error) {
    Tell("{}", OneLine(error.what()));
    return kBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    Tell("{}", OneLine(fmt::format("{}: {}", error.path1().string(), error.code().message())));
    return kBadInput;
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) == 0)
      Tell("{}", OneLine(fmt::format("ed3r: failed inside: {}", error.what())));
    else
      output_error = error.code().value();  // told at the end
    return kFailedInside;
  } catch (const std::bad_alloc&) {
    Tell("ed3r: out of memory");
    return kFailedInside;
  } catch (const cv::Exception& error) {
    Tell("{}", error.code == cv::Error::StsNoMem
                   ? "ed3r: out of memory"
                   : OneLine(fmt::format("ed3r: failed inside: {}", error.what())));
    return kFailedInside;
  } catch (const store::StoreError& error) {
    Tell("{}", OneLine(error.what()));
    return kFailedInside;
  } catch (const std::exception& error) {
    Tell("{}", OneLine(fmt::format("ed3r: failed inside: {}", error.what())));
    return kFailedInside;
  }
}

// What was printed must have arrived, or the status says so.
int Delivered(int status) {
  errno = 0;
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  const int error = output_error != 0 ? output_error : errno;
  if (flushed && std::ferror(stdout) == 0 && std::cout) return status;
  Tell("ed3r: standard output cannot be written{}{}", error == 0 ? "" : ": ",
       error == 0 ? "" : std::strerror(error));
  return status == kDone ? kFailedInside : status;
}

// A descriptor that was closed by whoever started us would be that of the next file that is opened, a results file
// perhaps, and what is printed would land in it. In its place stands one that cannot be written.
void FillStandardDescriptors() {
  for (int descriptor = open("/dev/null", O_RDONLY); descriptor >= 0;
       descriptor = open("/dev/null", O_RDONLY))
    if (descriptor > STDERR_FILENO) {
      close(descriptor);
      return;
    }
}

}  // namespace

void FlushOutput() {
  if (std::fflush(stdout) != 0 && output_error == 0)
    output_error = errno;  // a second flush would not know it
}

}  // namespace ed3r::app

int main(int argc, char** argv) {
  ed3r::app::FillStandardDescriptors();
  // A file that grows beyond its limit is an error of the write, told like any other.
  std::signal(SIGXFSZ, SIG_IGN);
  ed3r::EndOnInterrupt({.interrupted = ed3r::app::kInterrupted, .requeue = ed3r::app::kRequeue});
  return ed3r::app::Delivered(ed3r::app::Main(argc, argv));
}
