#include "engine/rfnn/train_all.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>

#include "engine/core/check.h"
#include "engine/core/phase.h"
#include "engine/core/threads.h"
#include "engine/rfnn/model_file.h"

namespace ed3r::rfnn {
namespace {

std::string CachePath(const std::string& cache, const TrainJob& job, const std::string& key) {
  return (std::filesystem::path(cache) / fmt::format("{}-{}.rfnn", job.design.name, key.substr(0, 32)))
      .string();
}

void MakeFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw UserError(fmt::format("{}: cannot make this folder for networks: {}", folder, error.message()));
}

// One job: from the cache, or trained and put there.
std::shared_ptr<const Model> TrainOne(const TrainJob& job, const std::string& path, TrainControl control) {
  if (path.empty()) {
    std::optional<Model> model = Train(job, control);
    return model ? std::make_shared<const Model>(std::move(*model)) : nullptr;
  }
  if (std::filesystem::exists(path))
    return std::make_shared<const Model>(ReadModel(path, job.design, TrainingKey(job)));
  control.checkpoint = path + ".checkpoint";
  std::optional<Model> model = Train(job, control);
  if (!model) return nullptr;
  WriteModel(path, *model);
  std::error_code ignored;  // another process may have removed it
  std::filesystem::remove(control.checkpoint, ignored);
  return std::make_shared<const Model>(std::move(*model));
}

// Distinct jobs, the most work first, so that no long training is left for the end.
std::vector<std::size_t> Order(std::span<const TrainJob> jobs, std::span<const std::size_t> first_equal) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    if (first_equal[i] == i) order.push_back(i);
  const auto work = [&](std::size_t i) {
    return jobs[i].data->rows() * kernels::ParameterCount(ShapeOf(jobs[i].design));
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return work(a) > work(b); });
  return order;
}

}  // namespace

std::string CachePath(const std::string& cache, const TrainJob& job) {
  return CachePath(cache, job, TrainingKey(job));
}

std::vector<std::shared_ptr<const Model>> TrainAll(std::span<const TrainJob> jobs,
                                                   const TrainAllOptions& options) {
  if (!options.cache.empty()) MakeFolder(options.cache);
  std::vector<std::string> paths;
  std::vector<std::size_t> first_equal;
  std::map<std::string, std::size_t> known;
  for (const TrainJob& job : jobs) {
    const std::string key = TrainingKey(job);
    first_equal.push_back(known.emplace(key, paths.size()).first->second);
    paths.push_back(options.cache.empty() ? "" : CachePath(options.cache, job, key));
  }
  const std::vector<std::size_t> order = Order(jobs, first_equal);

  std::vector<std::shared_ptr<const Model>> models(jobs.size());
  std::vector<std::exception_ptr> errors(jobs.size());
  std::mutex reporting;
  const auto train = [&](std::size_t i) {
    const WatchedThread watched;
    const InPhase training(Phase::kTraining);
    TrainControl control;
    control.stop = options.stop;
    control.level = options.level;
    if (options.on_epoch)
      control.on_epoch = [&, i](int epoch, const EpochLoss& loss) {
        const std::lock_guard lock(reporting);
        options.on_epoch(i, epoch, loss);
      };
    try {
      models[i] = TrainOne(jobs[i], paths[i], std::move(control));
      if (options.on_done && models[i]) {
        const std::lock_guard lock(reporting);
        options.on_done(i);
      }
    } catch (...) {
      errors[i] = std::current_exception();
    }
  };
  const int threads = std::max(1, options.threads);
  WithTeam(threads, [&] {
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
    for (std::size_t at = 0; at < order.size(); ++at) train(order[at]);
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  for (std::size_t i = 0; i < jobs.size(); ++i) models[i] = models[first_equal[i]];
  return models;
}

}  // namespace ed3r::rfnn
