#include "ngram_slam/semantics/way_features.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {
namespace {

constexpr std::size_t kBeams = PlaceFeatures::kBeams;
constexpr std::size_t kHalf = kBeams / 2;
constexpr double kFar = 12.0;                                         // farther is as far [m]
constexpr double kMinOpening = 0.7;                                   // width of an opening [m]
constexpr double kSectorAngle = 360.0 / static_cast<double>(kBeams);  // [deg]
constexpr std::array<double, 5> kQuantiles{0.1, 0.25, 0.5, 0.75, 0.9};
constexpr std::size_t kWaves = 6;
constexpr std::array<double, 5> kCircles{2.0, 3.0, 4.5, 6.0, 8.0};  // [m]
constexpr std::array<bool, 5> kWithAngle{false, true, true, true, false};
constexpr std::array<std::size_t, 2> kSurfaceRings{4, 8};  // of a metre each

// Those of the shape that the surroundings of a place are compared by.
constexpr std::array<const char*, 10> kCompared{
    "distance 50",  "across shortest", "across longest's side", "openings 3",
    "openings 4.5", "angle 4.5",       "density 2.5",           "density 4",
    "wave 1",       "wave 2"};
constexpr std::array<double, 2> kMeanReach{2.0, 5.0};           // [m]
constexpr double kAside = 3.0;                                  // [m]
constexpr std::array<double, 3> kStraightReach{2.0, 4.0, 8.0};  // [m]
constexpr std::array<double, 2> kTurnReach{1.0, 3.0};           // [m]

std::string numbered(const char* name, double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return std::string(name) + " " + text;
}

std::vector<std::string> shapeNames() {
  std::vector<std::string> names;
  for (const double q : kQuantiles) names.push_back(numbered("distance", 100.0 * q));
  for (std::size_t k = 1; k <= kWaves; ++k) names.push_back("wave " + std::to_string(k));
  names.insert(names.end(), {"across shortest", "across longest", "across longest's side"});
  for (std::size_t i = 0; i < kCircles.size(); ++i) {
    names.push_back(numbered("openings", kCircles[i]));
    names.push_back(numbered("widest", kCircles[i]));
    if (kWithAngle[i]) names.push_back(numbered("angle", kCircles[i]));
  }
  for (const double b : PlaceFeatures::kBandwidths) names.push_back(numbered("density", b));
  for (const std::size_t r : kSurfaceRings) names.push_back("surfaces " + std::to_string(r));
  return names;
}

/// Beams in a row that are free beyond a circle, and the middle of them.
struct Opening {
  int beams = 0;
  double middle = 0.0;  // [beams]
};

/// Wider than kMinOpening, the widest first. All around is one opening.
std::vector<Opening> openings(const std::array<float, kBeams>& distances, double radius) {
  std::vector<Opening> out;
  const auto isOpen = [&](std::size_t b) { return distances[b % kBeams] > radius; };
  std::size_t begin = 0;
  while (begin < kBeams && isOpen(begin)) ++begin;
  if (begin == kBeams) return {{static_cast<int>(kBeams), 0.0}};
  for (std::size_t i = begin; i < begin + kBeams;) {
    if (!isOpen(i)) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (isOpen(end)) ++end;
    const auto beams = static_cast<int>(end - i);
    if (hyselam::radians(beams * kSectorAngle) * radius >= kMinOpening) {
      out.push_back({beams, 0.5 * static_cast<double>(i + end - 1)});
    }
    i = end;
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Opening& a, const Opening& b) { return a.beams > b.beams; });
  return out;
}

double angleBetween(const Opening& a, const Opening& b) {
  const double angle = std::fmod(std::abs(a.middle - b.middle) * kSectorAngle, 360.0);
  return std::min(angle, 360.0 - angle);
}

/// Between the two widest; of several as wide as these, the largest angle, whichever comes first.
double widestAngle(const std::vector<Opening>& open) {
  double angle = 0.0;
  for (std::size_t i = 0; i < open.size() && open[i].beams == open[0].beams; ++i) {
    for (std::size_t k = i + 1; k < open.size() && open[k].beams >= open[1].beams; ++k) {
      angle = std::max(angle, angleBetween(open[i], open[k]));
    }
  }
  return angle;
}

