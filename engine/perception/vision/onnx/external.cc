#include "engine/perception/vision/onnx/external.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/protobuf.h"
#include "engine/perception/vision/onnx/fields.h"

namespace ed3r::perception {
namespace {

namespace fs = std::filesystem;

// Where a tensor's values lie.
struct Place {
  std::string file;
  std::uint64_t offset = 0;
  std::optional<std::uint64_t> length;  // to the file's end where it is not told
};

// Copies the model's messages, with the tensors' values put in.
class Inliner {
 public:
  Inliner(const std::string& path, const std::string& name)
      : folder_(fs::path(path).parent_path()), name_(name) {}

  std::string Model(std::string_view bytes) {
    return Copied(bytes, [&](const ProtobufField& field, ProtobufWriter& out) {
      if (field.number != onnx::kGraph || !field.IsBytes()) return false;
      out.Bytes(field.number, Graph(field.bytes, 0));
      return true;
    });
  }

  bool found() const { return found_; }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }

  // The message with those fields changed that `change` has written itself.
  template <class Change>
  std::string Copied(std::string_view bytes, Change change) const {
    ProtobufWriter out;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (!change(field, out)) out.Copy(field);
    });
    return out.bytes();
  }

  std::string Graph(std::string_view bytes, int depth) {
    if (depth > onnx::kMaxDepth) Refuse("has graphs within graphs without end");
    return Copied(bytes, [&](const ProtobufField& field, ProtobufWriter& out) {
      if (!field.IsBytes() || (field.number != onnx::kNode && field.number != onnx::kInitializer))
        return false;
      out.Bytes(field.number, field.number == onnx::kNode ? Node(field.bytes, depth) : Tensor(field.bytes));
      return true;
    });
  }

  std::string Node(std::string_view bytes, int depth) {
    return Copied(bytes, [&](const ProtobufField& field, ProtobufWriter& out) {
      if (!field.IsBytes() || field.number != onnx::kNodeAttribute) return false;
      out.Bytes(field.number, Attribute(field.bytes, depth));
      return true;
    });
  }

  std::string Attribute(std::string_view bytes, int depth) {
    return Copied(bytes, [&](const ProtobufField& field, ProtobufWriter& out) {
      if (!field.IsBytes()) return false;
      const bool tensor = field.number == onnx::kAttributeTensor || field.number == onnx::kAttributeTensors;
      const bool graph = field.number == onnx::kAttributeGraph || field.number == onnx::kAttributeGraphs;
      if (tensor) out.Bytes(field.number, Tensor(field.bytes));
      if (graph) out.Bytes(field.number, Graph(field.bytes, depth + 1));
      return tensor || graph;
    });
  }

  std::string Tensor(std::string_view bytes) {
    bool outside = false;
    Place place;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kLocation) outside = field.value == onnx::kLiesOutside;
      if (field.number == onnx::kExternal && field.IsBytes()) ReadPair(field.bytes, place);
    });
    if (!outside) return std::string(bytes);
    found_ = true;
    const std::string_view values = Values(place);
    total_ += values.size();
    if (total_ > kMaxModelBytes)
      Refuse(fmt::format("has more than {} bytes of weights in other files", kMaxModelBytes));
    std::string inside = Copied(bytes, [](const ProtobufField& field, ProtobufWriter&) {
      return field.number == onnx::kLocation || field.number == onnx::kExternal;
    });
    return inside + ProtobufWriter().Bytes(onnx::kRaw, values).bytes();
  }

  void ReadPair(std::string_view bytes, Place& place) const {
    std::string key, value;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kPairKey && field.IsBytes()) key = field.bytes;
      if (field.number == onnx::kPairValue && field.IsBytes()) value = field.bytes;
    });
    if (key == "location") place.file = value;
    if (key == "offset") place.offset = Number(key, value);
    if (key == "length") place.length = Number(key, value);
  }

  std::uint64_t Number(const std::string& key, const std::string& text) const {
    std::uint64_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc() || stop != end)
      Refuse(fmt::format("has the {} '{}' of weights in another file; allowed: a whole number", key, text));
    return number;
  }

  std::string_view Values(const Place& place) {
    const std::string& file = Content(place.file);
    const std::uint64_t size = file.size();
    if (place.offset > size || place.length.value_or(0) > size - place.offset)
      Refuse(fmt::format("takes {} bytes from {} on of '{}', which has {}: is that file cut short?",
                         place.length.value_or(0), place.offset, place.file, size));
    return std::string_view(file).substr(place.offset, place.length.value_or(size - place.offset));
  }

  const std::string& Content(const std::string& file) {
    const auto known = files_.find(file);
    if (known != files_.end()) return known->second;
    const fs::path relative = fs::path(file).lexically_normal();
    if (file.empty() || relative.is_absolute() || *relative.begin() == "..")
      Refuse(fmt::format("keeps weights in '{}'; allowed: a file in the model's folder", file));
    std::string content, why;
    if (!TryReadFile((folder_ / relative).string(), kMaxModelBytes, content, why))
      Refuse(fmt::format("keeps weights in '{}', which cannot be read: {}; it belongs beside the model", file,
                         why));
    return files_[file] = std::move(content);
  }

  fs::path folder_;
  const std::string& name_;
  std::map<std::string, std::string> files_;
  std::uint64_t total_ = 0;
  bool found_ = false;
};

}  // namespace

std::string WithWeightsInside(std::string bytes, const std::string& path, const std::string& name) {
  Inliner inliner(path, name);
  std::string inside = inliner.Model(bytes);
  return inliner.found() ? inside : bytes;
}

}  // namespace ed3r::perception
