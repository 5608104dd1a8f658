// The shapes of the values of an ONNX model, step by step, as the standard has them, and what they must be for OpenCV 4.6 to
// read the steps so.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine/perception/vision/onnx/node.h"

namespace ed3r::perception {

using OnnxSides = std::vector<std::int64_t>;

class OnnxShapes {
 public:
  // `input` is the frame's value; `name` stands in messages and must outlive this, as `around`.
  OnnxShapes(const OnnxSurroundings& around, const std::string& input, const OnnxSides& sides,
             const std::string& name)
      : around_(around), name_(name) {
    sides_[input] = sides;
  }

  // Steps come in the order in which they run. Throws UserError for forms that are not in the table of forms.h, and
  // for shapes with which OpenCV reads them otherwise than the standard.
  void Add(const OnnxNode& node);

  // Of what is computed, else empty.
  OnnxSides Of(const std::string& value) const;

 private:
  void FollowFloats(const OnnxNode& node);

  const OnnxSurroundings& around_;
  const std::string& name_;
  std::map<std::string, OnnxSides> sides_;                  // of what is computed
  std::map<std::string, std::vector<std::int64_t>> whole_;  // what is made of shapes
  std::set<std::string> floats_;                            // of those
};

}  // namespace ed3r::perception
