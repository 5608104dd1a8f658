#include "studies/detection/views.h"

#include <map>
#include <string>
#include <utility>

namespace ed3r::detection {

Views ViewsOf(std::span<const FrameLabel> labels, const std::vector<std::size_t>& chosen) {
  std::map<std::pair<std::string, int>, int> numbers;
  for (const std::size_t i : chosen) numbers.try_emplace({labels[i].world, labels[i].view});
  Views views;
  for (auto& [view, number] : numbers) number = views.count++;
  for (const std::size_t i : chosen) views.of_frame.push_back(numbers.at({labels[i].world, labels[i].view}));
  return views;
}

}  // namespace ed3r::detection
