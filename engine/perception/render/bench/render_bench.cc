// Measures where the time of one sensing period goes, over views of the kind that detectors are trained on.
//
//   render_bench WORLD.yaml [VIEWS [WxH [FRAMES]]]     default: 200 views, 192x108, 7 frames
//
// For each part: milliseconds of CPU time per sensing period, median and mean over the views, one thread.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "engine/perception/render/plume.h"
#include "engine/perception/render/renderer.h"
#include "engine/perception/render/shade.h"
#include "engine/perception/render/training_views.h"

namespace ed3r::perception {
namespace {

constexpr std::uint64_t kSeed = 7;

double ThreadMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

struct Part {
  const char* name;
  std::vector<double> ms;
};

// The least of three runs: what the work takes when nothing else disturbs it.
template <class Call>
void Measure(Part& part, Call call) {
  double least = 1e300;
  for (int run = 0; run < 3; ++run) {
    const double start = ThreadMs();
    call();
    least = std::min(least, ThreadMs() - start);
  }
  part.ms.push_back(least);
}

void Run(const std::string& world, int views, PictureSize size, int frames) {
  const std::shared_ptr<const world::Scene> scene = world::Scene::Load(world);
  const std::vector<std::shared_ptr<const TraceScene>> scenes = {std::make_shared<TraceScene>(*scene)};
  const Config config;
  const PixelGrid grid{size.width_px, size.height_px, 2};
  std::vector<PlumePhase> phases(static_cast<std::size_t>(frames));
  for (std::size_t i = 0; i < phases.size(); ++i) phases[i].time_s = static_cast<double>(i) / 6.6;
  std::vector<int> numbers(phases.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  std::array<Part, 4> parts = {{{"trace", {}}, {"shade", {}}, {"fire and smoke", {}}, {"all", {}}}};
  for (int view = 0; view < views; ++view) {
    const auto number = static_cast<std::uint32_t>(view);
    const ViewPlan plan = PlanView(scenes, config, kSeed, number);
    const Renderer renderer(scenes[0], plan.site, config.perception, config.sensing, kSeed, number);
    const world::FireSite& site = scene->Sites()[static_cast<std::size_t>(plan.site)];
    SensingTrace trace;
    StillPicture still;
    Measure(parts[0], [&] {
      trace = scenes[0]->Trace(plan.pose, config.sensing, grid, renderer.Weather(), renderer.Props());
    });
    Measure(parts[1], [&] { still = Shade(trace, *scene, renderer.Weather(), renderer.Props(), &site); });
    Measure(parts[2], [&] { TracePlume(trace, site, scene->Fire(), renderer.Weather(), still.fog, phases); });
    Measure(parts[3], [&] { renderer.Sense(plan.pose, 1, numbers, size); });
  }
  fmt::print("{}, {} views, {} frames of {} x {} px, rays in {}\n", scene->Name(), views, frames,
             size.width_px, size.height_px, world::RayInstructionSet());
  for (Part& part : parts) {
    std::sort(part.ms.begin(), part.ms.end());
    const double mean =
        std::accumulate(part.ms.begin(), part.ms.end(), 0.0) / static_cast<double>(part.ms.size());
    fmt::print("{:<28} median {:7.3f} ms   mean {:7.3f} ms   largest {:7.3f} ms\n", part.name,
               part.ms[part.ms.size() / 2], mean, part.ms.back());
  }
}

}  // namespace
}  // namespace ed3r::perception

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: render_bench WORLD.yaml [VIEWS [WxH [FRAMES]]]\n");
    return 2;
  }
  ed3r::perception::PictureSize size{192, 108};
  if (argc > 3 && std::sscanf(argv[3], "%dx%d", &size.width_px, &size.height_px) != 2) return 2;
  const int frames = argc > 4 ? std::clamp(std::atoi(argv[4]), 1, 33) : 7;
  try {
    ed3r::perception::Run(argv[1], argc > 2 ? std::max(1, std::atoi(argv[2])) : 200, size, frames);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "render_bench: {}\n", error.what());
    return 1;
  }
}
