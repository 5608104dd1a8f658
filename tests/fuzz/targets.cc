#include "tests/fuzz/targets.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "engine/core/check.h"
#include "engine/core/files/sealed_file.h"
#include "engine/perception/vision/model_file.h"
#include "engine/perception/vision/onnx/external.h"
#include "engine/perception/vision/onnx/gate.h"
#include "engine/perception/vision/onnx/outline.h"
#include "engine/perception/vision/onnx/reading.h"
#include "engine/perception/vision/onnx/rewrite.h"
#include "engine/rfnn/checkpoint.h"
#include "engine/rfnn/model_file.h"
#include "engine/rfnn/onnx_graph.h"
#include "engine/store/digest.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/sqlite.h"
#include "engine/sweep/setting.h"
#include "engine/sweep/sweep_file.h"
#include "engine/world/files/jpeg_check.h"
#include "engine/world/files/picture_file.h"
#include "engine/world/files/png_pixels.h"
#include "engine/world/files/stem_map.h"
#include "engine/world/terrain.h"
#include "engine/world/world_file.h"
#include "studies/detection/npy.h"
#include "studies/fit/flight_log.h"
#include "studies/fit/log_format.h"
#include "studies/flight_logs/read_log.h"

namespace ed3r {
namespace {

class PrivateFolder {
 public:
  PrivateFolder() : path_((std::filesystem::temp_directory_path() / "ed3r_fuzz_XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) std::abort();
  }
  ~PrivateFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// A file of this process with these bytes, for readers that take a path.
class InputFile {
 public:
  InputFile(std::string_view bytes, const std::string& name) {
    static const PrivateFolder folder;
    path_ = folder.path() + "/" + name;
    const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0 || ::write(file, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      std::abort();
    ::close(file);
  }
  ~InputFile() { ::unlink(path_.c_str()); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

template <class Read>
void Refusable(Read read) {
  try {
    read();
  } catch (const UserError&) {
  } catch (const store::StoreError&) {  // SQLite takes a damaged length for want of memory
  }
}

}  // namespace

void FuzzSweep(std::string_view bytes) {
  const InputFile file(bytes, "x.yaml");
  Refusable([&] { sweep::LoadSweep(file.path()).CanonicalText(); });
}

void FuzzWorld(std::string_view bytes) {
  const InputFile file(bytes, "w.yaml");
  Refusable([&] { world::ReadWorldFile(file.path()); });
}

// As a text grid and as a GeoTIFF: the reader looks at the content.
void FuzzGrid(std::string_view bytes) {
  const InputFile file(bytes, "g.asc");
  world::GridTerrainSpec spec;
  spec.file = file.path();
  spec.extent_m = {100.0, 80.0};
  Refusable([&] { world::ReadElevationGrid(spec, {100.0, 80.0, 500.0}, 10.0); });
}

void FuzzStemMap(std::string_view bytes) {
  const InputFile file(bytes, "stems.csv");
  world::StemMapSpec spec;
  spec.file = file.path();
  spec.estimate_missing = world::ForestKind::kMixed;
  spec.tallest_of_a_spot = true;
  Refusable([&] { world::ReadStemMap(spec); });
}

void FuzzLog(std::string_view bytes) {
  for (const bool skip_bad : {false, true})
    Refusable([&] {
      std::vector<flight_logs::LogTable> tables;
      tables.push_back(
          flight_logs::ParseLog("log", std::string(bytes), {.skip_bad = skip_bad, .battery = 0}));
      const char* formats[] = {"ardupilot", "px4", "ardupilot", "dji"};
      fit::MakeFlightLog(tables, fit::LoadLogFormat(formats[static_cast<int>(tables.front().kind())]),
                         fit::LogUse::kFit, {.skip_bad = skip_bad, .battery = {}});
    });
}

void FuzzLogFormat(std::string_view bytes) {
  Refusable([&] { fit::ParseLogFormat("format.yaml", std::string(bytes)); });
}

void FuzzNpy(std::string_view bytes) {
  Refusable([&] { detection::NpyFrames(std::string(bytes), "frames.npy").Some(0, 1); });
}

void FuzzPicture(std::string_view bytes) {
  constexpr int kMostPixels = 1 << 20;  // of what is decoded
  Refusable([&] {
    const world::PictureSides sides = world::ReadPictureSides(bytes, "x.png");
    if (sides.width_px * sides.height_px > kMostPixels) return;
    bytes.front() == '\xff' ? void(world::CheckJpeg(bytes, "x.jpg")) : void(world::DecodePng(bytes, "x.png"));
  });
}

void FuzzOnnx(std::string_view bytes) {
  const std::string name = "x.onnx";
  Refusable([&] { perception::WithWeightsInside(std::string(bytes), "/nowhere/x.onnx", name); });
  Refusable([&] {
    perception::CheckOnnx(bytes, name);
    const perception::OnnxOutline outline = perception::OutlineOf(bytes, name);
    DetectorConfig config;
    config.input_width_px = config.input_height_px = 0;
    perception::ForOpenCv(bytes, outline, perception::ReadingOf(outline, config, name), name);
  });
}

void FuzzNetwork(std::string_view bytes) {
  Refusable([&] { rfnn::ParseOnnxGraph(bytes, "x.onnx"); });
}

void FuzzModel(std::string_view bytes) {
  Refusable([&] {
    perception::ParseDetectorModel(Sealed({"ED3RCNN\n", 1, "detector network"}, bytes), "x.ed3rnet");
  });
}

void FuzzWeights(std::string_view bytes) {
  static constexpr std::array<std::string_view, 2> kFeatures = {"x_m", "dx_m"};
  static constexpr std::array kHidden = {2};
  const rfnn::NetworkDesign design = {"small", kFeatures, 1, kHidden, 1};
  Refusable([&] {
    const rfnn::Model model = rfnn::OpenModel(Sealed({"ED3RRFNN", 2, "model file"}, bytes), "x.rfnn", design);
    rfnn::ModelBytes(model);
    rfnn::NetworkHash(model);
  });
}

void FuzzCheckpoint(std::string_view bytes) {
  const InputFile file(Sealed({"ED3RTRCP", 1, "training checkpoint"}, bytes), "x.checkpoint");
  Refusable([&] { rfnn::ReadCheckpoint(file.path(), "key", 3); });
}

void FuzzAirframe(std::string_view bytes) {
  const InputFile file(bytes, "airframe.yaml");
  Refusable([&] { sweep::ReadAirframeFile(file.path(), "x.yaml:1:1"); });
}

void FuzzStore(std::string_view bytes) {
  const InputFile file(bytes, store::kResultsFile);
  const std::string dir = std::filesystem::path(file.path()).parent_path();
  Refusable([&] {
    store::ResultReader reader(dir);
    Refusable([&] { reader.Status(); });
    Refusable([&] { reader.Networks(); });
    Refusable([&] { reader.Files(); });
    Refusable([&] { reader.Sessions(); });
    Refusable([&] { reader.FindDamage(); });
    Refusable([&] { store::DigestOf(reader); });
  });
  for (const char* beside : {"-wal", "-shm", "-journal"}) ::unlink((file.path() + beside).c_str());
}

}  // namespace ed3r
