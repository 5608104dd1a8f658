// Internal: a loss curve as model files and checkpoints hold it.
#pragma once

#include <vector>

#include "engine/core/files/sealed_file.h"
#include "engine/rfnn/training_report.h"

namespace ed3r::rfnn {

inline void PutCurve(const std::vector<EpochLoss>& curve, ByteWriter& out) {
  std::vector<double> values;
  for (const EpochLoss& loss : curve) values.insert(values.end(), {loss.train, loss.validation});
  out.F64s(values);
}

inline std::vector<EpochLoss> TakeCurve(ByteReader& in) {
  const std::vector<double> values = in.F64s();
  if (values.size() % 2 != 0) in.Refuse("is damaged: half an epoch in its loss curve");
  std::vector<EpochLoss> curve;
  for (std::size_t i = 0; i < values.size(); i += 2) curve.push_back({values[i], values[i + 1]});
  return curve;
}

}  // namespace ed3r::rfnn
