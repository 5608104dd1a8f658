#include "studies/report/page_arms.h"

namespace ed3r::report {
namespace {

struct About {
  std::string_view strategy, words;
};

constexpr About kAbout[] = {
    {"random",
     "warm-up: moves by chance, and chance decides where a look is processed; networks learn from it"},
    {"random-offload",
     "warm-up of ECD²R: moves by chance and sends every look to the remote controller; networks learn from "
     "it"},
    {"rbs", "random walk: moves by chance; two fixed rules decide where a look is processed; learns nothing"},
    {"ed3r",
     "the paper's method: a network at the remote controller moves the robot, a second one on board decides "
     "where and with which detector each look is processed"},
    {"ablation-1", "moves as ED³R; processes every look on board with the Full detector"},
    {"ablation-2",
     "moves as ED³R; processes every look on board with the Quantized detector, the lighter one"},
    {"ablation-3", "moves as ED³R; processes every look on board, a network choosing between both detectors"},
    {"ablation-4", "moves as ED³R; sends every look to the remote controller"},
    {"ecd2r",
     "the paper's rival: sends every look to the remote controller, whose network moves the robot and has "
     "learned from a warm-up of its own"},
    {"look-level",
     "a baseline that the paper lacks: looks level all round, goes where it saw something; learns nothing"},
    {"external", "decided by a program outside the engine"},
};

}  // namespace

std::string_view AboutStrategy(std::string_view strategy) {
  for (const About& about : kAbout)
    if (about.strategy == strategy) return about.words;
  return "";
}

}  // namespace ed3r::report