/// Length of the line of sight across the longest one, the median of every other within 20 degrees
/// of the perpendicular; across the longest ones, the shortest.
double sideOf(const std::array<double, kHalf>& across) {
  const double longest = *std::max_element(across.begin(), across.end());
  double shortest = std::numeric_limits<double>::max();
  for (std::size_t b = 0; b < kHalf; ++b) {
    if (across[b] < longest) continue;
    std::array<double, 5> side{};
    for (std::size_t k = 0; k < side.size(); ++k) {
      side[k] = across[(b + kHalf / 2 - 4 + 2 * k) % kHalf];
    }
    std::sort(side.begin(), side.end());
    shortest = std::min(shortest, side[side.size() / 2]);
  }
  return shortest;
}

/// Steps of equal length in a run.
double spacingOf(const std::vector<WayPlace>& run) {
  if (run.size() < 2) return 1.0;
  const double spacing = run[1].way - run[0].way;
  for (std::size_t i = 1; i < run.size(); ++i) {
    const double step = run[i].way - run[i - 1].way;
    if (!(step > 0.0) || !(std::abs(step - spacing) < 1e-6)) {
      throw hyselam::ParameterError("way of place " + std::to_string(i), run[i].way,
                                    "a step of " + std::to_string(spacing) + " m on");
    }
  }
  return spacing;
}

/// Places within a reach of each place.
class Reach {
 public:
  Reach(const std::vector<WayPlace>& run, double spacing) : size_(run.size()), spacing_(spacing) {}
  std::size_t before(std::size_t i, double reach) const { return i - std::min(i, steps(reach)); }
  std::size_t after(std::size_t i, double reach) const {
    return std::min(size_ - 1, i + steps(reach));
  }

 private:
  std::size_t steps(double reach) const {
    return static_cast<std::size_t>(std::lround(reach / spacing_));
  }
  std::size_t size_;
  double spacing_;
};

std::vector<std::size_t> comparedIndices() {
  const std::vector<std::string> names = shapeNames();
  std::vector<std::size_t> out;
  for (const char* name : kCompared) {
    out.push_back(
        static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
  }
  return out;
}

/// How straight the way is around a place: distance of its ends by its length, and the cosine of
/// the angle between the directions from where it comes and to where it goes.
void appendStraightness(const std::vector<WayPlace>& run, std::size_t first, std::size_t i,
                        std::size_t last, std::vector<float>* out) {
  const hyselam::Pose2 &a = run[first].pose, &m = run[i].pose, &b = run[last].pose;
  const double length = run[last].way - run[first].way;
  out->push_back(length > 0.0 ? static_cast<float>(distance(a, b) / length) : 1.0F);
  const double lengths = distance(a, m) * distance(m, b);
  const double dot = (m.x - a.x) * (b.x - m.x) + (m.y - a.y) * (b.y - m.y);
  out->push_back(lengths > 1e-6 ? static_cast<float>(dot / lengths) : 1.0F);
}

}  // namespace

