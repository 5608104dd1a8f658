// Counter-based random streams (Philox4x32-10 of Random123).
//
// A draw is a pure function of (seed, scenario, purpose, timestep, index): nothing is shared between threads
// and nothing has a history. Two arms that fly the same scenario therefore meet the same fire, radio and CPU
// draws (common random numbers), and an extra draw in one arm shifts nothing in another.
#pragma once

#include <cstdint>

namespace ed3r {

// What a stream is for. The numbers are part of every stored result: append, never renumber.
enum class Purpose : std::uint32_t {
  kScenario = 1,           // start pose
  kDistractors = 2,        // per-mission sources of false confidence (R34)
  kCpu = 3,                // f_k
  kBandwidth = 4,          // b_k
  kShadowing = 5,          // shadow fading of timestep k
  kFrames = 6,             // per-frame fluctuation of the confidence
  kMotion = 7,             // random motion commands
  kExecution = 8,          // random choices of the robot
  kExploration = 9,        // epsilon draws of the RC
  kCandidates = 10,        // candidate actions of the RC
  kWind = 11,              // gusts
  kRobotExploration = 12,  // epsilon draws of the robot
  kWorld = 13,             // terrain, trees
  kTraining = 14,          // initial weights, shuffles, dropout
  kBootstrap = 15,         // resampling in studies
  kAmbience = 16,          // sun, weather, season and kinds of distractors of a mission
  kRendering = 17,         // flicker, jitter and sensor noise of a sensing period
  kDataSet = 18,           // poses of the views in a training set
  kView = 19,              // fluctuation of the confidence from view to view
  kSites = 20,             // places of a world's drawn fire sites
};

// One stream of draws. Cheap to make (no state beyond the counter); make one where it is used.
class Stream {
 public:
  Stream(std::uint64_t seed, std::uint32_t scenario, Purpose purpose, std::uint32_t timestep = 0);

  std::uint32_t Bits();                      // 32 uniform bits
  double Uniform();                          // [0, 1), 53 bits
  double Uniform(double low, double high);   // [low, high)
  std::uint32_t Below(std::uint32_t bound);  // 0 .. bound-1, unbiased; bound > 0
  double Normal();                           // mean 0, standard deviation 1

 private:
  void Refill();

  std::uint32_t key_[2];
  std::uint32_t counter_[4];
  std::uint32_t block_[4] = {};
  int used_ = 4;
  double spare_normal_ = 0.0;
  bool has_spare_normal_ = false;
};

}  // namespace ed3r
