// The makers behind makeDescriptor(); each returns null if the name is none of its own.
#pragma once

#include <memory>
#include <string>

#include "selovis/descriptor.hpp"

namespace selovis {

using DescriptorPtr = std::unique_ptr<Descriptor>;

DescriptorPtr makeLbpByHsv(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeDepthLbp(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeLbpBaseline(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeGist(const std::string& name);
/// SV-GIST with all values multiplied by `weight`.
DescriptorPtr makeHuelessGist(float weight);
DescriptorPtr makeBagOfFeatures(const std::string& name);
DescriptorPtr makeGradientPyramid(const std::string& name);
DescriptorPtr makeReadingsTerm(const std::string& name, const DescriptorParams& params);

/// `text` after `prefix` as a number in low .. high; -1 if the text does not start with the prefix
/// or is no number; throws std::invalid_argument if the number is out of range.
int numberAfter(const std::string& text, const std::string& prefix, int low, int high);

/// 8-bit grey of an 8-bit image of 1 or 3 channels; `buffer` holds the result if it must be made.
const cv::Mat& greyOf(const cv::Mat& image, const char* who, cv::Mat& buffer);

}  // namespace selovis
