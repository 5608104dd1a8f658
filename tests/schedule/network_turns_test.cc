#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "engine/schedule/training_stage.h"

namespace ed3r::schedule {
namespace {

// 14 sites and 2 base stations, as the paper's world has them.
constexpr int kPlaces = 28;

TEST(NetworkTurnsTest, EveryNetworkMeetsEveryPlaceAsOften) {
  for (const int networks : {1, 2, 5, 20, 28, 30}) {
    std::map<std::pair<int, int>, int> meetings;
    for (int mission = 0; mission < kPlaces * networks; ++mission)
      ++meetings[{NetworkOfMission(mission, kPlaces, networks), mission % kPlaces}];
    EXPECT_EQ(meetings.size(), static_cast<std::size_t>(kPlaces * networks)) << networks;
  }
}

// The first missions of an arm explore most: they are nobody's alone.
TEST(NetworkTurnsTest, EveryRoundIsSharedByAllNetworks) {
  for (int round = 0; round < 5; ++round) {
    std::map<int, int> flown;
    for (int i = 0; i < kPlaces; ++i) ++flown[NetworkOfMission(round * kPlaces + i, kPlaces, 20)];
    EXPECT_EQ(flown.size(), 20u);
    for (const auto& [network, missions] : flown) EXPECT_LE(missions, 2) << network;
  }
}

}  // namespace
}  // namespace ed3r::schedule
