#include "engine/rfnn/model_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "engine/core/check.h"
#include "engine/core/files/sealed_file.h"
#include "engine/core/sha256.h"
#include "tests/rfnn/toys.h"

namespace ed3r::rfnn {
namespace {

using ::ed3r::testing::kTiny;
using ::ed3r::testing::kToy;
using ::ed3r::testing::MessageOf;
using ::ed3r::testing::RandomModel;
using ::ed3r::testing::ReadBytes;
using ::ed3r::testing::TemporaryFolder;
using ::ed3r::testing::WriteBytes;

constexpr std::size_t kVersionAt = 8, kPayloadAt = 20, kDigestBytes = 64;

ModelData Complete(const NetworkDesign& design) {
  ModelData data = testing::RandomModel(design, 31);
  data.provenance = {{"seed", "3"}, {"note", "a = b"}, {"empty", ""}};
  data.report.curve = {{1.0, 0.9}, {0.8, 0.85}, {0.7, 0.86}};
  data.report.best_epoch = 2;
  data.report.stopped_early = true;
  data.report.test = {.rows = 50, .missions = 3, .mse = 0.25, .r2 = 0.75, .mae = 0.5, .rmse = 0.6};
  return data;
}

// What reading says; "" when the file is taken. A refusal is one line and starts with the path.
std::string Refusal(const std::string& path, const NetworkDesign& design = testing::kTiny) {
  const std::string message = testing::MessageOf<UserError>([&] { ReadModel(path, design); });
  if (!message.empty()) {
    EXPECT_TRUE(message.starts_with(path + ": ")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  return message;
}

class ModelFileTest : public ::testing::Test {
 protected:
  ModelFileTest() : path_(folder_.File("net.rfnn")) {
    WriteModel(path_, Model(testing::kTiny, Complete(testing::kTiny)));
    bytes_ = testing::ReadBytes(path_);
  }

  // The same file with another payload and the checksum that belongs to it.
  std::string Resealed(std::string_view payload) const {
    std::string bytes = bytes_.substr(0, kPayloadAt - 8);
    for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<char>(payload.size() >> (8 * i) & 0xff));
    bytes += payload;
    Sha256 hash;
    hash.Update(bytes);
    return bytes + hash.Hex();
  }
  std::string Payload() const { return bytes_.substr(kPayloadAt, bytes_.size() - kPayloadAt - kDigestBytes); }

  testing::TemporaryFolder folder_;
  std::string path_, bytes_;
};

TEST_F(ModelFileTest, ReadsBackEveryBit) {
  const Model model = ReadModel(path_, testing::kTiny);
  const ModelData expected = Complete(testing::kTiny);
  EXPECT_EQ(model.data().weights, expected.weights);
  EXPECT_EQ(model.data().scaling.input_mean, expected.scaling.input_mean);
  EXPECT_EQ(model.data().scaling.input_sd, expected.scaling.input_sd);
  EXPECT_EQ(model.data().scaling.target_mean, expected.scaling.target_mean);
  EXPECT_EQ(model.data().scaling.target_sd, expected.scaling.target_sd);
  EXPECT_EQ(model.data().provenance, expected.provenance);
  ASSERT_EQ(model.data().report.curve.size(), 3u);
  EXPECT_EQ(model.data().report.curve[2].validation, 0.86);
  EXPECT_EQ(model.data().report.best_epoch, 2);
  EXPECT_TRUE(model.data().report.stopped_early);
  EXPECT_EQ(model.data().report.test.missions, 3);
  EXPECT_EQ(model.data().report.test.rmse, 0.6);
  const std::string again = folder_.File("again.rfnn");
  WriteModel(again, model);
  EXPECT_EQ(testing::ReadBytes(again), bytes_);
}

TEST_F(ModelFileTest, OneFlippedBitAnywhereIsRefused) {
  for (std::size_t at = 0; at < bytes_.size(); ++at) {
    std::string damaged = bytes_;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
    testing::WriteBytes(path_, damaged);
    ASSERT_NE(Refusal(path_), "") << "byte " << at;
  }
}

TEST_F(ModelFileTest, EveryTruncationIsRefused) {
  for (std::size_t size = 0; size < bytes_.size(); ++size) {
    testing::WriteBytes(path_, bytes_.substr(0, size));
    ASSERT_NE(Refusal(path_), "") << size << " bytes";
  }
  testing::WriteBytes(path_, bytes_ + "x");
  EXPECT_NE(Refusal(path_), "");
}

// Files whose checksum holds but whose content does not: the reader must stay within its bounds.
TEST_F(ModelFileTest, ContentWithAValidChecksumIsStillChecked) {
  const std::string payload = Payload();
  for (std::size_t size = 0; size < payload.size(); ++size) {
    testing::WriteBytes(path_, Resealed(payload.substr(0, size)));
    ASSERT_NE(Refusal(path_), "") << size << " bytes";
  }
  testing::WriteBytes(path_, Resealed(payload + "x"));
  EXPECT_EQ(Refusal(path_), path_ + ": this model file is damaged: it holds more than it should");
  for (std::size_t at = 0; at < payload.size(); ++at) {
    std::string other = payload;
    other[at] = static_cast<char>(~other[at]);
    testing::WriteBytes(path_, Resealed(other));
    try {
      const Model model = ReadModel(path_, testing::kTiny);
      for (const float weight : model.data().weights) ASSERT_TRUE(std::isfinite(weight)) << "byte " << at;
    } catch (const UserError&) {
    }
  }
}

TEST_F(ModelFileTest, MessagesSayWhatIsWrong) {
  std::string other = bytes_;
  other[kVersionAt] = 9;
  testing::WriteBytes(path_, other);
  EXPECT_EQ(Refusal(path_), path_ + ": this model file has format version 9; this program reads version 2");
  testing::WriteBytes(path_, "epoch,loss\n1,2\n");
  EXPECT_EQ(Refusal(path_), path_ + ": is not a model file");
  other = bytes_;
  other[bytes_.size() - kDigestBytes - 1] ^= 1;
  testing::WriteBytes(path_, other);
  EXPECT_EQ(Refusal(path_), path_ + ": this model file is damaged: its SHA-256 does not match its content");
  EXPECT_EQ(Refusal(folder_.File("none.rfnn")),
            folder_.File("none.rfnn") + ": cannot read this model file: No such file or directory");
  EXPECT_EQ(Refusal(folder_.File("")), folder_.File("") + ": cannot read this model file: Is a directory");
}

TEST_F(ModelFileTest, AnotherNetworkIsRefused) {
  EXPECT_EQ(
      Refusal(path_, testing::kToy),
      path_ +
          ": this model file holds another network: tiny network, 1 of 2 inputs are state (a u), hidden "
          "layers 2; wanted: toy network, 3 of 4 inputs are state (a b c u), hidden layers 24 x 16");
  const int wider[] = {3};
  NetworkDesign same_but_wider = testing::kTiny;
  same_but_wider.hidden = wider;
  EXPECT_NE(Refusal(path_, same_but_wider), "");
  NetworkDesign other_state = testing::kTiny;
  other_state.states = 0;
  EXPECT_NE(Refusal(path_, other_state), "");
}

TEST_F(ModelFileTest, WeightsAndScalesMustBeUsable) {
  for (const auto& spoil : std::vector<std::function<void(ModelData&)>>{
           [](ModelData& d) { d.weights[3] = std::numeric_limits<float>::quiet_NaN(); },
           [](ModelData& d) { d.weights[0] = std::numeric_limits<float>::infinity(); },
           [](ModelData& d) { d.scaling.input_sd[1] = -1.0; },
           [](ModelData& d) { d.scaling.input_mean[0] = std::numeric_limits<double>::infinity(); }}) {
    ModelData data = Complete(testing::kTiny);
    spoil(data);
    WriteModel(path_, Model(testing::kTiny, std::move(data)));
    EXPECT_NE(Refusal(path_), "");
  }
}

TEST_F(ModelFileTest, WritingReplacesAndLeavesNothingElseBehind) {
  WriteModel(path_, Model(testing::kTiny, testing::RandomModel(testing::kTiny, 77)));
  EXPECT_EQ(ReadModel(path_, testing::kTiny).data().weights,
            testing::RandomModel(testing::kTiny, 77).weights);
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_.File(""))) ++files;
  EXPECT_EQ(files, 1);
}

TEST_F(ModelFileTest, AFolderThatIsNotThereIsAUserError) {
  const std::string nowhere = folder_.File("no/such/folder/net.rfnn");
  EXPECT_EQ(testing::MessageOf<UserError>(
                [&] { WriteModel(nowhere, Model(testing::kTiny, testing::RandomModel(testing::kTiny, 1))); }),
            nowhere + ": cannot be written: No such file or directory");
}

TEST(SealedFileTest, NumbersAreLittleEndian) {
  ByteWriter out;
  out.U32(0x01020304);
  out.F64(1.0);
  const float one[] = {1.0f};
  out.F32s(one);
  EXPECT_EQ(out.bytes(),
            std::string("\x04\x03\x02\x01\0\0\0\0\0\0\xf0\x3f\x01\0\0\0\0\0\0\0\0\0\x80\x3f", 24));
}

TEST_F(ModelFileTest, BytesAreTheFileAndTheHashIsOfWhatIsComputed) {
  ModelData data = Complete(testing::kTiny);
  data.key = "of a training";
  const Model model(testing::kTiny, data);
  WriteModel(path_, model);
  EXPECT_EQ(ModelBytes(model), testing::ReadBytes(path_));
  const Model opened = OpenModel(ModelBytes(model), "kept", testing::kTiny);
  EXPECT_EQ(opened.data().weights, data.weights);
  EXPECT_EQ(opened.data().key, "of a training");
  EXPECT_EQ(ReadModel(path_, testing::kTiny, "of a training").data().weights, data.weights);
  EXPECT_EQ(
      testing::MessageOf<UserError>([&] { ReadModel(path_, testing::kTiny, "of another training"); }),
      path_ +
          ": this model file holds the network of another training (of a training; wanted: of another train"
          "); delete it to train anew");
  EXPECT_EQ(testing::MessageOf<UserError>([&] { OpenModel("x", "kept", testing::kTiny); }),
            "kept: is not a model file");

  const std::string hash = NetworkHash(model);
  EXPECT_EQ(NetworkHash(opened), hash);
  data.key = "of another training";
  data.provenance.clear();
  EXPECT_EQ(NetworkHash(Model(testing::kTiny, data)), hash);
  data.weights[1] += 1.0f;
  EXPECT_NE(NetworkHash(Model(testing::kTiny, data)), hash);
  data.weights[1] = model.data().weights[1];
  data.scaling.target_mean += 1.0;
  EXPECT_NE(NetworkHash(Model(testing::kTiny, data)), hash);
}

}  // namespace
}  // namespace ed3r::rfnn
