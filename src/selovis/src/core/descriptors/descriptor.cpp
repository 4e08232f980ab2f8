#include "selovis/descriptors/descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "../classifiers/exemplar_classifier.hpp"
#include "descriptor_terms.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/require.hpp"
#include "learnt_projection.hpp"
#include "selovis/descriptors/color_classes.hpp"

namespace selovis {

using hyselam::InputError;

const char* const kFusionTerms = "LGOP+HSV-GIST+LBPbyHSV-U8N+SLBP+HSV-HIST+LOGCHROMA+RANKS";

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Terms joined by '+', one after the other in the vector.
class JoinedDescriptor : public Descriptor {
 public:
  JoinedDescriptor(std::vector<DescriptorPtr> terms, std::vector<std::string> names)
      : terms_(std::move(terms)), names_(std::move(names)) {
    for (const auto& term : terms_) size_ += term->size();
  }
  std::vector<SignaturePart> parts() const override {
    std::vector<SignaturePart> all;
    for (std::size_t t = 0; t < terms_.size(); ++t) {
      for (SignaturePart& part : terms_[t]->parts()) {
        if (part.name.empty()) part.name = names_[t];
        all.push_back(std::move(part));
      }
    }
    return all;
  }
  int size() const override { return size_; }
  void compute(const cv::Mat& image, const SensorReadings& readings, float* out) override {
    for (const auto& term : terms_) {
      term->compute(image, readings, out);
      out += term->size();
    }
  }
  RequiredReadings requiredReadings() const override {
    RequiredReadings required;
    for (const auto& term : terms_) {
      const RequiredReadings r = term->requiredReadings();
      required.ranges |= r.ranges;
      required.scan |= r.scan;
      required.heading |= r.heading;
      required.magnetic |= r.magnetic;
    }
    return required;
  }
  bool needsDictionary() const override { return termWithDictionary() != nullptr; }
  void learnDictionary(const std::vector<cv::Mat>& images, std::uint64_t seed) override {
    if (Descriptor* term = termWithDictionary()) term->learnDictionary(images, seed);
  }
  std::vector<float> dictionary() const override {
    const Descriptor* term = termWithDictionary();
    return term == nullptr ? std::vector<float>{} : term->dictionary();
  }
  void setDictionary(const std::vector<float>& values) override {
    if (Descriptor* term = termWithDictionary()) term->setDictionary(values);
  }

 private:
  /// At most one term has a dictionary (makeDescriptor).
  Descriptor* termWithDictionary() const {
    for (const auto& term : terms_) {
      if (term->needsDictionary()) return term.get();
    }
    return nullptr;
  }

  std::vector<DescriptorPtr> terms_;
  std::vector<std::string> names_;
  int size_ = 0;
};

/// A descriptor of the image brought to at most kFusionWidth: the parts of FUSION need no more, and
/// with many of them each pixel costs.
constexpr int kFusionWidth = 320;

class SmallerImage : public Descriptor {
 public:
  explicit SmallerImage(DescriptorPtr of) : of_(std::move(of)) {}
  int size() const override { return of_->size(); }
  std::vector<SignaturePart> parts() const override { return of_->parts(); }
  void compute(const cv::Mat& image, const SensorReadings& readings, float* out) override {
    if (image.cols <= kFusionWidth) return of_->compute(image, readings, out);
    const int rows = std::max(1, image.rows * kFusionWidth / image.cols);
    cv::resize(image, small_, cv::Size(kFusionWidth, rows), 0.0, 0.0, cv::INTER_AREA);
    of_->compute(small_, readings, out);
  }

