// A similarity matrix (Fig. 4.11) of what is true and what was recognised.
#pragma once

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "ngram_slam/matching/recognition_score.hpp"

namespace ngram_slam {
namespace picture {

const cv::Scalar kPaper(255, 255, 255), kInk(60, 60, 60), kRaster(232, 232, 232);
const cv::Scalar kSame(190, 190, 190), kReverse(170, 215, 235);
const cv::Scalar kRight(170, 90, 20), kRightReverse(90, 140, 20), kWrong(40, 30, 210);
constexpr int kSide = 1000, kLeft = 90, kTop = 60, kBelow = 110;  // pixels

inline void write(cv::Mat& image, const std::string& text, cv::Point at, double size = 0.55,
                  bool centred = false) {
  if (centred) at.x -= cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, nullptr).width / 2;
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

/// 1, 2 or 5 times a power of ten: the distance of about eight marks.
inline std::uint32_t markStep(std::uint32_t size) {
  for (std::uint32_t power = 1;; power *= 10)
    for (const std::uint32_t digit : {1, 2, 5})
      if (digit * power * 8 >= size) return digit * power;
}

}  // namespace picture

/// Rows: every observation; columns: those before it. Light: pairs that are true; dark: those that
/// were told, by colour right or wrong.
/// @throws hyselam::InputError if the file cannot be written.
inline void saveSimilarityPicture(const std::string& path, const RecognitionScore& score) {
  using namespace picture;  // NOLINT: one function
  const RecognitionTruth& truth = score.truth();
  const std::uint32_t n = std::max<std::uint32_t>(1, truth.size());
  cv::Mat matrix(kSide, kSide, CV_8UC3, kPaper);
  const auto pixel = [&](std::uint32_t i) {
    return static_cast<int>(static_cast<std::uint64_t>(i) * kSide / n);
  };
  const auto mark = [&](std::uint32_t newer, std::uint32_t older, const cv::Scalar& colour) {
    matrix.at<cv::Vec3b>(pixel(newer), pixel(older)) =
        cv::Vec3b(static_cast<uchar>(colour[0]), static_cast<uchar>(colour[1]),
                  static_cast<uchar>(colour[2]));
  };
  for (const Direction direction : {Direction::kReverse, Direction::kSame})
    for (std::uint32_t i = 0; i < truth.size(); ++i)
      for (std::size_t k = truth.passesBegin(i); k < truth.passesEnd(i); ++k) {
        const RecognitionTruth::Pass& pass = truth.passes()[k];
        if (pass.direction != direction) continue;
        for (std::uint32_t older = pass.first; older <= pass.last; ++older)
          mark(i, older, direction == Direction::kSame ? kSame : kReverse);
      }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> wrong;
  score.forEachPair([&](std::uint32_t newer, std::uint32_t older, Direction direction) {
    if (*truth.verdict(newer, older, direction))
      mark(newer, older, direction == Direction::kSame ? kRight : kRightReverse);
    else
      wrong.emplace_back(newer, older);
  });
  for (const auto& [newer, older] : wrong) mark(newer, older, kWrong);

  cv::Mat image(kTop + kSide + kBelow, kLeft + kSide + 30, CV_8UC3, kPaper);
  for (std::uint32_t i = 0, step = markStep(n); i < n; i += step) {
    write(image, std::to_string(i), {kLeft + pixel(i), kTop + kSide + 22}, 0.5, true);
    write(image, std::to_string(i), {kLeft - 55, kTop + pixel(i) + 5}, 0.5, true);
    for (int k = 0; k < kSide; ++k) {
      for (const cv::Point at : {cv::Point(pixel(i), k), cv::Point(k, pixel(i))}) {
        cv::Vec3b& p = matrix.at<cv::Vec3b>(at);
        if (p == cv::Vec3b(255, 255, 255)) p = cv::Vec3b::all(232);
      }
    }
  }
  matrix.copyTo(image(cv::Rect(kLeft, kTop, kSide, kSide)));
  cv::rectangle(image, {kLeft - 1, kTop - 1, kSide + 2, kSide + 2}, kInk);
  write(image, "observation (rows) against those before it (columns)", {kLeft, kTop - 20}, 0.65);
  const std::vector<std::pair<const char*, cv::Scalar>> legend{
      {"true, same way", kSame},
      {"true, other way", kReverse},
      {"recognised", kRight},
      {"recognised in reverse", kRightReverse},
      {"wrong", kWrong}};
  int x = kLeft;
  for (const auto& [text, colour] : legend) {
    cv::rectangle(image, {x, kTop + kSide + 58, 16, 16}, colour, cv::FILLED);
    write(image, text, {x + 24, kTop + kSide + 72});
    x += 54 + cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.55, 1, nullptr).width;
  }
  std::vector<uchar> bytes;
  cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 9});
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  });
}

}  // namespace ngram_slam
