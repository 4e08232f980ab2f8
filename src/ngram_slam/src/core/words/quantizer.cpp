#include "ngram_slam/words/quantizer.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::ParameterError;

DensityClasses::DensityClasses(std::vector<DensityClass> classes) : classes_(std::move(classes)) {
  if (classes_.empty()) throw ParameterError("number of density classes", 0, "1..256");
  std::set<int> ids;
  for (std::size_t i = 0; i < classes_.size(); ++i) {
    const DensityClass& c = classes_[i];
    if (c.id < 0 || c.id > 255) throw ParameterError("density class id", c.id, "0..255");
    if (!ids.insert(c.id).second) throw ParameterError("density class id", c.id, "unique");
    if (!(std::isfinite(c.upper) && std::isfinite(c.mode)) ||
        (i > 0 && c.upper <= classes_[i - 1].upper)) {
      throw ParameterError("upper bound of density class", c.upper, "above the one before");
    }
  }
}

DensityClasses DensityClasses::uniform(int count) {
  if (count < 1 || count > 256) throw ParameterError("number of density classes", count, "1..256");
  std::vector<DensityClass> classes;
  classes.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    classes.push_back({i, (i + 0.5) / count, static_cast<double>(i + 1) / count});
  }
  return DensityClasses(std::move(classes));
}

int DensityClasses::classOf(double density) const {
  std::size_t i = 0;
  while (i + 1 < classes_.size() && density >= classes_[i].upper) ++i;
  return classes_[i].id;
}

int DensityClasses::classOf(double density, int before, double hysteresis) const {
  for (std::size_t i = 0; i < classes_.size(); ++i) {
    if (classes_[i].id != before) continue;
    const bool above = i == 0 || density >= classes_[i - 1].upper - hysteresis;
    const bool below = i + 1 == classes_.size() || density < classes_[i].upper + hysteresis;
    if (above && below) return before;
  }
  return classOf(density);
}

namespace {

double centreOf(double bin, std::size_t bins) {
  return (bin + 0.5) / static_cast<double>(bins);
}

/// The histogram seen through a Gaussian window, at the centres of the bins.
std::vector<double> smoothed(const DensityHistogram& histogram, double bandwidth) {
  const auto n = static_cast<std::ptrdiff_t>(histogram.size());
  const double sigma = bandwidth * static_cast<double>(n);  // [bins]
  std::vector<double> window(histogram.size());
  for (std::size_t d = 0; d < window.size(); ++d) {
    const double z = static_cast<double>(d) / sigma;
    window[d] = std::exp(-0.5 * z * z);
  }
  std::vector<double> out(histogram.size(), 0.0);
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const auto count = static_cast<double>(histogram[static_cast<std::size_t>(i)]);
    if (count == 0.0) continue;
    for (std::ptrdiff_t k = 0; k < n; ++k) {
      out[static_cast<std::size_t>(k)] += count * window[static_cast<std::size_t>(std::abs(k - i))];
    }
  }
  return out;
}

/// The top of the parabola through a maximum and its neighbours, in bins.
double peak(const std::vector<double>& f, std::size_t i) {
  if (i == 0 || i + 1 == f.size()) return static_cast<double>(i);
  const double curvature = f[i - 1] - 2.0 * f[i] + f[i + 1];
  const double shift = curvature < 0.0 ? 0.5 * (f[i - 1] - f[i + 1]) / curvature : 0.0;
  return static_cast<double>(i) + std::clamp(shift, -0.5, 0.5);
}

}  // namespace

std::vector<DensityMode> densityModes(const DensityHistogram& histogram, double bandwidth,
                                      double min_share) {
  if (!(bandwidth > 0.0)) throw ParameterError("bandwidth", bandwidth, "> 0");
  if (histogram.size() < 2) throw ParameterError("bins", histogram.size(), ">= 2");
  double total = 0.0;
  for (auto c : histogram) total += static_cast<double>(c);
  if (total == 0.0) return {};

  const std::vector<double> f = smoothed(histogram, bandwidth);
  struct Basin {
    std::size_t begin, end, top;
    double mass;
  };
  std::vector<Basin> basins;
  for (std::size_t i = 0; i < f.size();) {
    Basin b{i, i, i, 0.0};
    while (i + 1 < f.size() && f[i + 1] >= f[i]) ++i;  // up
    b.top = i;
    while (i + 1 < f.size() && f[i + 1] < f[i]) ++i;  // down, to the lowest bin
    // The lowest bin itself climbs to the higher neighbour.
    if (i + 1 < f.size() && i > b.top && f[i + 1] > f[i - 1]) --i;
    b.end = ++i;
    for (std::size_t k = b.begin; k < b.end; ++k) b.mass += static_cast<double>(histogram[k]);
    basins.push_back(b);
  }
  // Weak ones join over the higher pass, the weakest first.
  for (;;) {
    const auto weakest =
        std::min_element(basins.begin(), basins.end(),
                         [](const Basin& a, const Basin& b) { return a.mass < b.mass; });
    if (basins.size() == 1 || (weakest->mass > 0.0 && weakest->mass >= min_share * total)) break;
    const auto at = weakest - basins.begin();
    const bool has_left = at > 0, has_right = at + 1 < static_cast<std::ptrdiff_t>(basins.size());
    const bool left = has_left && (!has_right || f[weakest->begin] >= f[weakest->end]);
    const auto into = left ? weakest - 1 : weakest + 1;
    into->mass += weakest->mass;
    into->begin = std::min(into->begin, weakest->begin);
    into->end = std::max(into->end, weakest->end);
    basins.erase(weakest);
  }
  std::vector<DensityMode> modes;
  modes.reserve(basins.size());
  for (const Basin& b : basins) {
    modes.push_back({centreOf(peak(f, b.top), f.size()), b.begin, b.end, b.mass / total});
  }
  return modes;
}