 private:
  DescriptorPtr of_;
  cv::Mat small_;
};

/// Greek psi spelled out, and hLBP by its long name.
std::string canonicalName(std::string name) {
  const std::string psi = "\xCF\x88";
  for (std::size_t at; (at = name.find(psi)) != std::string::npos;) {
    name.replace(at, psi.size(), "psi");
  }
  if (name == "hLBP") name = "LBPbyHSV-U8N-IRIS";
  return name;
}

/// With this weight squared distances between two images (of the square roots of their values) are
/// as large in GIST as in LGOP.
constexpr float kGistWeight = 0.09f;

DescriptorPtr makeGlance(const std::string& name, const DescriptorParams& params) {
  if (name != "GLANCE") return nullptr;
  std::vector<DescriptorPtr> terms;
  terms.push_back(makeGradientPyramid("LGOP", params));
  terms.push_back(makeSaturationValueGist(kGistWeight));
  return std::make_unique<JoinedDescriptor>(std::move(terms),
                                            std::vector<std::string>{"LGOP", "SV-GIST"});
}

/// A descriptor with one more part at its end, the projection of some of the others.
class WithLearntPart : public Descriptor {
 public:
  explicit WithLearntPart(DescriptorPtr of)
      : of_(std::move(of)), projection_(LearntProjection::shipped()) {
    for (const SignaturePart& input : projection_.inputs()) {
      int begin = 0;
      bool found = false;
      for (const SignaturePart& part : of_->parts()) {
        found = part.name == input.name && part.size == input.size && part.power == input.power;
        if (found) break;
        begin += part.size;
      }
      if (!found) {
        throw InputError("learnt projection", input.name, "is no part of the descriptor");
      }
      begins_.push_back(begin);
      inputs_.resize(inputs_.size() + static_cast<std::size_t>(input.size));
    }
  }
  int size() const override { return of_->size() + projection_.size(); }
  std::vector<SignaturePart> parts() const override {
    std::vector<SignaturePart> all = of_->parts();
    all.push_back({"LEARNT", projection_.size(), 1.0, false, true});
    return all;
  }
  void compute(const cv::Mat& image, const SensorReadings& readings, float* out) override {
    of_->compute(image, readings, out);
    float* to = inputs_.data();
    for (std::size_t i = 0; i < begins_.size(); ++i) {
      const SignaturePart& input = projection_.inputs()[i];
      normalizeSignature(out + begins_[i], static_cast<std::size_t>(input.size), input.power, 1.0,
                         to);
      to += input.size;
    }
    projection_.project(inputs_, out + of_->size());
  }

 private:
  DescriptorPtr of_;
  const LearntProjection& projection_;
  std::vector<int> begins_;
  std::vector<float> inputs_;
};

DescriptorPtr makeFusion(const std::string& name, const DescriptorParams& params) {
  if (name != "FUSION" && name != "FUSION-LEARNT") return nullptr;
  DescriptorPtr terms = makeDescriptor(kFusionTerms, params);
  if (name == "FUSION-LEARNT") terms = std::make_unique<WithLearntPart>(std::move(terms));
  return std::make_unique<SmallerImage>(std::move(terms));
}

/// Each maker returns null for names of other descriptors. A new descriptor is added here.
using TermMaker = DescriptorPtr (*)(const std::string&, const DescriptorParams&);
constexpr TermMaker kTermMakers[] = {
    makeLbpByHsv,      makeDepthLbp,        makeLbpBaseline,        makeGist,   makeGlance,
    makeBagOfFeatures, makeGradientPyramid, makeSensorReadingsTerm, makeFusion, makeColorLayout};

DescriptorPtr makeTerm(const std::string& name, const DescriptorParams& params) {
  for (const TermMaker make : kTermMakers) {
    if (DescriptorPtr descriptor = make(name, params)) return descriptor;
  }
  return nullptr;
}

}  // namespace

int numberAfter(const std::string& text, const std::string& prefix, int low, int high) {
  if (text.size() <= prefix.size() || text.compare(0, prefix.size(), prefix) != 0) return -1;
  const std::string digits = text.substr(prefix.size());
  if (digits.size() > 6 || digits.find_first_not_of("0123456789") != std::string::npos) return -1;
  const int value = std::stoi(digits);
  if (value < low || value > high) {
    throw InputError("descriptor '" + text + "'", "",
                     "the number must be " + std::to_string(low) + " to " + std::to_string(high));
  }
  return value;
}

