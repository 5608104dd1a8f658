// Supervised training of the networks on the warm-up log (paper: ED3R Configuration Setup; R18).
#pragma once

#include "engine/config/field.h"

namespace ed3r {

struct TrainingConfig {
  double learning_rate = 5e-6;
  int batch = 128;
  double dropout = 0.1;
  int epochs = 2000;
  int patience = 10;
  double min_delta = 0.0;
  int seeds = 1;
  int seed = 1;
  bool own_warmups = false;
  int split_seed = 1;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    constexpr std::string_view kSetup = "ED3R Configuration Setup";
    visit("learning_rate", self.learning_rate,
          {.min = 1e-9, .max = 1, .source = kSetup, .meaning = "step size of Adam"});
    visit("batch", self.batch, {.min = 1, .max = 65536, .source = kSetup, .meaning = "rows of a step"});
    visit("dropout", self.dropout,
          {.min = 0,
           .max = 0.9,
           .source = kSetup,
           .meaning = "probability that a hidden neuron is zeroed in a step"});
    visit("epochs", self.epochs, {.min = 1, .max = 100000, .source = kSetup, .meaning = "at most"});
    visit("patience", self.patience,
          {.min = 1,
           .max = 100000,
           .source = kSetup,
           .meaning = "epochs without a better validation error that end a training; the best weights stay"});
    visit("min_delta", self.min_delta,
          {.min = 0,
           .max = 1,
           .source = "R18",
           .meaning = "how much smaller the standardised validation error must be to count as better"});
    visit("seeds", self.seeds,
          {.min = 1,
           .max = 1000,
           .source = "R18",
           .meaning =
               "networks of each kind; they differ in initial weights, shuffles and dropout, and in their "
               "warm-up where training.own_warmups gives each its own"});
    visit("seed", self.seed,
          {.min = 0,
           .max = 1000000000,
           .source = "R18",
           .meaning = "training seed of the first network; the others follow on"});
    visit(
        "own_warmups", self.own_warmups,
        {.source = "R18",
         .meaning =
             "every network of a kind learns from warm-up missions of its own: the warm-up in as many equal "
             "parts as there are networks; otherwise each learns from all of it"});
    visit(
        "split_seed", self.split_seed,
        {.min = 0,
         .max = 1000000000,
         .source = "R18",
         .meaning = "which missions are held out: the same for all networks, so that their errors compare"});
  }
};

}  // namespace ed3r