double bandwidthOf(const DensityHistogram& histogram, double min_share, int max_modes) {
  constexpr int kSteps = 24;
  constexpr double kNarrow = 0.006, kWide = 0.1;
  const double factor = std::pow(kWide / kNarrow, 1.0 / (kSteps - 1));
  int best_life = 0, life = 0;
  double best = kWide, width = kNarrow, born = kNarrow;
  std::size_t modes = 0;
  for (int step = 0; step < kSteps; ++step, width *= factor) {
    const std::size_t now = densityModes(histogram, width, min_share).size();
    if (now != modes) {
      modes = now;
      life = 0;
      born = width;
    }
    ++life;
    if (modes <= static_cast<std::size_t>(max_modes) && life > best_life) {
      best_life = life;
      best = std::sqrt(born * width);
    }
  }
  return best;
}

std::vector<DensityClass> classesOf(const std::vector<DensityMode>& modes, std::size_t bins,
                                    const std::vector<DensityClass>& old, double reach) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    for (std::size_t k = 0; k < old.size(); ++k) {
      pairs.push_back({std::abs(modes[i].mode - old[k].mode), i, k});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<int> id(modes.size(), -1);
  std::set<int> taken;
  for (const auto& [away, i, k] : pairs) {
    if (away > reach || id[i] >= 0 || taken.count(old[k].id) != 0) continue;
    id[i] = old[k].id;
    taken.insert(old[k].id);
  }
  std::vector<DensityClass> classes;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    for (int next = 0; id[i] < 0; ++next) {
      if (taken.insert(next).second) id[i] = next;
    }
    classes.push_back(
        {id[i], modes[i].mode, static_cast<double>(modes[i].end) / static_cast<double>(bins)});
  }
  return classes;
}

void MeanShiftParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("bandwidth", bandwidth, Range::between(0.0, 0.5), "",
        "sigma of the window, in densities; 0: from the data");
  visit("min_share", min_share, Range::between(0.0, 0.5), "",
        "of the observations; weaker modes are no class of their own");
  visit("tolerance", tolerance, Range::aboveUpTo(0.0, 1.0), "",
        "modes and bounds may move this far before the classes change");
  visit("max_classes", max_classes, Range::between(1, 64), "", "for a bandwidth from the data");
  visit("uniform_classes", uniform_classes, Range::between(1, 256), "",
        "classes before the first estimate");
  visit("first_update", first_update, Range::atLeast(1), "observations",
        "before the first estimate");
  visit("update_growth", update_growth, Range::aboveUpTo(1.0, 100.0), "",
        "the next estimate comes after so many times the observations");
}

void MeanShiftParams::validate() const {
  hyselam::checkParameters(*this);
}

MeanShiftQuantizer::MeanShiftQuantizer(const MeanShiftParams& params)
    : params_(params), histogram_(kBins, 0) {
  params.validate();
  classes_ = DensityClasses::uniform(params.uniform_classes);
  next_update_ = static_cast<std::uint64_t>(params.first_update);
}

bool MeanShiftQuantizer::add(double density) {
  const double bin = std::clamp(density, 0.0, 1.0) * static_cast<double>(kBins);
  ++histogram_[std::min(kBins - 1, static_cast<std::size_t>(bin))];
  if (++count_ < next_update_) return false;
  next_update_ =
      static_cast<std::uint64_t>(static_cast<double>(count_) * params_.update_growth) + 1;
  return update();
}

bool MeanShiftQuantizer::update() {
  if (count_ == 0) return false;
  const double bandwidth = params_.bandwidth > 0.0
                               ? params_.bandwidth
                               : bandwidthOf(histogram_, params_.min_share, params_.max_classes);
  std::vector<DensityMode> modes = densityModes(histogram_, bandwidth, params_.min_share);
  // Words know 256 classes; a bandwidth chosen far too small is widened.
  for (double wider = bandwidth; modes.size() > 256;) {
    modes = densityModes(histogram_, wider *= 1.5, params_.min_share);
  }
  const std::vector<DensityClass>& old = classes_.list();
  const std::vector<DensityClass> fresh =
      classesOf(modes, kBins, learnt_ ? old : std::vector<DensityClass>{},
                std::max(bandwidth, params_.tolerance));
  bool same = learnt_ && fresh.size() == old.size();
  for (std::size_t i = 0; same && i < fresh.size(); ++i) {
    same = fresh[i].id == old[i].id && std::abs(fresh[i].mode - old[i].mode) <= params_.tolerance &&
           (i + 1 == fresh.size() || std::abs(fresh[i].upper - old[i].upper) <= params_.tolerance);
  }
  if (same) return false;
  classes_ = DensityClasses(fresh);
  learnt_ = true;
  return true;
}

void MeanShiftQuantizer::restore(const DensityClasses& classes, const DensityHistogram& histogram) {
  if (histogram.size() != kBins) {
    throw ParameterError("bins of the histogram", histogram.size(), std::to_string(kBins));
  }
  classes_ = classes;
  histogram_ = histogram;
  count_ = 0;
  for (auto c : histogram) count_ += c;
  const auto first = static_cast<std::uint64_t>(params_.first_update);
  learnt_ = count_ >= first;
  next_update_ = first;
  while (next_update_ <= count_) {
    next_update_ =
        static_cast<std::uint64_t>(static_cast<double>(next_update_) * params_.update_growth) + 1;
  }
}

}  // namespace ngram_slam
