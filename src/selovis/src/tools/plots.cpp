#include "plots.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace selovis {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
const cv::Scalar kInk(40, 40, 40), kPale(225, 225, 225);

int widthOf(const std::string& text, double scale) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, scale, 1, &baseline).width;
}

void write(cv::Mat& image, const std::string& text, cv::Point at, double scale,
           const cv::Scalar& color = kInk) {
  cv::putText(image, text, at, kFont, scale, color, 1, cv::LINE_AA);
}

int widest(const std::vector<std::string>& names, double scale) {
  int width = 0;
  for (const auto& name : names) width = std::max(width, widthOf(name, scale));
  return width;
}

}  // namespace

cv::Mat drawConfusion(const std::vector<std::string>& truths,
                      const std::vector<std::string>& answers,
                      const std::vector<std::vector<int>>& counts, const std::string& title) {
  const double scale = 0.5;
  const int rows = static_cast<int>(truths.size()), cols = static_cast<int>(answers.size());
  const int cell = std::clamp(900 / std::max(1, cols), 24, 70);
  const int left = widest(truths, scale) + 30, top = 60, legend = widest(answers, scale) + 20;
  cv::Mat image(top + rows * cell + legend + 10,
                std::max(left + cols * cell + 20, widthOf(title, 0.6) + 30), CV_8UC3,
                cv::Scalar(255, 255, 255));
  write(image, title, {15, 30}, 0.6);
  for (int r = 0; r < rows; ++r) {
    const std::string& name = truths[static_cast<std::size_t>(r)];
    write(image, name, {left - 10 - widthOf(name, scale), top + r * cell + cell / 2 + 5}, scale);
    double sum = 0.0;
    for (const int n : counts[static_cast<std::size_t>(r)]) sum += n;
    for (int c = 0; c < cols; ++c) {
      const double share =
          sum > 0.0 ? counts[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] / sum : 0.0;
      const cv::Rect box(left + c * cell, top + r * cell, cell, cell);
      const double dark = std::sqrt(share);
      cv::rectangle(image, box, cv::Scalar(255 - 75 * dark, 255 - 135 * dark, 255 - 225 * dark),
                    cv::FILLED);
      cv::rectangle(image, box, kPale);
      if (share >= 0.005 && cell >= 34) {
        const std::string text = std::to_string(static_cast<int>(std::lround(100.0 * share)));
        write(image, text, {box.x + (cell - widthOf(text, scale)) / 2, box.y + cell / 2 + 5}, scale,
              share > 0.5 ? cv::Scalar(255, 255, 255) : kInk);
      }
    }
  }
  // Names of the columns stand on end.
  for (int c = 0; c < cols; ++c) {
    const std::string& name = answers[static_cast<std::size_t>(c)];
    cv::Mat strip(20, legend, CV_8UC3, cv::Scalar(255, 255, 255));
    write(strip, name, {legend - 8 - widthOf(name, scale), 15}, scale);
    cv::rotate(strip, strip, cv::ROTATE_90_COUNTERCLOCKWISE);
    strip.copyTo(image(cv::Rect(left + c * cell + cell / 2 - 10, top + rows * cell, 20, legend)));
  }
  return image;
}

cv::Mat drawTimeline(const std::vector<std::string>& places, const std::vector<int>& truth,
                     const std::vector<int>& answers, const std::string& title) {
  const double scale = 0.5;
  const int frames = static_cast<int>(truth.size()), rows = static_cast<int>(places.size());
  const int left = widest(places, scale) + 25, top = 60,
            step = std::clamp(420 / std::max(1, rows), 14, 44);
  const int width = std::clamp(frames * 3, 600, 1400);
  cv::Mat image(top + rows * step + 50, left + width + 30, CV_8UC3, cv::Scalar(255, 255, 255));
  write(image, title, {15, 25}, 0.6);
  const cv::Scalar blue(200, 90, 20), red(40, 40, 220);
  cv::line(image, {left, 46}, {left + 30, 46}, blue, 5);
  write(image, "truth", {left + 38, 51}, scale);
  cv::line(image, {left + 110, 46}, {left + 140, 46}, red, 2, cv::LINE_AA);
  write(image, "recognised", {left + 148, 51}, scale);
  for (int r = 0; r < rows; ++r) {
    const int y = top + r * step + step / 2;
    const std::string& name = places[static_cast<std::size_t>(r)];
    write(image, name, {left - 12 - widthOf(name, scale), y + 5}, scale);
    cv::line(image, {left, y}, {left + width, y}, kPale);
  }
  const auto x = [&](int i) {
    return left + static_cast<int>((i + 0.5) * width / std::max(1, frames));
  };
  const auto y = [&](int place) { return top + place * step + step / 2; };
  const int half = std::max(1, width / std::max(1, 2 * frames));
  for (int i = 0; i < frames; ++i) {
    const int at = truth[static_cast<std::size_t>(i)];
    if (at >= 0) cv::line(image, {x(i) - half, y(at)}, {x(i) + half, y(at)}, blue, 5);
  }
  for (int i = 0; i < frames; ++i) {
    const int at = answers[static_cast<std::size_t>(i)];
    if (at < 0) continue;
    const int before = i > 0 ? answers[static_cast<std::size_t>(i) - 1] : -1;
    if (before >= 0) cv::line(image, {x(i - 1), y(before)}, {x(i), y(at)}, red, 1, cv::LINE_AA);
    cv::circle(image, {x(i), y(at)}, 2, red, cv::FILLED, cv::LINE_AA);
  }
  for (int k = 0; k <= 8; ++k) {
    const int frame = k * frames / 8;
    const std::string text = std::to_string(frame);
    const int at = left + k * width / 8;
    cv::line(image, {at, top + rows * step}, {at, top + rows * step + 6}, kInk);
    write(image, text, {at - widthOf(text, 0.45) / 2, top + rows * step + 24}, 0.45);
  }
  write(image, "frame", {left + width / 2 - 20, top + rows * step + 44}, 0.45);
  return image;
}

}  // namespace selovis