const cv::Mat& grayOf(const cv::Mat& image, const char* descriptor, cv::Mat& buffer) {
  if (image.empty()) throw InputError(descriptor, "", "the image is empty");
  if (image.type() == CV_8UC1) return image;
  if (image.type() != CV_8UC3) {
    throw InputError(descriptor, "", "needs an 8-bit image of 1 or 3 channels");
  }
  cv::cvtColor(image, buffer, cv::COLOR_BGR2GRAY);
  return buffer;
}

void Descriptor::learnDictionary(const std::vector<cv::Mat>& /*images*/, std::uint64_t /*seed*/) {}

void Descriptor::setDictionary(const std::vector<float>& /*values*/) {}

void DescriptorParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.group("lbp_", lbp);
  visit("value_min", value_min, Range::between(0, 255), "", "delta_v of Eq. 6.13");
  visit("saturation_min", saturation_min, Range::between(0, 255), "", "delta_s of Eq. 6.13");
  visit("near_range", near_range, Range::inside(0.0, kInfinity), "m", "first section of sLBP");
  visit("middle_range", middle_range, Range::inside(0.0, kInfinity), "m", "second section of sLBP");
  visit("range_max", range_max, Range::inside(0.0, kInfinity), "m", "to which ranges are clipped");
  visit("heading_weight", heading_weight, Range::between(0.0, 1000.0), "", "of psi and [psi]");
  visit("range_weight", range_weight, Range::between(0.0, 1000.0), "", "of An and scan");
  visit("threads", threads, Range::between(1, 64), "", "of LBPbyHSV");
}

void DescriptorParams::validate() const {
  hyselam::checkParameters(*this);
  hyselam::require("middle_range", middle_range, middle_range >= near_range, "at least near_range");
}

std::unique_ptr<Descriptor> makeDescriptor(const std::string& name,
                                           const DescriptorParams& params) {
  params.validate();
  std::vector<DescriptorPtr> terms;
  std::vector<std::string> names;
  int dictionaries = 0;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('+', begin), name.size());
    const std::string term = canonicalName(name.substr(begin, end - begin));
    DescriptorPtr made = makeTerm(term, params);
    if (!made) {
      throw InputError("descriptor '" + name + "'", "",
                       term == name ? "is not known" : "there is no '" + term + "'");
    }
    dictionaries += made->needsDictionary();
    terms.push_back(std::move(made));
    names.push_back(term);
    begin = end + 1;
  }
  if (dictionaries > 1) {
    throw InputError("descriptor '" + name + "'", "", "only one term may have a dictionary");
  }
  const bool named = !terms.front()->parts().front().name.empty();
  if (terms.size() == 1 && named) return std::move(terms.front());
  return std::make_unique<JoinedDescriptor>(std::move(terms), std::move(names));
}

std::vector<std::string> descriptorNames() {
  std::vector<std::string> names;
  for (const char* base :
       {"LBPbyHSV-U8N", "LBPbyHSV-U8U", "LBPbyHSV-U8S", "LBPbyHSV-U16N", "LBPbyHSV-U16S"}) {
    for (const char* part : {"", "-D", "-IRIS", "-IRIS-VP"}) {
      names.push_back(std::string(base) + part);
    }
  }
  for (const char* more :
       {"hLBP",        "sLBP-(N)LRF20", "sLBP-(A)LRF20", "sLBP-(S)LRF20", "LBP8,1",
        "LBP8,3",      "LBP8,3-u",      "CENTRIST",      "HSV-LBP",       "HSV-LBP-u",
        "SLBP",        "HSV-GIST",      "HSV-GIST64",    "HSV-GIST128",   "BOF-SIFT200",
        "BOF-SIFT500", "BOF-ORB500",    "BOF-ORB500-D",  "LGOP",          "LGOP+scan",
        "GLANCE",      "GLANCE+scan",   "SV-GIST",       "HSV-HIST",      "LOGCHROMA",
        "RANKS",       "GRAY",          "FUSION",        "FUSION+scan",   "FUSION-LEARNT"}) {
    names.push_back(more);
  }
  return names;
}

}  // namespace selovis
