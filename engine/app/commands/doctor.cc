#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "engine/app/commands.h"
#include "engine/app/machine.h"
#include "engine/core/json_text.h"
#include "engine/core/random.h"
#include "engine/robot/energy.h"
#include "engine/world/geometry.h"

namespace ed3r::app {
namespace {

struct Check {
  std::string name;
  bool passed;
  std::string detail;
};

Check CheckRandom() {
  Stream stream(0, 0, static_cast<Purpose>(0));
  const bool passed = stream.Bits() == 0x6627e8d5U;  // known answer of Philox4x32-10
  return {"random streams", passed, "Philox4x32-10 known answer"};
}

Check CheckPhysics() {
  const double hover_w = robot::MovementPowerOf({}, {}, {}).hover_w;
  return {"closed forms", std::abs(hover_w - 135.3) < 0.05,
          fmt::format("hover {:.2f} W, readings say 135.3 W", hover_w)};
}

Check CheckRays() {
  world::TriangleMesh mesh;
  mesh.vertices_m = {{-100, -100, 0}, {100, -100, 0}, {0, 100, 0}};
  mesh.triangles = {{0, 1, 2}};
  const world::StaticGeometry geometry(std::move(mesh));
  const double distance_m = geometry.Distance({0, 0, 7}, {0, 0, -1}, 30.0);
  return {"rays", std::abs(distance_m - 7.0) < 1e-4,
          fmt::format("ground found at {} m, it is at 7 m", distance_m)};
}

Check CheckThreads() {
  const int wanted = static_cast<int>(std::thread::hardware_concurrency());
  const int obtained = ObtainedThreads(wanted);
  return {"threads", obtained == wanted, fmt::format("{} of {} obtained", obtained, wanted)};
}

std::vector<Check> Checks() { return {CheckRandom(), CheckPhysics(), CheckRays(), CheckThreads()}; }

int Examine(bool json) {
  const auto machine = DescribeMachine();
  const std::vector<Check> checks = Checks();
  bool healthy = true;
  for (const Check& check : checks) healthy = healthy && check.passed;
  if (json) {
    nlohmann::ordered_json object;
    for (const auto& [name, value] : machine) object["machine"][name] = value;
    for (const Check& check : checks)
      object["checks"].push_back({{"name", check.name}, {"passed", check.passed}, {"detail", check.detail}});
    object["healthy"] = healthy;
    fmt::print("{}\n", JsonText(object));
  } else {
    for (const auto& [name, value] : machine) fmt::print("{:<16} {}\n", name, value);
    fmt::print("\n");
    for (const Check& check : checks)
      fmt::print("{:<16} {:<6} {}\n", check.name, check.passed ? "ok" : "FAILED", check.detail);
  }
  return healthy ? kDone : kFailedInside;
}

}  // namespace

Command AddDoctor(Program& program) {
  auto json = std::make_shared<bool>(false);
  CommandLine parser =
      program.AddCommand("doctor", "CPU, SIMD level, threads, library versions, sanity checks");
  parser.Flag("--json", *json, "Print JSON");
  return {parser, [json] { return Examine(*json); }};
}

}  // namespace ed3r::app
