#include "engine/app/machine.h"

#include <LinearMath/btScalar.h>
#include <ceres/version.h>
#include <embree3/rtcore_config.h>
#include <fmt/format.h>
#include <gdal_version.h>
#include <omp.h>
#include <sqlite3.h>
#include <unistd.h>

#include <Eigen/Core>
#include <fstream>
#include <opencv2/core/version.hpp>
#include <thread>

#include "engine/core/files/shipped.h"
#include "engine/core/math_library.h"
#include "engine/core/threads.h"
#include "engine/core/version.h"
#include "kernels/simd_level.h"

namespace ed3r::app {
namespace {

// First value of a "name : value" line of a /proc file; "unknown" when there is none.
std::string ProcValue(const char* path, const std::string& name) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(name)) continue;
    const auto colon = line.find(':');
    const auto value = line.find_first_not_of(" \t", colon + 1);
    if (colon != std::string::npos && value != std::string::npos) return line.substr(value);
  }
  return "unknown";
}

}  // namespace

int ObtainedThreads(int wanted) {
  // OpenCV switches OpenMP to dynamic teams, which a loaded machine shrinks to one thread.
  omp_set_dynamic(0);
  int obtained = 1;
  const int possible = PossibleThreads(wanted);
  WithTeam(possible, [&] {
#pragma omp parallel num_threads(possible)
#pragma omp single
    obtained = omp_get_num_threads();
  });
  return obtained;
}

std::map<std::string, std::string> DescribeMachine() {
  const CodeVersion code = ThisCode();
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return {
      {"cpu", ProcValue("/proc/cpuinfo", "model name")},
      {"cores", std::to_string(cores)},
      {"memory", ProcValue("/proc/meminfo", "MemTotal")},
      {"simd", kernels::SimdLevelName(kernels::ActiveSimdLevel())},
      {"simd_supported", kernels::SupportedSimdLevels()},
      {"openmp_threads", std::to_string(ObtainedThreads(cores))},
      {"compiler", code.compiler},
      {"flags", code.flags},
      {"release", code.release},
      {"shipped sweeps", ShippedSweeps().string()},
      {"commit", fmt::format("{}{}", code.commit, code.dirty ? " with uncommitted changes" : "")},
      {"libm", MathLibraryIdentity()},
      {"source", fmt::format("flight {}, pixels {}, training {}, precision {}", code.flight, code.pixels,
                             code.training, code.precision)},
      {"lib bullet", fmt::format("{}.{}", BT_BULLET_VERSION / 100, BT_BULLET_VERSION % 100)},
      {"lib ceres", CERES_VERSION_STRING},
      {"lib eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"lib embree", RTC_VERSION_STRING},
      {"lib gdal", GDAL_RELEASE_NAME},
      {"lib opencv", CV_VERSION},
      {"lib sqlite", sqlite3_libversion()},
  };
}

}  // namespace ed3r::app
