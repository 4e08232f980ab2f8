#include "selovis/descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "descriptor_parts.hpp"
#include "hyselam_common/errors.hpp"
#include "selovis/color_classes.hpp"

namespace selovis {
namespace {

/// Terms joined by '+', one after the other in the vector.
class Joined : public Descriptor {
 public:
  explicit Joined(std::vector<DescriptorPtr> terms) : terms_(std::move(terms)) {
    for (const auto& term : terms_) size_ += term->size();
  }
  int size() const override { return size_; }
  void compute(const cv::Mat& image, const Readings& readings, float* out) override {
    for (const auto& term : terms_) {
      term->compute(image, readings, out);
      out += term->size();
    }
  }
  bool needsTraining() const override {
    return std::any_of(terms_.begin(), terms_.end(),
                       [](const DescriptorPtr& t) { return t->needsTraining(); });
  }
  void train(const std::vector<cv::Mat>& images, std::uint64_t seed) override {
    for (const auto& term : terms_) {
      if (term->needsTraining()) term->train(images, seed);
    }
  }
  std::vector<float> learnt() const override {
    for (const auto& term : terms_) {
      if (term->needsTraining()) return term->learnt();
    }
    return {};
  }
  void setLearnt(const std::vector<float>& values) override {
    for (const auto& term : terms_) {
      if (term->needsTraining()) term->setLearnt(values);
    }
  }

 private:
  std::vector<DescriptorPtr> terms_;
  int size_ = 0;
};

/// Greek psi as it is typed, and the text's short name, in one spelling.
std::string plainSpelling(std::string name) {
  const std::string psi = "\xCF\x88";
  for (std::size_t at; (at = name.find(psi)) != std::string::npos;) {
    name.replace(at, psi.size(), "psi");
  }
  if (name == "hLBP") name = "LBPbyHSV-U8N-IRIS";
  return name;
}

/// So weighted, squared distances (of square roots) between two images are as large in GIST as in
/// LGOP.
constexpr float kGistWeight = 0.09f;

DescriptorPtr makeTerm(const std::string& name, const DescriptorParams& params) {
  if (name == "GLANCE") {
    std::vector<DescriptorPtr> terms;
    terms.push_back(makeGradientPyramid("LGOP"));
    terms.push_back(makeHuelessGist(kGistWeight));
    return std::make_unique<Joined>(std::move(terms));
  }
  if (auto d = makeLbpByHsv(name, params)) return d;
  if (auto d = makeDepthLbp(name, params)) return d;
  if (auto d = makeLbpBaseline(name, params)) return d;
  if (auto d = makeGist(name)) return d;
  if (auto d = makeBagOfFeatures(name)) return d;
  if (auto d = makeGradientPyramid(name)) return d;
  return makeReadingsTerm(name, params);
}

}  // namespace

int numberAfter(const std::string& text, const std::string& prefix, int low, int high) {
  if (text.size() <= prefix.size() || text.compare(0, prefix.size(), prefix) != 0) return -1;
  const std::string digits = text.substr(prefix.size());
  if (digits.size() > 6 || digits.find_first_not_of("0123456789") != std::string::npos) return -1;
  const int value = std::stoi(digits);
  if (value < low || value > high) {
    throw std::invalid_argument("descriptor '" + text + "': the number must be " +
                                std::to_string(low) + " to " + std::to_string(high));
  }
  return value;
}

const cv::Mat& greyOf(const cv::Mat& image, const char* who, cv::Mat& buffer) {
  if (image.empty()) throw std::invalid_argument(std::string(who) + ": the image is empty");
  if (image.type() == CV_8UC1) return image;
  if (image.type() != CV_8UC3) {
    throw std::invalid_argument(std::string(who) + " needs an 8-bit image of 1 or 3 channels");
  }
  cv::cvtColor(image, buffer, cv::COLOR_BGR2GRAY);
  return buffer;
}

void validate(const DescriptorParams& p) {
  validate(p.lbp);
  validate(ColorParams{8, p.value_min, p.saturation_min});
  const auto positive = [](const char* name, double value) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw hyselam::ParameterError(name, value, "above 0");
    }
  };
  positive("near_range", p.near_range);
  positive("range_max", p.range_max);
  if (!(p.middle_range >= p.near_range) || !std::isfinite(p.middle_range)) {
    throw hyselam::ParameterError("middle_range", p.middle_range, "at least near_range");
  }
  const auto weight = [](const char* name, double value) {
    if (!(value >= 0.0 && value <= 1000.0)) {
      throw hyselam::ParameterError(name, value, "0 to 1000");
    }
  };
  weight("heading_weight", p.heading_weight);
  weight("range_weight", p.range_weight);
  if (p.threads < 1 || p.threads > 64) {
    throw hyselam::ParameterError("threads", p.threads, "1 to 64");
  }
}

std::unique_ptr<Descriptor> makeDescriptor(const std::string& name,
                                           const DescriptorParams& params) {
  validate(params);
  std::vector<DescriptorPtr> terms;
  int trained = 0;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('+', begin), name.size());
    const std::string term = plainSpelling(name.substr(begin, end - begin));
    DescriptorPtr made = makeTerm(term, params);
    if (!made) {
      throw std::invalid_argument("no descriptor is called '" + term + "'" +
                                  (term == name ? "" : " (in '" + name + "')"));
    }
    trained += made->needsTraining();
    terms.push_back(std::move(made));
    begin = end + 1;
  }
  if (trained > 1) {
    throw std::invalid_argument("descriptor '" + name + "': only one term may have a dictionary");
  }
  if (terms.size() == 1) return std::move(terms.front());
  return std::make_unique<Joined>(std::move(terms));
}

ReadingNeeds needsOf(const std::string& descriptor) {
  ReadingNeeds needs;
  for (std::size_t begin = 0; begin <= descriptor.size();) {
    const std::size_t end = std::min(descriptor.find('+', begin), descriptor.size());
    const std::string term = plainSpelling(descriptor.substr(begin, end - begin));
    needs.scan |= term == "scan";
    needs.heading |= term == "psi";
    needs.magnetic |= term == "[psi]";
    needs.ranges |= term.compare(0, 4, "sLBP") == 0 ||
                    (term.size() > 1 && term[0] == 'A' && term[1] >= '0' && term[1] <= '9');
    begin = end + 1;
  }
  return needs;
}

std::vector<std::string> descriptorNames() {
  std::vector<std::string> names;
  for (const char* base :
       {"LBPbyHSV-U8N", "LBPbyHSV-U8U", "LBPbyHSV-U8S", "LBPbyHSV-U16N", "LBPbyHSV-U16S"}) {
    for (const char* part : {"", "-D", "-IRIS", "-IRIS-VP"})
      names.push_back(std::string(base) + part);
  }
  for (const char* more :
       {"hLBP",        "sLBP-(N)LRF20", "sLBP-(A)LRF20", "sLBP-(S)LRF20", "LBP8,1",
        "LBP8,3",      "LBP8,3-u",      "CENTRIST",      "HSV-LBP",       "HSV-LBP-u",
        "SLBP",        "HSV-GIST",      "HSV-GIST64",    "HSV-GIST128",   "BOF-SIFT200",
        "BOF-SIFT500", "BOF-ORB500",    "BOF-ORB500-D",  "LGOP",          "LGOP+scan"}) {
    names.push_back(more);
  }
  return names;
}

}  // namespace selovis
