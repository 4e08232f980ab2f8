// BOF: words of local features (6.3.2), learned by k-means on the training images.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "descriptor_terms.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr int kMaxLearnt = 40000;  // features that k-means sees

cv::Ptr<cv::Feature2D> makeDetector(bool sift, int features) {
  if (!sift) return cv::ORB::create(features);
#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 4)
  return cv::SIFT::create(features);
#else
  throw hyselam::InputError("BOF-SIFT", "", "needs OpenCV 4.4 or newer");
#endif
}

class BagOfFeatures : public Descriptor {
 public:
  BagOfFeatures(bool sift, int words, bool halves)
      : words_(words),
        halves_(halves),
        length_(sift ? 128 : 32),
        detector_(makeDetector(sift, 500)) {}

  int size() const override { return words_ * (halves_ ? 3 : 1); }
  bool needsDictionary() const override { return true; }

  void learnDictionary(const std::vector<cv::Mat>& images, std::uint64_t seed) override {
    cv::Mat all;
    const int per_image =
        std::max(20, kMaxLearnt / std::max<int>(1, static_cast<int>(images.size())));
    for (const cv::Mat& image : images) {
      detect(image);
      // Every so many, so that the whole image stays represented.
      const int step = std::max(1, features_.rows / per_image);
      for (int i = 0; i < features_.rows; i += step) all.push_back(features_.row(i));
    }
    if (all.rows < words_) {
      throw hyselam::InputError("BOF", "",
                                "the training images have " + std::to_string(all.rows) +
                                    " local features, too few for " + std::to_string(words_) +
                                    " words");
    }
    cv::theRNG().state = seed;
    cv::Mat labels;
    cv::kmeans(all, words_, labels, cv::TermCriteria(cv::TermCriteria::MAX_ITER, 12, 0.0), 1,
               cv::KMEANS_PP_CENTERS, dictionary_);
  }
  std::vector<float> dictionary() const override {
    return dictionary_.empty()
               ? std::vector<float>{}
               : std::vector<float>(dictionary_.begin<float>(), dictionary_.end<float>());
  }
  void setDictionary(const std::vector<float>& values) override {
    if (values.size() != static_cast<std::size_t>(words_) * static_cast<std::size_t>(length_)) {
      throw hyselam::InputError("BOF", "",
                                "the dictionary has " + std::to_string(values.size()) +
                                    " numbers, but " + std::to_string(words_) + " words need " +
                                    std::to_string(words_ * length_));
    }
    dictionary_ = cv::Mat(values, true).reshape(1, words_);
  }

  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    if (dictionary_.empty()) {
      throw hyselam::InputError("BOF", "", "has no dictionary yet: train it first");
    }
    detect(image);
    std::fill(out, out + size(), 0.0f);
    if (features_.rows == 0) return;
    const float unit = 1.0f / static_cast<float>(features_.rows);
    // The nearest word by |f|^2 - 2 f.w + |w|^2, without the part that is the same for all words.
    cv::gemm(features_, dictionary_, -2.0, cv::noArray(), 0.0, products_, cv::GEMM_2_T);
    squares_.resize(static_cast<std::size_t>(words_));
    for (int w = 0; w < words_; ++w) {
      squares_[w] = static_cast<float>(dictionary_.row(w).dot(dictionary_.row(w)));
    }
    for (int i = 0; i < features_.rows; ++i) {
      const float* row = products_.ptr<float>(i);
      int best = 0;
      for (int w = 1; w < words_; ++w) {
        if (row[w] + squares_[w] < row[best] + squares_[best]) best = w;
      }
      out[best] += unit;
      if (halves_) {
        const int half = keypoints_[i].pt.y < 0.5f * static_cast<float>(image.rows) ? 1 : 2;
        out[half * words_ + best] += unit;
      }
    }
  }

 private:
  void detect(const cv::Mat& image) {
    const cv::Mat& gray = grayOf(image, "BOF", gray_);
    detector_->detectAndCompute(gray, cv::noArray(), keypoints_, raw_);
    if (raw_.empty()) {
      features_.create(0, length_, CV_32F);
    } else {
      raw_.convertTo(features_, CV_32F);
    }
  }

  int words_;
  bool halves_;
  int length_;
  cv::Ptr<cv::Feature2D> detector_;
  cv::Mat dictionary_, gray_, raw_, features_, products_;
  std::vector<cv::KeyPoint> keypoints_;
  std::vector<float> squares_;
};

}  // namespace

DescriptorPtr makeBagOfFeatures(const std::string& name, const DescriptorParams& /*params*/) {
  const bool halves = name.size() > 2 && name.compare(name.size() - 2, 2, "-D") == 0;
  const std::string plain = halves ? name.substr(0, name.size() - 2) : name;
  for (const bool sift : {true, false}) {
    const int words = numberAfter(plain, sift ? "BOF-SIFT" : "BOF-ORB", 2, 5000);
    if (words > 0) return std::make_unique<BagOfFeatures>(sift, words, halves);
  }
  return nullptr;
}

}  // namespace selovis
