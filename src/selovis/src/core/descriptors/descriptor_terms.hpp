// The terms that makeDescriptor() joins. Each maker returns null if the name is none of its own,
// and throws hyselam::InputError if it is one with a mistake.
#pragma once

#include <memory>
#include <string>

#include "selovis/descriptors/descriptor.hpp"

namespace selovis {

using DescriptorPtr = std::unique_ptr<Descriptor>;

DescriptorPtr makeLbpByHsv(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeDepthLbp(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeLbpBaseline(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeGist(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeBagOfFeatures(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeGradientPyramid(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeColorLayout(const std::string& name, const DescriptorParams& params);
DescriptorPtr makeSensorReadingsTerm(const std::string& name, const DescriptorParams& params);

/// SV-GIST with all values multiplied by `weight`.
DescriptorPtr makeSaturationValueGist(float weight);

/// The number in low .. high that follows `prefix` in `text`; -1 if the text does not start with
/// the prefix or no number follows. @throws hyselam::InputError if it is out of range.
int numberAfter(const std::string& text, const std::string& prefix, int low, int high);

/// Mean of the finite ranges in each of `n` equal groups; infinity where there is none.
void meanRanges(const std::vector<float>& ranges, int n, std::vector<float>& means);

/// 8-bit gray of an 8-bit image of 1 or 3 channels; `buffer` holds it where it is not the image.
/// @throws hyselam::InputError that begins with the name of the descriptor.
const cv::Mat& grayOf(const cv::Mat& image, const char* descriptor, cv::Mat& buffer);

}  // namespace selovis
