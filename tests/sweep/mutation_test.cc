// Damaged sweep files: whatever the text, the answer is a plan or one line that says where.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <random>

#include "tests/sweep/scratch.h"

namespace ed3r::sweep {
namespace {

constexpr const char* kEverything =
    "# Does it hold?\n"
    "name: everything\n"
    "missions: 85\n"
    "seed: 20260101\n"
    "set:\n"
    "  mission.strategy: rbs\n"
    "  robot: {mass_kg: 2, speed_mps: 4.5}\n"
    "sweep:\n"
    "  radio.path_loss_exponent: {range: [3.0, 4.0, 0.2]}\n"
    "  zip: {robot.battery_mah: [1000, 2000], robot.battery_v: [11.1, 14.8]}\n"
    "where: [\"radio.path_loss_exponent < 3.9 and not (robot.battery_v == 14.8)\"]\n"
    "stages:\n"
    "  - {name: warmup, missions: 204, set: {strategy: random}}\n"
    "  - {name: training, kind: train, after: warmup}\n"
    "  - name: online\n"
    "    after: [training]\n"
    "    set: {agents.eta_int: 0.1}\n"
    "    sweep:\n"
    "      list:\n"
    "        - {name: ed3r-75, agents.eta_min: 0.75}\n"
    "        - {agents.eta_min: 0.65}\n"
    "    where: agents.eta_min != 0.65 or radio.path_loss_exponent >= 3.4\n";

constexpr const char* kTokens[] = {"[",        "]",      "{",
                                   "}",        ":",      ": ",
                                   ",",        "-",      "- ",
                                   "\n",       "\n  ",   "#",
                                   "&a ",      "*a",     "!!x ",
                                   "'",        "\"",     "|",
                                   ">",        "?",      "---\n",
                                   "<<: ",     "~",      "0",
                                   "-1",       "1e999",  "99999999999999999999",
                                   "nan",      "(",      ")",
                                   " and ",    " not ",  "==",
                                   "!",        "range",  "zip",
                                   "list",     "name: ", "base: x.yaml\n",
                                   "\t",       "\r",     "\xff",
                                   "\xc2\xb3", "stages", "%YAML 9.9\n"};

class Mutator {
 public:
  explicit Mutator(std::uint32_t seed) : random_(seed) {}

  std::string Damaged(std::string text) {
    for (std::size_t n = 1 + Below(4); n > 0; --n) text = DamagedOnce(std::move(text));
    return text;
  }

 private:
  std::size_t Below(std::size_t bound) { return bound == 0 ? 0 : random_() % bound; }

  std::string DamagedOnce(std::string text) {
    const std::size_t at = Below(text.size() + 1);
    const std::size_t length = std::min(Below(40), text.size() - at);
    switch (Below(6)) {
      case 0:
        return text.insert(at, kTokens[Below(std::size(kTokens))]);
      case 1:
        return text.erase(at, length);
      case 2:
        return text.insert(Below(text.size() + 1), text.substr(at, length));
      case 3:
        return text.replace(at, length, kTokens[Below(std::size(kTokens))]);
      case 4:
        if (at < text.size()) text[at] = static_cast<char>(Below(256));
        return text;
      default:
        return text.substr(0, at);
    }
  }

  std::mt19937 random_;
};

TEST(MutationTest, DamagedFilesAreReadOrRefusedInOneLine) {
  const ScratchFolder scratch;
  Mutator mutator(1);
  int accepted = 0;
  int refused = 0;
  for (int i = 0; i < 6000; ++i) {
    const std::string text = mutator.Damaged(kEverything);
    const std::string file = scratch.Write(std::to_string(i) + ".yaml", text);
    try {
      EXPECT_FALSE(LoadSweep(file).stages.empty());
      ++accepted;
    } catch (const UserError& error) {
      const std::string message = error.what();
      ASSERT_TRUE(message.starts_with(file + ":")) << message << "\n" << text;
      ASSERT_TRUE(std::all_of(message.begin(), message.end(),
                              [](char c) { return static_cast<unsigned char>(c) >= 0x20; }))
          << message << "\n"
          << text;
      ++refused;
    } catch (const std::exception& error) {
      FAIL() << "neither a plan nor a refusal: " << error.what() << "\n" << text;
    }
    std::filesystem::remove(file);
  }
  // Both ways must be exercised.
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace ed3r::sweep
