#include "engine/rfnn/model_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/core/files/sealed_file.h"
#include "engine/core/sha256.h"
#include "engine/rfnn/curve_bytes.h"

namespace ed3r::rfnn {
namespace {

constexpr SealedFormat kFormat = {"ED3RRFNN", 2, "model file"};

// Everything that must agree before weights mean anything, as one text.
std::string DesignText(const NetworkDesign& design) {
  return fmt::format("{} network, {} of {} inputs are state ({}), hidden layers {}", design.name,
                     design.states, design.inputs(), fmt::join(design.features, " "),
                     fmt::join(design.hidden, " x "));
}

void PutScore(const FitScore& score, ByteWriter& out) {
  out.U64(static_cast<std::uint64_t>(score.rows));
  out.U64(static_cast<std::uint64_t>(score.missions));
  for (const double value : {score.mse, score.r2, score.mae, score.rmse}) out.F64(value);
}

FitScore TakeScore(ByteReader& in) {
  FitScore score;
  score.rows = static_cast<int>(in.U64());
  score.missions = static_cast<int>(in.U64());
  for (double* value : {&score.mse, &score.r2, &score.mae, &score.rmse}) *value = in.F64();
  return score;
}

void PutReport(const TrainingReport& report, ByteWriter& out) {
  PutCurve(report.curve, out);
  out.U32(static_cast<std::uint32_t>(report.best_epoch));
  out.U32(report.stopped_early ? 1 : 0);
  for (const FitScore* score : {&report.train, &report.validation, &report.test}) PutScore(*score, out);
}

TrainingReport TakeReport(ByteReader& in) {
  TrainingReport report;
  report.curve = TakeCurve(in);
  report.best_epoch = static_cast<int>(in.U32());
  report.stopped_early = in.U32() != 0;
  for (FitScore* score : {&report.train, &report.validation, &report.test}) *score = TakeScore(in);
  return report;
}

void PutScaling(const Scaling& scaling, ByteWriter& out) {
  out.F64s(scaling.input_mean);
  out.F64s(scaling.input_sd);
  out.F64(scaling.target_mean);
  out.F64(scaling.target_sd);
}

Scaling TakeScaling(ByteReader& in) {
  Scaling scaling;
  scaling.input_mean = in.F64s();
  scaling.input_sd = in.F64s();
  scaling.target_mean = in.F64();
  scaling.target_sd = in.F64();
  return scaling;
}

template <class Values>
bool AllFinite(const Values& values) {
  return std::all_of(values.begin(), values.end(), [](auto value) { return std::isfinite(value); });
}

// Its checksum held, so that whoever wrote it is at fault; it is refused all the same.
void CheckUsable(const ModelData& data, const NetworkDesign& design, const ByteReader& in) {
  const auto inputs = static_cast<std::size_t>(design.inputs());
  const Scaling& scaling = data.scaling;
  if (data.weights.size() != kernels::ParameterCount(ShapeOf(design)))
    in.Refuse(fmt::format("holds {} weights; a {} network has {}", data.weights.size(), design.name,
                          kernels::ParameterCount(ShapeOf(design))));
  if (scaling.input_mean.size() != inputs || scaling.input_sd.size() != inputs)
    in.Refuse(fmt::format("holds scales of {} inputs; a {} network has {}", scaling.input_mean.size(),
                          design.name, inputs));
  if (!AllFinite(data.weights)) in.Refuse("holds a weight that is not finite");
  const bool usable =
      AllFinite(scaling.input_mean) && AllFinite(scaling.input_sd) && std::isfinite(scaling.target_mean) &&
      std::isfinite(scaling.target_sd) && scaling.target_sd > 0.0 &&
      std::all_of(scaling.input_sd.begin(), scaling.input_sd.end(), [](double sd) { return sd >= 0.0; });
  if (!usable) in.Refuse("holds a scale that cannot be used");
}

std::string Payload(const Model& model) {
  ByteWriter out;
  out.Text(DesignText(model.design()));
  out.Text(model.data().key);
  out.U64(model.data().provenance.size());
  for (const auto& [key, value] : model.data().provenance) {
    out.Text(key);
    out.Text(value);
  }
  PutScaling(model.data().scaling, out);
  PutReport(model.data().report, out);
  out.F32s(model.data().weights);
  return out.bytes();
}

Model ModelOf(std::string_view payload, const std::string& path, const NetworkDesign& design,
              const std::optional<std::string>& key) {
  ByteReader in(payload, path, kFormat);
  const std::string found = in.Text();
  if (const std::string wanted = DesignText(design); found != wanted)
    in.Refuse(fmt::format("holds another network: {}; wanted: {}", found, wanted));
  ModelData data;
  data.key = in.Text();
  if (key && data.key != *key)
    in.Refuse(
        fmt::format("holds the network of another training ({:.16}; wanted: {:.16}); delete it to train anew",
                    data.key, *key));
  for (std::uint64_t left = in.U64(); left > 0; --left) {
    std::string key = in.Text();
    data.provenance.emplace_back(std::move(key), in.Text());
  }
  data.scaling = TakeScaling(in);
  data.report = TakeReport(in);
  data.weights = in.F32s();
  in.End();
  CheckUsable(data, design, in);
  return Model(design, std::move(data));
}

}  // namespace

std::string ModelBytes(const Model& model) { return Sealed(kFormat, Payload(model)); }

void WriteModel(const std::string& path, const Model& model) {
  WriteSealedFile(path, kFormat, Payload(model));
}

Model ReadModel(const std::string& path, const NetworkDesign& design, const std::optional<std::string>& key) {
  return ModelOf(ReadSealedFile(path, kFormat), path, design, key);
}

Model OpenModel(std::string_view bytes, const std::string& name, const NetworkDesign& design) {
  return ModelOf(OpenSealed(bytes, name, kFormat), name, design, std::nullopt);
}

std::string NetworkHash(const Model& model) {
  ByteWriter out;
  out.Text(DesignText(model.design()));
  PutScaling(model.data().scaling, out);
  out.F32s(model.data().weights);
  Sha256 sha;
  sha.Update(out.bytes());
  return sha.Hex();
}

}  // namespace ed3r::rfnn
