#include "engine/schedule/batch/slurm_scripts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numeric>

#include "engine/schedule/batch/shell.h"

namespace ed3r::schedule {
namespace {

constexpr int kCollectCpus = 1;  // merges, collecting and the report are single tasks of little work

constexpr char kCommon[] =
    R"sh(# What the batch scripts beside this file share. Written by 'ed3r slurm'; yours to edit.
scripts=$PWD                  # jobs begin in the folder that they were submitted from: this one
cd {working_dir} || exit 2
ed3r={program}
sweep=({sweep})
run={run_dir}                 # the merged run: 'ed3r status', 'ed3r report'
shards=$run/shards            # one store per task
cache={cache_dir}             # trained networks
tasks={shards}                # that the flights of a stage are divided into, at most: change it only with all scripts
scratch="{scratch}"           # a disk of the node's own to write on; the store is merged into the shared one at the end
# module load ...             # whatever the program needs on your site
threads=${{SLURM_CPUS_PER_TASK:-1}}

# task ARGUMENTS...: runs the program and passes on the signals of the batch system. It ends within seconds then, and keeps
# what is stored. How it ended decides what becomes of this one task:
#   75   stopped in time. After USR1, the notice before the time limit, it goes back into the queue by itself; after TERM
#        the scheduler decides: it requeues what it preempts, and not what somebody cancels.
#   >128 killed (memory, a node in trouble): back into the queue, three times at most.
again=
task() {{
  local child status waiting=yes notice=
  "$ed3r" "$@" &
  child=$!
  trap 'notice=USR1 waiting=yes; kill -USR1 "$child" 2>/dev/null' USR1
  trap 'notice=TERM waiting=yes; kill -TERM "$child" 2>/dev/null' TERM HUP
  while [ "$waiting" = yes ]; do
    waiting=no
    wait "$child" && status=0 || status=$?
  done
  trap - USR1 TERM HUP
  if [ "$notice" = USR1 ] && [ "$status" -eq 75 ]; then again=yes; fi
  if [ -z "$notice" ] && [ "$status" -gt 128 ] && [ "${{SLURM_RESTART_COUNT:-0}}" -lt 3 ]; then again=yes; fi
  return "$status"
}}

# finish STATUS: the end of a script
finish() {{
  [ -n "$again" ] || exit "$1"
  echo "ed3r ended with $1: this task goes back into the queue" >&2
  [ -z "${{SLURM_JOB_ID:-}}" ] || scontrol requeue "$SLURM_JOB_ID"
  exit 75  # sites with RequeueExit=75 requeue by this alone
}}

# fly STAGE TASK TASKS: one shard of a stage into its store
fly() {{
  local store=$shards/$1/$(printf '%05d' "$2") out status=0
  out=$store
  if [ -n "$scratch" ]; then
    if ! out=$(mktemp -d "$scratch/ed3r-XXXXXX" 2>/dev/null); then
      echo "no folder can be made in $scratch on $(hostname), the disk of --scratch; name one that every node has" >&2
      finish 2
    fi
    # By merge and not by cp: what a killed task has stored may still lie in the journal beside its file.
    if [ -s "$store/results.sqlite" ] && ! "$ed3r" merge "$out" "$store" >&2; then
      rm -rf "$out"
      finish 1
    fi
  fi
  task run "${{sweep[@]}}" --stage "$1" --shard "$2/$3" --from "$run" --out "$out" --cache "$cache" \
    --threads "$threads" --quiet || status=$?
  if [ -n "$scratch" ] && [ -s "$out/results.sqlite" ]; then
    # In one transaction, and to what another copy of this task may have brought home meanwhile. What cannot be brought home
    # stays where it is.
    if "$ed3r" merge "$store" "$out" >&2; then
      rm -rf "$out"
    else
      echo "the results of this task could not be moved to $store; they are in $out on $(hostname)" >&2
      [ "$status" -ne 0 ] || status=1
    fi
  elif [ -n "$scratch" ]; then  # it ended before it stored anything
    rm -rf "$out"
  fi
  [ "$status" -ne 3 ] || status=0  # some missions failed: the next step looks at the stores
  finish "$status"
}}
)sh";

constexpr char kSubmit[] = R"sh(#!/usr/bin/env bash
# Submits the steps of {name}, each after the one before it.
#   ./submit.sh                     all
#   ./submit.sh STEP [TASKS...]     from this step on, with these of its tasks; 'ed3r slurm SWEEP --missing' tells which
# TASKS are an array and what is added to its indices: 2,5-7+0
set -euo pipefail
cd "$(dirname "${{BASH_SOURCE[0]}}")"
mkdir -p logs
first=${{1:-1}}
shift || true
chosen=("$@")
after=()

# step NUMBER SCRIPT [ARRAY...]
step() {{
  local number=$1 script=$2 ids=() array job
  shift 2
  [ "$number" -ge "$first" ] || return 0
  [ "$number" -ne "$first" ] || [ ${{#chosen[@]}} -eq 0 ] || set -- "${{chosen[@]}}"
  for array in "${{@:-}}"; do
    job=$(sbatch --parsable ${{array:+--array="${{array%+*}}"}} "${{after[@]}}" "$script" "${{array#*+}}")
    ids+=("${{job%%;*}}")
    echo "$script${{array:+ $array}}: job ${{job%%;*}}"
  done
  after=(--dependency="afterok:$(IFS=:; echo "${{ids[*]}}")" --kill-on-invalid-dep=yes)
}}

)sh";

std::string Directives(const std::string& sweep_name, const BatchStep& step, const SlurmOptions& options) {
  const bool array = step.kind == BatchStep::Kind::kFly || step.kind == BatchStep::Kind::kTrain;
  // A training uses one thread for one network.
  const std::int64_t cpus = step.kind == BatchStep::Kind::kFly ? options.cpus : kCollectCpus;
  std::string text = "#!/usr/bin/env bash\n";
  text += fmt::format("#SBATCH --job-name={}-{}\n", sweep_name, step.name);
  text +=
      fmt::format("#SBATCH --output=logs/%x-{}.log\n#SBATCH --open-mode=append\n", array ? "%A_%a" : "%j");
  text += fmt::format("#SBATCH --ntasks=1\n#SBATCH --cpus-per-task={}\n", cpus);
  if (!options.partition.empty()) text += fmt::format("#SBATCH --partition={}\n", options.partition);
  if (!options.account.empty()) text += fmt::format("#SBATCH --account={}\n", options.account);
  if (!options.memory.empty())
    text += fmt::format("#SBATCH --mem={}\n", options.memory);
  else
    text +=
        "##SBATCH --mem=1G  # left to the site; one # less asks for it ('On a cluster' says how much is "
        "needed)\n";
  if (!options.time.empty()) text += fmt::format("#SBATCH --time={}\n", options.time);
  if (!options.time.empty() && array) text += fmt::format("#SBATCH --signal=B:USR1@{}\n", kNotice_s);
  if (step.expected_core_s > 0)
    text += fmt::format("# Expected: about {:.1f} minutes a task\n",
                        step.expected_core_s / 60 / static_cast<double>(step.tasks * cpus));
  return text + "#SBATCH --requeue\nset -uo pipefail\n. ./common.sh || exit 2\n\n";
}

std::string MergeCommands(const BatchStep& step, int number) {
  std::string text = fmt::format("\"$ed3r\" merge \"$run\" \"$shards\"/{}/*/ || exit\n", step.stage);
  if (step.in_rounds)
    return text + fmt::format(
                      "\"$ed3r\" status \"$run\" --stage {}\n"
                      "case $? in\n"
                      "  0) \"$scripts/submit.sh\" {} ;;   # every arm is known well enough\n"
                      "  75) \"$scripts/submit.sh\" {} ;;  # another round\n"
                      "  *) exit 3 ;;\n"
                      "esac\n",
                      step.stage, number + 1, number - 1);
  if (step.built_upon)
    return text +
           fmt::format(
               "# The steps after this one need all of its missions.\n\"$ed3r\" status \"$run\" --stage {}\n",
               step.stage);
  return text +
         fmt::format(
             "\"$ed3r\" status \"$run\" --stage {} || [ $? -eq 3 ]  # the report tells failed missions\n",
             step.stage);
}

std::string Commands(const BatchStep& step, int number) {
  switch (step.kind) {
    case BatchStep::Kind::kFly:
      return fmt::format("fly {} $((SLURM_ARRAY_TASK_ID + ${{1:-0}})) {}\n", step.stage, step.tasks);
    case BatchStep::Kind::kTrain:
      return fmt::format(
          "task run \"${{sweep[@]}}\" --stage {} --shard $((SLURM_ARRAY_TASK_ID + ${{1:-0}}))/{} --from "
          "\"$run\" \\\n"
          "  --cache \"$cache\" --threads \"$threads\" --quiet\nfinish $?\n",
          step.stage, step.tasks);
    case BatchStep::Kind::kCollect:
      return fmt::format(
          "# Finds the networks in the cache and puts them into the run.\n"
          "task run \"${{sweep[@]}}\" --stage {} --out \"$run\" --cache \"$cache\" --threads \"$threads\" "
          "--quiet\n"
          "finish $?\n",
          step.stage);
    case BatchStep::Kind::kMerge:
      return MergeCommands(step, number);
    case BatchStep::Kind::kReport:
      return "\"$ed3r\" report \"$run\" && \"$ed3r\" digest \"$run\"\n";
  }
  return "";
}

std::string SubmitSteps(const std::vector<BatchStep>& steps, std::int64_t array_limit) {
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const BatchStep& step = steps[i];
    text += fmt::format("step {} {}.sbatch", i + 1, step.name);
    if (step.kind == BatchStep::Kind::kFly || step.kind == BatchStep::Kind::kTrain) {
      std::vector<std::int64_t> tasks(static_cast<std::size_t>(step.tasks));
      std::iota(tasks.begin(), tasks.end(), 1);
      text += fmt::format(" {}", fmt::join(ArraysOf(tasks, array_limit), " "));
    }
    text += "\n";
    if (step.kind == BatchStep::Kind::kMerge && step.in_rounds)
      text += fmt::format(
          "[ \"$first\" -gt {} ] || exit 0  # step {} decides whether another round is due, and submits what "
          "follows\n",
          i + 1, i + 1);
  }
  return text;
}

}  // namespace

std::vector<BatchFile> SlurmScripts(const std::string& sweep_name, const std::vector<BatchStep>& steps,
                                    const SlurmOptions& options) {
  std::vector<BatchFile> files;
  files.push_back(
      {"common.sh", fmt::format(kCommon, fmt::arg("working_dir", ShellWord(options.working_dir)),
                                fmt::arg("program", ShellWord(options.program)),
                                fmt::arg("sweep", ShellWords(options.sweep)),
                                fmt::arg("run_dir", ShellWord(options.run_dir)),
                                fmt::arg("cache_dir", ShellWord(options.cache_dir)),
                                fmt::arg("shards", options.shards), fmt::arg("scratch", options.scratch))});
  for (std::size_t i = 0; i < steps.size(); ++i)
    files.push_back({steps[i].name + ".sbatch", Directives(sweep_name, steps[i], options) +
                                                    Commands(steps[i], static_cast<int>(i) + 1)});
  files.push_back(
      {"submit.sh",
       fmt::format(kSubmit, fmt::arg("name", sweep_name)) + SubmitSteps(steps, options.array_limit), true});
  return files;
}

}  // namespace ed3r::schedule
