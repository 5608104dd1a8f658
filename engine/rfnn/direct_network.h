// A network that decides by itself: from what an agent sees to the values of its decision, without candidates.
//
//   RC     8 inputs (the state of kRcFeatures) to 5 values: the action of kRcFeatures, in its order and units
//   robot  9 inputs (the state of kRobotFeatures) to 3: one for each of kRobotActions, of which the largest is taken
//
// Threads: immutable; any number of threads may ask, each with a Workspace of its own. The same bits at every SIMD level.
#pragma once

#include <span>
#include <vector>

#include "engine/rfnn/model.h"

namespace ed3r::rfnn {

class DirectNetwork {
 public:
  // One network of the same inputs for each value; hidden layers that they share are computed anew, which costs
  // microseconds. Other designs are an InternalError.
  explicit DirectNetwork(std::vector<Model> values);

  std::size_t values() const { return values_.size(); }

  // state: raw values, as many as inputs. decision: values() values. A value that is not finite is an InternalError.
  void Decide(std::span<const double> state, std::span<double> decision, Model::Workspace& workspace) const;

 private:
  std::vector<Model> values_;
};

}  // namespace ed3r::rfnn
