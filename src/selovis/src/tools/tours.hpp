// What train and evaluate share.
#pragma once

#include <string>
#include <vector>

#include "selovis/learning/labeled_frames.hpp"
#include "selovis/learning/place_model.hpp"

namespace selovis {

/// Lists of frames and how to load one; errors name the image, or the list and line.
class Tours {
 public:
  explicit Tours(const std::vector<std::string>& lists);
  std::vector<std::size_t> sizes() const;
  const LabeledFrame& frame(std::size_t tour, std::size_t i) const { return tours_[tour][i]; }
  TrainingFrame load(std::size_t tour, std::size_t i) const;

 private:
  std::vector<std::vector<LabeledFrame>> tours_;
};

/// Numbers separated by commas; throws hyselam::InputError naming the option.
std::vector<double> numbersOf(const std::string& text, const std::string& option);

}  // namespace selovis
