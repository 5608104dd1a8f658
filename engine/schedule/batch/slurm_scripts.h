// The steps of a sweep as batch scripts for Slurm: to be read, edited and submitted by people.
//
//   common.sh          paths, the sweep and its options, and how a task ends
//   1-warmup.sbatch    one script per step, with its resources in #SBATCH lines
//   submit.sh          submits them, each step after the one before it
//
// The scripts decide nothing by what the scheduler says of a job: stores hold what has been flown, and every command goes on
// from there.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/schedule/batch/steps.h"

namespace ed3r::schedule {

// The line of common.sh that says how many shards a stage's flights are divided into stands behind this.
inline constexpr char kShardsLine[] = "\ntasks=";

// Seconds before the time limit at which tasks are told; Slurm may tell them up to a minute earlier.
inline constexpr int kNotice_s = 120;

struct SlurmOptions {
  std::string program;             // all paths are absolute
  std::vector<std::string> sweep;  // the sweep file and the options that change the plan
  std::string working_dir;         // which paths in them are relative to
  std::string run_dir, cache_dir;
  std::string partition, account, time, memory;  // as sbatch takes them; "" leaves it to the site
  std::string scratch;              // an expression of the shell, such as $TMPDIR; "": tasks write in place
  std::int64_t shards = 1;          // of the flights of a stage
  std::int64_t cpus = 1;            // per task
  std::int64_t array_limit = 1000;  // tasks of one array at most: the site's MaxArraySize less one
};

struct BatchFile {
  std::string name, content;
  bool executable = false;
};

std::vector<BatchFile> SlurmScripts(const std::string& sweep_name, const std::vector<BatchStep>& steps,
                                    const SlurmOptions& options);

}  // namespace ed3r::schedule
