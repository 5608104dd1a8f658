// Small networks, data sets with a known answer, and a folder that goes away.
#pragma once

#include <stdlib.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "engine/core/random.h"
#include "engine/rfnn/data_set.h"
#include "engine/rfnn/model.h"

namespace ed3r::testing {

inline constexpr std::array<std::string_view, 4> kToyFeatures = {"a", "b", "c", "u"};
inline constexpr std::array kToyHidden = {24, 16};
inline constexpr rfnn::NetworkDesign kToy = {"toy", kToyFeatures, 3, kToyHidden};

inline constexpr std::array<std::string_view, 2> kTinyFeatures = {"a", "u"};
inline constexpr std::array kTinyHidden = {2};
inline constexpr rfnn::NetworkDesign kTiny = {"tiny", kTinyFeatures, 1, kTinyHidden};

// Rows of kToy in units far from standard; reward = 3 + 2 f + noise_sd N(0, 1).
inline rfnn::DataSet ToyData(int missions, int rows_each, double noise_sd, double signal = 1.0) {
  rfnn::DataSet data(4);
  Stream stream(99, 0, Purpose::kScenario);
  for (int m = 0; m < missions; ++m) {
    for (int i = 0; i < rows_each; ++i) {
      const double a = stream.Uniform(-1, 1), b = stream.Uniform(-1, 1), c = stream.Uniform(-1, 1),
                   u = stream.Uniform(-1, 1);
      const double f = std::sin(2.0 * a) + b * c - 0.5 * u;
      const float row[] = {static_cast<float>(22.5e6 + 4e6 * a), static_cast<float>(500.0 * b),
                           static_cast<float>(0.01 * c), static_cast<float>(u)};
      data.Add(row, static_cast<float>(3.0 + 2.0 * signal * f + noise_sd * stream.Normal()), 10 * m + 7);
    }
  }
  return data;
}

// A network of random weights and scales.
inline rfnn::ModelData RandomModel(const rfnn::NetworkDesign& design, std::uint64_t seed) {
  Stream stream(seed, 0, Purpose::kTraining);
  rfnn::ModelData data;
  const std::size_t parameters = kernels::ParameterCount(rfnn::ShapeOf(design));
  for (std::size_t i = 0; i < parameters; ++i)
    data.weights.push_back(static_cast<float>(0.4 * stream.Normal()));
  for (int i = 0; i < design.inputs(); ++i) {
    data.scaling.input_mean.push_back(stream.Uniform(-5, 5));
    data.scaling.input_sd.push_back(stream.Uniform(0.5, 4));
  }
  data.scaling.target_mean = -1.5;
  data.scaling.target_sd = 0.75;
  return data;
}

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "ed3r-rfnn-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::string File(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string ReadBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

inline void WriteBytes(const std::string& path, std::string_view bytes) {
  std::filesystem::remove(path);  // some file systems flush to disk when a file is overwritten
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// what() of the Error that `action` throws; "" when it throws none.
template <class Error, class Action>
std::string MessageOf(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace ed3r::testing
