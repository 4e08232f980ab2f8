// A confusion matrix as a picture.
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "ngram_slam/semantics/semantic_score.hpp"

namespace ngram_slam {

/// Rows: what was there, as shares of the row in colour, with the observations below; one further
/// row and column hold precision and recall. Classes that neither occur nor are predicted are left
/// out as rows.
inline cv::Mat drawConfusion(const SemanticConfusion& confusion, const std::string& title) {
  constexpr int kCell = 130, kRow = 92, kLeft = 190, kTop = 150, kMargin = 30, kGap = 10;
  const cv::Scalar ink(45, 45, 45), faint(130, 130, 130), paper(255, 255, 255), pale(244, 244, 244);
  std::vector<SemanticClass> rows;
  for (SemanticClass c : kAllSemanticClasses)
    if (confusion.actual(c) > 0) rows.push_back(c);
  const int columns = static_cast<int>(kSemanticClasses);
  const int width = kLeft + (columns + 1) * kCell + kGap + kMargin;
  const int height = kTop + (static_cast<int>(rows.size()) + 1) * kRow + kGap + kMargin + 24;
  cv::Mat image(height, width, CV_8UC3, paper);

  const auto write = [&](const std::string& text, cv::Point middle, double size,
                         const cv::Scalar& colour, int weight = 1) {
    int base = 0;
    const cv::Size box = cv::getTextSize(text, cv::FONT_HERSHEY_DUPLEX, size, weight, &base);
    cv::putText(image, text, {middle.x - box.width / 2, middle.y + box.height / 2},
                cv::FONT_HERSHEY_DUPLEX, size, colour, weight, cv::LINE_AA);
  };
  const auto percent = [](double share) {
    // One decimal, never rounded up to 100.
    const double tenths = share >= 1.0 ? 1000.0 : std::min(999.0, std::round(1000.0 * share));
    std::string text = std::to_string(static_cast<int>(tenths));
    text = std::string(text.size() < 2 ? 1 : 0, '0') + text;
    return text.substr(0, text.size() - 1) + "." + text.back() + "%";
  };
  const auto cell = [&](int row, int column, const cv::Scalar& colour) {
    const int x = kLeft + column * kCell + (column == columns ? kGap : 0);
    const int y = kTop + row * kRow + (row == static_cast<int>(rows.size()) ? kGap : 0);
    cv::rectangle(image, {x + 1, y + 1}, {x + kCell - 2, y + kRow - 2}, colour, cv::FILLED);
    return cv::Point(x + kCell / 2, y + kRow / 2);
  };

  write(title, {width / 2, 36}, 0.85, ink);
  write("predicted", {kLeft + columns * kCell / 2, 84}, 0.62, faint);
  for (int c = 0; c < columns; ++c)
    write(nameOf(kAllSemanticClasses[static_cast<std::size_t>(c)]),
          {kLeft + c * kCell + kCell / 2, 122}, 0.58, ink);
  write("recall", {kLeft + columns * kCell + kGap + kCell / 2, 122}, 0.58, faint);
  for (int r = 0; r < static_cast<int>(rows.size()); ++r) {
    const SemanticClass truth = rows[static_cast<std::size_t>(r)];
    write(nameOf(truth), {kLeft / 2 + 6, kTop + r * kRow + kRow / 2 - 10}, 0.58, ink);
    write(std::to_string(confusion.actual(truth)), {kLeft / 2 + 6, kTop + r * kRow + kRow / 2 + 16},
          0.48, faint);
    for (int c = 0; c < columns; ++c) {
      const auto n = confusion.counts[indexOf(truth)][static_cast<std::size_t>(c)];
      const double share = static_cast<double>(n) / static_cast<double>(confusion.actual(truth));
      const bool right = static_cast<std::size_t>(c) == indexOf(truth);
      // Right: towards blue, wrong: towards red; small shares are seen as well.
      const double strength = n == 0 ? 0.0 : 0.15 + 0.85 * std::sqrt(share);
      const cv::Scalar full = right ? cv::Scalar(150, 90, 30) : cv::Scalar(60, 70, 200);
      const cv::Scalar colour = n == 0 ? pale : (1.0 - strength) * paper + strength * full;
      const cv::Point middle = cell(r, c, colour);
      if (n == 0) continue;
      const cv::Scalar& text = strength > 0.55 ? paper : ink;
      write(percent(share), middle - cv::Point(0, 11), 0.66, text);
      write(std::to_string(n), middle + cv::Point(0, 18), 0.5, text);
    }
    if (const auto recall = confusion.recall(truth))
      write(percent(*recall), cell(r, columns, pale), 0.66, ink);
  }
  const int last = static_cast<int>(rows.size());
  write("precision", {kLeft / 2 + 6, kTop + last * kRow + kGap + kRow / 2}, 0.58, faint);
  for (int c = 0; c < columns; ++c) {
    const auto precision = confusion.precision(kAllSemanticClasses[static_cast<std::size_t>(c)]);
    const cv::Point middle = cell(last, c, pale);
    write(precision ? percent(*precision) : "-", middle, 0.66, precision ? ink : faint);
  }
  const cv::Point middle = cell(last, columns, pale);
  write("all " + percent(confusion.accuracy()), middle, 0.52, ink);
  write("observations, borders within tolerance forgiven", {width / 2, height - 22}, 0.46, faint);
  return image;
}

}  // namespace ngram_slam
