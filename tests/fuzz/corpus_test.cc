// The corpora, and each file of them cut short and with bits turned over, through the functions that are fuzzed.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include "engine/core/files/file.h"
#include "tests/fuzz/targets.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, FuzzFunction> kTargets = {{"sweep", FuzzSweep},
                                                      {"world", FuzzWorld},
                                                      {"grid", FuzzGrid},
                                                      {"stem_map", FuzzStemMap},
                                                      {"log", FuzzLog},
                                                      {"log_format", FuzzLogFormat},
                                                      {"npy", FuzzNpy},
                                                      {"picture", FuzzPicture},
                                                      {"onnx", FuzzOnnx},
                                                      {"network", FuzzNetwork},
                                                      {"model", FuzzModel},
                                                      {"weights", FuzzWeights},
                                                      {"checkpoint", FuzzCheckpoint},
                                                      {"airframe", FuzzAirframe},
                                                      {"store", FuzzStore}};

TEST(CorpusTest, EveryFileIsReadOrRefused) {
  for (const auto& [name, target] : kTargets) {
    int files = 0;
    for (const auto& entry : fs::directory_iterator(fs::path(ED3R_SOURCE_DIR) / "tests/fuzz/corpus" / name)) {
      SCOPED_TRACE(entry.path().string());
      const std::string bytes = ReadFile(entry.path().string());
      target(bytes);
      for (std::size_t part = 0; part < 16; ++part)
        target(std::string_view(bytes).substr(0, bytes.size() * part / 16));
      const std::size_t step = std::max<std::size_t>(1, bytes.size() / 64);
      for (std::size_t at = 0; at < bytes.size(); at += step) {
        std::string turned = bytes;
        turned[at] = static_cast<char>(turned[at] ^ (1 << (at / step % 8)));
        target(turned);
      }
      ++files;
    }
    EXPECT_GT(files, 0) << name;
  }
}

}  // namespace
}  // namespace ed3r
