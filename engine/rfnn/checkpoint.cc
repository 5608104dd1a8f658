#include "engine/rfnn/checkpoint.h"

#include "engine/core/files/sealed_file.h"
#include "engine/rfnn/curve_bytes.h"

namespace ed3r::rfnn {
namespace {

constexpr SealedFormat kFormat = {"ED3RTRCP", 1, "training checkpoint"};

}  // namespace

void WriteCheckpoint(const std::string& path, const Checkpoint& checkpoint) {
  ByteWriter out;
  out.Text(checkpoint.key);
  out.U64(checkpoint.trainer.steps);
  for (const auto* floats : {&checkpoint.trainer.parameters, &checkpoint.trainer.first_moments,
                             &checkpoint.trainer.second_moments, &checkpoint.best_weights})
    out.F32s(*floats);
  out.F64(checkpoint.best_validation);
  out.U32(static_cast<std::uint32_t>(checkpoint.best_epoch));
  PutCurve(checkpoint.curve, out);
  WriteSealedFile(path, kFormat, out.bytes());
}

Checkpoint ReadCheckpoint(const std::string& path, const std::string& key, std::size_t parameters) {
  const std::string payload = ReadSealedFile(path, kFormat);
  ByteReader in(payload, path, kFormat);
  Checkpoint checkpoint;
  checkpoint.key = in.Text();
  if (checkpoint.key != key) in.Refuse("belongs to another training; delete it to start anew");
  checkpoint.trainer.steps = in.U64();
  for (auto* floats : {&checkpoint.trainer.parameters, &checkpoint.trainer.first_moments,
                       &checkpoint.trainer.second_moments, &checkpoint.best_weights}) {
    *floats = in.F32s();
    if (floats->size() != parameters) in.Refuse("is of another network; delete it to start anew");
  }
  checkpoint.best_validation = in.F64();
  checkpoint.best_epoch = static_cast<int>(in.U32());
  checkpoint.curve = TakeCurve(in);
  in.End();
  return checkpoint;
}

}  // namespace ed3r::rfnn
