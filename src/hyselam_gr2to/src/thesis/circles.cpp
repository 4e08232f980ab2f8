#include "hyselam_gr2to/thesis/circles.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace hyselam_topo {

using hyselam::Cell;

namespace {

double between(const Circle& a, const Circle& b) {
  const double dx = a.centre.x - b.centre.x, dy = a.centre.y - b.centre.y;
  return std::sqrt(dx * dx + dy * dy);
}

// Stored circles by squares of the map, so that a new one looks at those near it only.
class Store {
 public:
  Store(int width, int height, double largest)
      : square_(std::max(1, static_cast<int>(std::ceil(2.0 * largest)))),
        columns_(width / square_ + 1),
        rows_(height / square_ + 1),
        squares_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  // All circles that overlap lie in the square of the new one's centre or around it.
  template <typename Visit>
  void near(const Circle& c, Visit visit) {
    const int cx = c.centre.x / square_, cy = c.centre.y / square_;
    for (int y = std::max(0, cy - 1); y <= std::min(rows_ - 1, cy + 1); ++y) {
      for (int x = std::max(0, cx - 1); x <= std::min(columns_ - 1, cx + 1); ++x) visit(at(x, y));
    }
  }
  void add(std::size_t id, const Circle& c) {
    at(c.centre.x / square_, c.centre.y / square_).push_back(id);
  }

 private:
  std::vector<std::size_t>& at(int x, int y) {
    return squares_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(x)];
  }
  int square_;
  int columns_;
  int rows_;
  std::vector<std::vector<std::size_t>> squares_;
};

}  // namespace

std::vector<Circle> packCircles(const DistanceMap& distances, const cv::Mat& lines) {
  std::vector<Circle> all;
  double largest = 0.0;
  for (int y = 0; y < lines.rows; ++y) {
    const std::uint8_t* row = lines.ptr<std::uint8_t>(y);
    for (int x = 0; x < lines.cols; ++x) {
      if (row[x] == 0) continue;
      all.push_back({{x, y}, distances.distance({x, y})});
      largest = std::max(largest, all.back().radius);
    }
  }
  Store store(lines.cols, lines.rows, largest);
  std::vector<char> kept(all.size(), 0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    bool largest_here = true;
    std::vector<std::size_t> overlapped;
    store.near(all[i], [&](const std::vector<std::size_t>& square) {
      for (const std::size_t k : square) {
        if (all[k].radius + all[i].radius < between(all[k], all[i])) continue;
        overlapped.push_back(k);
        largest_here = largest_here && all[i].radius > all[k].radius;
      }
    });
    if (!largest_here) continue;
    store.near(all[i], [&](std::vector<std::size_t>& square) {
      square.erase(std::remove_if(square.begin(), square.end(),
                                  [&](std::size_t k) {
                                    return std::find(overlapped.begin(), overlapped.end(), k) !=
                                           overlapped.end();
                                  }),
                   square.end());
    });
    for (const std::size_t k : overlapped) kept[k] = 0;
    kept[i] = 1;
    store.add(i, all[i]);
  }
  std::vector<Circle> out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (kept[i] != 0) out.push_back(all[i]);
  }
  return out;
}

std::vector<Circle> dropCoveredCircles(std::vector<Circle> circles, const DistanceMap& distances) {
  const double root2 = std::sqrt(2.0);
  std::vector<char> kept(circles.size(), 1);
  for (std::size_t i = 0; i < circles.size(); ++i) {
    for (std::size_t j = i + 1; j < circles.size() && kept[i] != 0; ++j) {
      if (kept[j] == 0) continue;
      const Circle &a = circles[i], &b = circles[j];
      if (root2 * (a.radius + b.radius) <= between(a, b)) continue;
      const Cell middle{(a.centre.x + b.centre.x) / 2, (a.centre.y + b.centre.y) / 2};
      if (distances.distance(middle) <= std::min(a.radius, b.radius)) continue;
      kept[a.radius < b.radius ? i : j] = 0;
    }
  }
  std::vector<Circle> out;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    if (kept[i] != 0) out.push_back(circles[i]);
  }
  return out;
}

std::vector<std::pair<std::size_t, std::size_t>> connectCircles(const std::vector<Circle>& circles,
                                                                const cv::Mat& lines) {
  cv::Mat owner(lines.size(), CV_32SC1, cv::Scalar(-1));
  std::vector<Cell> front;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const Circle& c = circles[i];
    const int r = static_cast<int>(std::floor(c.radius));
    for (int y = std::max(0, c.centre.y - r); y <= std::min(lines.rows - 1, c.centre.y + r); ++y) {
      for (int x = std::max(0, c.centre.x - r); x <= std::min(lines.cols - 1, c.centre.x + r);
           ++x) {
        if (lines.at<std::uint8_t>(y, x) == 0 || owner.at<int>(y, x) >= 0) continue;
        if (std::hypot(x - c.centre.x, y - c.centre.y) > c.radius) continue;
        owner.at<int>(y, x) = static_cast<int>(i);
        front.push_back({x, y});
      }
    }
  }
  std::set<std::pair<std::size_t, std::size_t>> links;
  for (std::size_t k = 0; k < front.size(); ++k) {
    const Cell c = front[k];
    const int own = owner.at<int>(c.y, c.x);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell n{c.x + dx, c.y + dy};
        if (n.x < 0 || n.y < 0 || n.x >= lines.cols || n.y >= lines.rows) continue;
        if (lines.at<std::uint8_t>(n.y, n.x) == 0) continue;
        int& other = owner.at<int>(n.y, n.x);
        if (other < 0) {
          other = own;
          front.push_back(n);
        } else if (other != own) {
          links.insert({static_cast<std::size_t>(std::min(own, other)),
                        static_cast<std::size_t>(std::max(own, other))});
        }
      }
    }
  }
  return {links.begin(), links.end()};
}

}  // namespace hyselam_topo
