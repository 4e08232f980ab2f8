#include "hyselam_topological_map/place_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <sstream>
#include <vector>

namespace hyselam_topo {
namespace {

using hyselam::Point2;

constexpr double kBlank = 0.58;       // width of a blank, of the height of a line
constexpr double kStep = 0.1;         // [m] between the points that are looked at
constexpr double kMaxPoints = 250e3;  // more: the step grows
constexpr int kFrame = 3;             // points around the place; more than a closing adds
constexpr double kNear = 1.0;         // [m] from the node to the middle of a text beside its place
constexpr double kShrink = 0.92;      // from one height to the next smaller one

double widthOf(char c) {
  const auto in = [c](const char* set) { return std::string(set).find(c) != std::string::npos; };
  if (c == ' ') return kBlank;
  if ((static_cast<unsigned char>(c) & 0xc0u) == 0x80u) return 0.0;  // the rest of a UTF-8 letter
  if (in("ijlftrI'.,:-()")) return 0.28;
  if (in("mwMW")) return 0.72;
  return c >= 'A' && c <= 'Z' ? 0.6 : 0.48;
}

double widthOf(const std::string& line) {
  double width = 0.0;
  for (const char c : line) width += widthOf(c);
  return width;
}

using Lines = std::vector<std::string>;

/// Shorter lines are indented, since rviz sets all of them flush left.
std::string centred(const Lines& lines) {
  double longest = 0.0;
  for (const std::string& line : lines) longest = std::max(longest, widthOf(line));
  std::string text;
  for (const std::string& line : lines) {
    const double blanks = 0.5 * (longest - widthOf(line)) / kBlank;
    if (!text.empty()) text += '\n';
    text.append(static_cast<std::size_t>(std::lround(blanks)), ' ');
    text += line;
  }
  return text;
}

/// The words in so many lines that the longest is as short as it can be when they are filled one
/// after the other.
Lines broken(const Lines& words, std::size_t count) {
  std::vector<double> limits;  // the width of some run of words
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::string run;
    for (std::size_t k = i; k < words.size(); ++k) {
      run += (run.empty() ? "" : " ") + words[k];
      limits.push_back(widthOf(run) + 1e-9);
    }
  }
  std::sort(limits.begin(), limits.end());
  for (const double limit : limits) {
    Lines lines;
    for (const std::string& word : words) {
      const bool fits = !lines.empty() && widthOf(lines.back() + " " + word) <= limit;
      if (fits) {
        lines.back() += " " + word;
      } else {
        lines.push_back(word);
      }
    }
    bool all = lines.size() <= count;
    for (const std::string& line : lines) all = all && widthOf(line) <= limit;
    if (all) return lines;
  }
  return words;
}

/// All ways to write it, those with fewer lines first; one at least.
std::vector<std::string> layouts(const std::string& code, const std::string& name) {
  Lines words;
  std::istringstream in(name);
  for (std::string word; in >> word;) words.push_back(word);
  std::vector<std::string> all;
  if (words.empty()) return {code};
  if (!code.empty()) all.push_back(code + " " + name);
  for (std::size_t count = 1; count <= words.size(); ++count) {
    Lines lines = broken(words, count);
    if (!code.empty()) lines.insert(lines.begin(), code);
    const std::string text = centred(lines);
    if (std::find(all.begin(), all.end(), text) == all.end()) all.push_back(text);
  }
  return all;
}

constexpr Id kAnyPlace = 0;

/// A place, or all places, within a box, as an image along the axes of the map with a frame of
/// points outside.
class Area {
 public:
  Area(const PlaceGrid& grid, Id id, const CellBox& box) {
    const double r = grid.geometry.resolution;
    Point2 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Point2 high{-low.x, -low.y};
    for (const int x : {box.x_begin, box.x_end}) {
      for (const int y : {box.y_begin, box.y_end}) {
        const Point2 p = grid.geometry.origin * Point2{x * r, y * r};
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      }
    }
    step_ = std::max(kStep, std::sqrt((high.x - low.x) * (high.y - low.y) / kMaxPoints));
    low_ = {low.x - kFrame * step_, low.y - kFrame * step_};
    inside_ =
        cv::Mat::zeros(static_cast<int>(std::ceil((high.y - low.y) / step_)) + 2 * kFrame,
                       static_cast<int>(std::ceil((high.x - low.x) / step_)) + 2 * kFrame, CV_8U);
    for (int y = kFrame; y < inside_.rows - kFrame; ++y) {
      for (int x = kFrame; x < inside_.cols - kFrame; ++x) {
        const Id here = grid.placeOf(grid.geometry.cellAt(point(x, y)));
        if (id == kAnyPlace ? here != 0 : here == id) inside_.at<uchar>(y, x) = 1;
      }
    }
    // Single cells that the laser has not seen are no obstacle to a name.
    cv::morphologyEx(inside_, inside_, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8U));
    sum();
  }

