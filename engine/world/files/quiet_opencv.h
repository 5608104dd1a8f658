// OpenCV without its own voice: what fails there is told by an exception, and told on in one line.
#pragma once

#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

namespace ed3r::world {

// For the whole process and for good; any number of calls, from any thread.
inline void QuietOpenCv() {
  static const bool once = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    cv::redirectError([](int, const char*, const char*, const char*, int, void*) { return 0; });
    return true;
  }();
  static_cast<void>(once);
}

}  // namespace ed3r::world
