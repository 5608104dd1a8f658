// Steps of ONNX models that OpenCV 4.6 reads as the standard says for some shapes only, which it alone knows once the
// model is loaded. Mended() names what they take; here the shapes of what bears such a name are looked at.
#pragma once

#include <opencv2/dnn.hpp>
#include <opencv2/dnn/shape_utils.hpp>
#include <string>

namespace ed3r::perception {

// `input`: the frame's shape. `name` begins messages. Throws UserError.
void CheckShapes(const cv::dnn::Net& network, const cv::dnn::MatShape& input, const std::string& name);

}  // namespace ed3r::perception