  /// From now on, the points of a disc do not belong to the place.
  void cutOut(Point2 centre, double radius) {
    inside_ = inside_.clone();  // copies of an Area share it
    for (int y = 0; y < inside_.rows; ++y) {
      for (int x = 0; x < inside_.cols; ++x) {
        const Point2 p = point(x, y);
        if (std::hypot(p.x - centre.x, p.y - centre.y) < radius) inside_.at<uchar>(y, x) = 0;
      }
    }
    sum();
  }

  /// The middle, nearest to a point, of a rectangle within the place.
  std::optional<Point2> fit(double width, double height, Point2 near) const {
    const int w = static_cast<int>(std::ceil(width / step_));
    const int h = static_cast<int>(std::ceil(height / step_));
    std::optional<Point2> best;
    double least = std::numeric_limits<double>::infinity();
    for (int y = 0; y + h <= inside_.rows; ++y) {
      const int *low = sums_.ptr<int>(y), *high = sums_.ptr<int>(y + h);
      for (int x = 0; x + w <= inside_.cols; ++x) {
        if (high[x + w] - high[x] - low[x + w] + low[x] != w * h) continue;
        const Point2 p{low_.x + (x + 0.5 * w) * step_, low_.y + (y + 0.5 * h) * step_};
        const double distance = std::hypot(p.x - near.x, p.y - near.y);
        if (distance < least - 1e-9) {
          least = distance;
          best = p;
        }
      }
    }
    return best;
  }

  /// The centre of the largest circle within the place.
  Point2 deepest() const {
    cv::Mat distance;
    cv::distanceTransform(inside_, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::Point at;
    cv::minMaxLoc(distance, nullptr, nullptr, nullptr, &at);
    return point(at.x, at.y);
  }

 private:
  Point2 point(int x, int y) const {
    return {low_.x + (x + 0.5) * step_, low_.y + (y + 0.5) * step_};
  }
  void sum() {
    sums_.release();
    cv::integral(inside_, sums_, CV_32S);
  }

  double step_ = kStep;
  Point2 low_;
  cv::Mat inside_, sums_;
};

/// The middle of a text right above the node of a place.
Point2 above(const Place& place, double height, const PlaceLabelParams& params) {
  return {place.centre->x, place.centre->y + params.node_radius + params.margin + 0.5 * height};
}

std::optional<PlaceLabel> largestThatFits(const Area& area, const Place& place,
                                          const std::vector<std::string>& texts, double max_height,
                                          const PlaceLabelParams& params) {
  for (double height = max_height;; height = std::max(params.min_height, kShrink * height)) {
    std::optional<PlaceLabel> best;
    double least = std::numeric_limits<double>::infinity();
    for (const std::string& text : texts) {
      const TextSize size = textSize(text);
      const double h = height * size.height;
      const Point2 wanted = above(place, h, params);
      const auto found =
          area.fit(height * size.width + 2 * params.margin, h + 2 * params.margin, wanted);
      if (!found) continue;
      const double distance = std::hypot(found->x - wanted.x, found->y - wanted.y);
      if (distance >= least - kStep) continue;  // fewer lines are better
      least = distance;
      best = PlaceLabel{*found, height, text};
    }
    if (best || height <= params.min_height) return best;
  }
}

}  // namespace

TextSize textSize(const std::string& text) {
  TextSize size;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    size.width = std::max(size.width, widthOf(line));
    size.height += 1.0;
  }
  return size;
}

PlaceLabel placeLabel(const AugmentedTopologicalMap& map, const Place& place, const CellBox* box,
                      const std::string& code, const std::string& name,
                      const PlaceLabelParams& params) {
  const std::vector<std::string> texts = layouts(code, name);
  if (box == nullptr || !map.grid) {
    const std::string& text = code.empty() || texts.size() < 2 ? texts[0] : texts[1];
    const double height =
        std::clamp(0.1 * std::sqrt(place.area), params.min_height, params.max_height);
    return {above(place, height * textSize(text).height, params), height, text};
  }
  Area area(*map.grid, place.id, *box);
  const Point2 deepest = area.deepest();
  Area beside = area;
  beside.cutOut({place.centre->x, place.centre->y}, params.node_radius);
  if (auto label = largestThatFits(beside, place, texts, params.max_height, params)) return *label;
  // Over a border without a wall rather than over the node, if it is clear which node is meant.
  const int cells = static_cast<int>(std::ceil(kNear / map.grid->geometry.resolution));
  Area around(*map.grid, kAnyPlace,
              {box->x_begin - cells, box->y_begin - cells, box->x_end + cells, box->y_end + cells});
  around.cutOut({place.centre->x, place.centre->y}, params.node_radius);
  const auto near = largestThatFits(around, place, texts, params.min_height, params);
  if (near &&
      std::hypot(near->position.x - place.centre->x, near->position.y - place.centre->y) < kNear) {
    return *near;
  }
  if (auto label = largestThatFits(area, place, texts, params.min_height, params)) return *label;
  const auto narrowest =
      std::min_element(texts.begin(), texts.end(), [](const auto& a, const auto& b) {
        const TextSize p = textSize(a), q = textSize(b);
        return std::max(p.width, p.height) < std::max(q.width, q.height);
      });
  return {deepest, params.min_height, *narrowest};
}

}  // namespace hyselam_topo