WayShape wayShapeOf(const PlaceFeatures& features) {
  std::array<float, kBeams> d{};
  for (std::size_t b = 0; b < kBeams; ++b) {
    d[b] = std::min(features.distances[b], static_cast<float>(kFar));
  }
  WayShape shape{};
  std::size_t n = 0;
  const auto add = [&](double value) { shape.at(n++) = static_cast<float>(value); };
  std::array<float, kBeams> sorted = d;
  std::sort(sorted.begin(), sorted.end());
  for (const double q : kQuantiles) add(sorted[static_cast<std::size_t>(q * (kBeams - 1))]);
  for (std::size_t k = 1; k <= kWaves; ++k) {
    std::complex<double> sum;
    for (std::size_t b = 0; b < kBeams; ++b) {
      const double phase = -2.0 * hyselam::kPi * static_cast<double>(k * b % kBeams) / kBeams;
      sum += std::log(d[b] + 0.3) * std::polar(1.0, phase);
    }
    add(std::abs(sum) / kBeams);
  }
  std::array<double, kHalf> across{};
  for (std::size_t b = 0; b < kHalf; ++b) across[b] = d[b] + d[b + kHalf];
  add(*std::min_element(across.begin(), across.end()));
  add(*std::max_element(across.begin(), across.end()));
  add(sideOf(across));
  for (std::size_t i = 0; i < kCircles.size(); ++i) {
    const std::vector<Opening> open = openings(d, kCircles[i]);
    add(static_cast<double>(open.size()));
    add(open.empty() ? 0.0 : open[0].beams * kSectorAngle);
    if (kWithAngle[i]) add(widestAngle(open));
  }
  for (const float density : features.densities) add(density);
  for (const std::size_t rings : kSurfaceRings) {
    double surfaces = 0.0, seen = 0.0;
    for (const auto& sector : features.context) {
      for (std::size_t r = 0; r < rings; ++r) surfaces += sector[r];
    }
    for (const float distance : d) {
      const double r = std::min<double>(distance, static_cast<double>(rings));
      seen += r * r;
    }
    add(surfaces / std::max(1.0, seen));
  }
  return shape;
}

const std::vector<std::string>& wayFeatureNames() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names = shapeNames();
    const auto addCompared = [&](const std::string& what) {
      for (const char* name : kCompared) names.push_back(what + ": " + name);
    };
    for (const double reach : kMeanReach) addCompared(numbered("mean within", reach));
    addCompared("lower side");
    addCompared("higher side");
    for (const double reach : kStraightReach) {
      names.push_back(numbered("straight", reach));
      names.push_back(numbered("ahead", reach));
    }
    for (const double reach : kTurnReach) names.push_back(numbered("turn", reach));
    for (std::string& name : names) std::replace(name.begin(), name.end(), ' ', '_');
    return names;
  }();
  return all;
}

std::vector<std::vector<float>> wayFeaturesOf(const std::vector<WayPlace>& run) {
  static const std::vector<std::size_t> compared = comparedIndices();
  const Reach reach(run, spacingOf(run));
  std::vector<double> headings;
  std::vector<std::array<double, kCompared.size()>> sums(run.size() + 1);
  for (std::size_t i = 0; i < run.size(); ++i) {
    const double turn =
        i == 0 ? 0.0 : hyselam::normalizeAngle(run[i].pose.theta - run[i - 1].pose.theta);
    headings.push_back(i == 0 ? 0.0 : headings.back() + turn);
    for (std::size_t k = 0; k < compared.size(); ++k) {
      sums[i + 1][k] = sums[i][k] + static_cast<double>(run[i].shape[compared[k]]);
    }
  }
  std::vector<std::vector<float>> out;
  for (std::size_t i = 0; i < run.size(); ++i) {
    std::vector<float> f(run[i].shape.begin(), run[i].shape.end());
    for (const double r : kMeanReach) {
      const std::size_t first = reach.before(i, r), last = reach.after(i, r);
      for (std::size_t k = 0; k < compared.size(); ++k) {
        f.push_back(static_cast<float>((sums[last + 1][k] - sums[first][k]) /
                                       static_cast<double>(last - first + 1)));
      }
    }
    const WayShape &before = run[reach.before(i, kAside)].shape,
                   &after = run[reach.after(i, kAside)].shape;
    for (const std::size_t k : compared) f.push_back(std::min(before[k], after[k]));
    for (const std::size_t k : compared) f.push_back(std::max(before[k], after[k]));
    for (const double r : kStraightReach) {
      appendStraightness(run, reach.before(i, r), i, reach.after(i, r), &f);
    }
    for (const double r : kTurnReach) {
      const auto first = headings.begin() + static_cast<std::ptrdiff_t>(reach.before(i, r));
      const auto last = headings.begin() + static_cast<std::ptrdiff_t>(reach.after(i, r)) + 1;
      const auto range = std::minmax_element(first, last);
      f.push_back(static_cast<float>(*range.second - *range.first));
    }
    out.push_back(std::move(f));
  }
  return out;
}

}  // namespace ngram_slam
