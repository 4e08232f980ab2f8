#include "fusion_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

using nlohmann::json;

constexpr double kFloor = 1e-3;  // probability of each place that a part leaves
constexpr double kMinSquaredDistance = 1e-6;

// Frames of one tour that are so many numbers apart are taken to be independent.
constexpr int kStretch = kPauseGap;
constexpr std::size_t kMaxFrames = 400;   // asked for, evenly chosen
constexpr std::size_t kLeastFrames = 50;  // with fewer the weights are not learned
constexpr double kLeastShare = 0.3;  // of the frames, whose place is left when their tour is not

// Weights without learning, chosen on environments other than the one that is learned (see
// docs/algorithms/visual_places.md), and the pull towards them.
constexpr double kLayoutWeight = 0.5, kColorWeight = 0.2, kTextureWeight = 0.3;
constexpr double kPull = 0.01, kPullOffset = 0.05;
constexpr double kMaxWeight = 5.0;

// The temperature is learned with so many frames about each one left out: how near the frames of
// later tours will be to learned ones is not known. On environments other than the one that is
// learned they need that share of it (see docs/algorithms/visual_places.md).
constexpr int kGaps[] = {1, 2, 5, 10, kStretch};
constexpr double kLaterTours = 0.6;
constexpr int kNextFrames[] = {1, 2};  // gaps of the frames that lie as near as one can learn

constexpr double kLeastSpan = 0.1;  // of logarithms of distances, between near and far
constexpr double kLittle = 0.02;    // share of parts that are all out of range
constexpr double kUnknownRate = 0.05;
constexpr double kMaxEvidenceScale = 4.0;

double priorWeight(const SignaturePart& part) {
  if (part.absolute_color) return kColorWeight;
  return part.name == "LGOP" || part.name == "SV-GIST" || part.name == "LOGCHROMA" ? kLayoutWeight
                                                                                   : kTextureWeight;
}

/// One learned frame, asked for while some frames are blocked.
struct Question {
  int place;
  std::vector<double> nearest;                       // of each part
  std::vector<std::vector<double>> log_likelihoods;  // of each part, by place
};

/// The tours of frames, and which frames must not answer for one of them.
class LeavingOut {
 public:
  static constexpr int kWholeTour = 0;

  explicit LeavingOut(const Samples& samples, const FrameIndex& frames) : blocked_(frames.count()) {
    for (std::size_t f = 0; f < frames.count(); ++f) {
      numbers_.push_back(samples.frames[frames.begin[f]]);
      places_.push_back(samples.places[frames.begin[f]]);
      tours_.push_back(f == 0 ? 0 : tours_.back() + (numbers_[f] - numbers_[f - 1] >= kTourGap));
    }
  }

  int placeOf(std::size_t frame) const { return places_[frame]; }

  /// @param gap frames of a number that differs by less; or kWholeTour.
  const std::vector<char>& blockedFor(std::size_t frame, int gap, bool whole_place) {
    for (std::size_t f = 0; f < blocked_.size(); ++f) {
      const bool near = std::abs(numbers_[f] - numbers_[frame]) < gap;
      blocked_[f] = (gap == kWholeTour ? tours_[f] == tours_[frame] : near) ||
                    (whole_place && places_[f] == places_[frame]);
    }
    return blocked_;
  }

  /// Frames whose place is left when they are left out: its first or last one is far enough.
  std::vector<std::size_t> askable(int gap) const {
    const std::vector<int>& at = gap == kWholeTour ? tours_ : numbers_;
    const int least = gap == kWholeTour ? 1 : gap;
    std::map<int, std::pair<int, int>> ends;  // of each place
    for (std::size_t f = 0; f < at.size(); ++f) {
      auto& [first, last] = ends.emplace(places_[f], std::make_pair(at[f], at[f])).first->second;
      first = std::min(first, at[f]);
      last = std::max(last, at[f]);
    }
    std::vector<std::size_t> frames;
    for (std::size_t f = 0; f < at.size(); ++f) {
      const auto& [first, last] = ends.at(places_[f]);
      if (at[f] - first >= least || last - at[f] >= least) frames.push_back(f);
    }
    return frames;
  }

 private:
  std::vector<int> numbers_, places_, tours_;
  std::vector<char> blocked_;
};

template <typename T>
std::vector<T> thinned(const std::vector<T>& all, std::size_t most) {
  std::vector<T> few;
  const std::size_t n = std::min(most, all.size());
  for (std::size_t i = 0; i < n; ++i) few.push_back(all[i * all.size() / n]);
  return few;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Log loss and accuracy of the weighted sum; `shares` of each question's parts.
class Objective {
 public:
  struct Trust {
    const std::vector<double>* weights;
    const std::vector<double>* shares;  // null: all are in range
  };

  Objective(const std::vector<Question>& questions, int places)
      : questions_(questions), sum_(static_cast<std::size_t>(places)) {}

  double logLoss(const std::vector<double>& weights) {
    return logLoss([&](std::size_t) { return Trust{&weights, nullptr}; }, 1.0);
  }

  /// @param trust_of gives the weights and shares of a question by its number.
  template <typename TrustOf>
  double logLoss(const TrustOf& trust_of, double temperature, double* accuracy = nullptr) {
    double loss = 0.0;
    std::size_t right = 0;
    for (std::size_t q = 0; q < questions_.size(); ++q) {
      const Question& question = questions_[q];
      const Trust trust = trust_of(q);
      const std::vector<double>& weights = *trust.weights;
      std::fill(sum_.begin(), sum_.end(), 0.0);
      double all = 0.0, asked = 0.0;
      for (std::size_t p = 0; p < weights.size(); ++p) {
        all += weights[p];
        asked += weights[p] * (trust.shares != nullptr ? (*trust.shares)[p] : 1.0);
      }
      const double sharpness = evidenceScale(all, asked) / temperature;
      for (std::size_t p = 0; p < weights.size(); ++p) {
        const double w =
            sharpness * weights[p] * (trust.shares != nullptr ? (*trust.shares)[p] : 1.0);
        if (w == 0.0) continue;
        const std::vector<double>& l = question.log_likelihoods[p];
        for (std::size_t k = 0; k < sum_.size(); ++k) sum_[k] += w * l[k];
      }
      const auto most = std::max_element(sum_.begin(), sum_.end());
      double total = 0.0;
      for (const double s : sum_) total += std::exp(s - *most);
      loss += std::log(total) + *most - sum_[static_cast<std::size_t>(question.place)];
      right += most - sum_.begin() == question.place;
    }
    const double n = static_cast<double>(questions_.size());
    if (accuracy != nullptr) *accuracy = static_cast<double>(right) / n;
    return loss / n;
  }

 private:
  const std::vector<Question>& questions_;
  std::vector<double> sum_;
};

/// Cyclic search, one weight after the other, by factors that shrink where none helps.
void learnWeights(Objective& objective, const std::vector<SignaturePart>& parts,
                  std::vector<double>& weights) {
  const auto cost = [&](const std::vector<double>& w) {
    double pull = 0.0;
    for (std::size_t p = 0; p < w.size(); ++p) {
      const double r = std::log((w[p] + kPullOffset) / (priorWeight(parts[p]) + kPullOffset));
      pull += r * r;
    }
    return objective.logLoss(w) + kPull * pull;
  };
  double best = cost(weights);
  for (double factor = 2.0; factor > 1.05;) {
    bool better = false;
    for (std::size_t p = 0; p < weights.size(); ++p) {
      for (const double f : {factor, 1.0 / factor}) {
        std::vector<double> tried = weights;
        tried[p] = std::min(kMaxWeight, tried[p] * f);
        const double c = cost(tried);
        if (c < best - 1e-6) {
          best = c;
          weights = std::move(tried);
          better = true;
          break;
        }
      }
    }
    if (!better) factor = std::sqrt(factor);
  }
}

/// Asks for learned frames while they are left out.
class Examiner {
 public:
  Examiner(const Samples& samples, int places, double beta, const FrameIndex& frames,
           std::vector<PartExemplars>& exemplars)
      : leaving(samples, frames),
        samples_(samples),
        places_(places),
        beta_(beta),
        frames_(frames),
        exemplars_(exemplars) {}

  Question ask(std::size_t frame, const std::vector<char>& blocked) {
    Question question;
    question.place = samples_.places[frames_.begin[frame]];
    const float* part = samples_.row(frames_.begin[frame]);
    for (std::size_t p = 0; p < exemplars_.size(); part += samples_.parts[p].size, ++p) {
      const auto& nearest = exemplars_[p].search(part, &blocked);
      question.nearest.push_back(nearest.empty() ? std::numeric_limits<double>::infinity()
                                                 : nearest.front().distance);
      question.log_likelihoods.emplace_back(static_cast<std::size_t>(places_));
      placeLogLikelihoods(nearest, samples_.places, beta_, question.log_likelihoods.back());
    }
    return question;
  }
  /// Adds a question for each of the frames. @param gap see LeavingOut::blockedFor().
  void askAll(const std::vector<std::size_t>& which, int gap, std::vector<Question>& questions) {
    for (const std::size_t f : which) {
      questions.push_back(ask(f, leaving.blockedFor(f, gap, false)));
    }
  }

  const Samples& samples() const { return samples_; }
  int places() const { return places_; }
  std::size_t frameCount() const { return frames_.count(); }

  LeavingOut leaving;

 private:
  const Samples& samples_;
  int places_;
  double beta_;
  const FrameIndex& frames_;
  std::vector<PartExemplars>& exemplars_;
};

double noveltyOf(const FusionCalibration& c, const std::vector<double>& nearest) {
  double novelty = 0.0, weights = 0.0;
  for (std::size_t p = 0; p < c.parts.size(); ++p) {
    novelty += c.parts[p].weight * std::sqrt(nearest[p] / std::max(1e-12, c.parts[p].median));
    weights += c.parts[p].weight;
  }
  return novelty / std::max(weights, 1e-12);
}

double medianNearest(const std::vector<Question>& questions, std::size_t part) {
  std::vector<double> nearest;
  for (const Question& q : questions) nearest.push_back(q.nearest[part]);
  return std::max(kMinSquaredDistance, quantile(nearest, 0.5));
}

void learnRanges(const std::vector<Question>& questions, FusionCalibration& c) {
  for (std::size_t p = 0; p < c.parts.size(); ++p) {
    double largest = 0.0;
    std::size_t right = 0;
    for (const Question& q : questions) {
      largest = std::max(largest, q.nearest[p]);
      const std::vector<double>& l = q.log_likelihoods[p];
      right += std::max_element(l.begin(), l.end()) - l.begin() == q.place;
    }
    c.parts[p].median = medianNearest(questions, p);
    c.parts[p].largest = std::max(1.05 * c.parts[p].median, largest);
    c.parts[p].accuracy = static_cast<double>(right) / static_cast<double>(questions.size());
  }
}

/// Too few frames to leave tours or stretches out: the distance of each frame to its neighbors
/// still is the unit of novelty. No range is known.
void learnTypicalDistances(Examiner& examiner, FusionCalibration& c) {
  std::vector<std::vector<double>> nearest(c.parts.size());
  std::vector<char> blocked(examiner.frameCount(), 0);
  std::vector<std::size_t> all(examiner.frameCount());
  std::iota(all.begin(), all.end(), 0);
  for (const std::size_t f : thinned(all, kMaxFrames)) {
    blocked[f] = 1;
    const Question q = examiner.ask(f, blocked);
    blocked[f] = 0;
    for (std::size_t p = 0; p < nearest.size(); ++p) {
      if (std::isfinite(q.nearest[p])) nearest[p].push_back(q.nearest[p]);
    }
  }
  for (std::size_t p = 0; p < nearest.size(); ++p) {
    if (!nearest[p].empty()) {
      c.parts[p].median = std::max(kMinSquaredDistance, quantile(nearest[p], 0.5));
    }
  }
}

/// The log loss of the sum as it is made: with the parts that are out of range left out.
class LossByTemperature {
 public:
  LossByTemperature(const std::vector<Question>& questions, int places,
                    const std::vector<SignaturePart>& parts, const FusionCalibration& c)
      : objective_(questions, places),
        weights_(questions.size(), std::vector<double>(parts.size())),
        shares_(weights_) {
    for (std::size_t q = 0; q < questions.size(); ++q) {
      weightsAt(c, questions[q].nearest, weights_[q]);
      shareByRange(c, parts, questions[q].nearest, shares_[q]);
    }
  }
  double at(double temperature, double* accuracy = nullptr) {
    const auto trust = [this](std::size_t q) {
      return Objective::Trust{&weights_[q], &shares_[q]};
    };
    return objective_.logLoss(trust, temperature, accuracy);
  }
  double bestTemperature() {
    double least = std::numeric_limits<double>::infinity(), best = 1.0;
    for (int step = -24; step <= 16; ++step) {
      const double temperature = std::exp2(step / 8.0), loss = at(temperature);
      if (loss < least) {
        least = loss;
        best = temperature;
      }
    }
    return best;
  }

 private:
  Objective objective_;
  std::vector<std::vector<double>> weights_, shares_;
};

std::vector<double> learnedWeights(const std::vector<Question>& questions,
                                   const Examiner& examiner) {
  const std::vector<SignaturePart>& parts = examiner.samples().parts;
  std::vector<double> weights;
  for (const SignaturePart& part : parts) weights.push_back(priorWeight(part));
  Objective objective(questions, examiner.places());
  learnWeights(objective, parts, weights);
  return weights;
}

/// The weights for frames that lie as far from learned ones as `questions`, which left out the most
/// that can be left out, and the range of each part.
void learnFar(const std::vector<Question>& questions, const Examiner& examiner,
              FusionCalibration& c) {
  const std::vector<double> weights = learnedWeights(questions, examiner);
  for (std::size_t p = 0; p < c.parts.size(); ++p) c.parts[p].weight = weights[p];
  learnRanges(questions, c);
}

/// The weights for frames that lie as near as the next one. How sure the sum is to be is the
/// temperature's matter: they only share out the sum of the far ones anew.
void learnNear(Examiner& examiner, FusionCalibration& c) {
  std::vector<Question> next;
  for (const int gap : kNextFrames) {
    examiner.askAll(thinned(examiner.leaving.askable(gap), kMaxFrames / 2), gap, next);
  }
  std::vector<double> weights = learnedWeights(next, examiner);
  double far_sum = 0.0;
  for (const PartCalibration& part : c.parts) far_sum += part.weight;
  const double scale = far_sum / std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& w : weights) w = std::min(kMaxWeight, scale * w);
  for (std::size_t p = 0; p < c.parts.size(); ++p) {
    c.parts[p].near_weight = weights[p];
    c.parts[p].near_median = medianNearest(next, p);
  }
}

/// How sure the sum is to be, and how good it is then. @param gap that `questions` left out.
void learnTemperature(const std::vector<Question>& questions, int gap, Examiner& examiner,
                      FusionCalibration& c) {
  const std::vector<SignaturePart>& parts = examiner.samples().parts;
  std::vector<Question> nearer = questions;
  for (const int frames_left_out : kGaps) {
    if (frames_left_out == gap) continue;
    examiner.askAll(thinned(examiner.leaving.askable(frames_left_out), kMaxFrames), frames_left_out,
                    nearer);
  }
  c.temperature =
      kLaterTours * LossByTemperature(nearer, examiner.places(), parts, c).bestTemperature();
  c.log_loss =
      LossByTemperature(questions, examiner.places(), parts, c).at(c.temperature, &c.accuracy);
}

/// From which novelty on a place is unknown, and how often that notices an unknown one.
/// @param asked the frames of `questions`, which left out `gap`.
void learnNovelty(const std::vector<Question>& questions, const std::vector<std::size_t>& asked,
                  int gap, Examiner& examiner, FusionCalibration& c) {
  std::vector<double> novelties;
  for (const Question& q : questions) novelties.push_back(noveltyOf(c, q.nearest));
  c.unknown_novelty = quantile(novelties, 1.0 - kUnknownRate);
  std::size_t noticed = 0, strangers = 0;
  for (const std::size_t f : thinned(asked, kMaxFrames / 4)) {
    const Question q = examiner.ask(f, examiner.leaving.blockedFor(f, gap, true));
    if (std::isinf(q.nearest.front())) continue;  // no other place was learned
    ++strangers;
    noticed += noveltyOf(c, q.nearest) > c.unknown_novelty;
  }
  if (strangers > 0) {
    c.unknown_noticed = static_cast<double>(noticed) / static_cast<double>(strangers);
  }
}

}  // namespace

void placeLogLikelihoods(const std::vector<Neighbor>& nearest, const std::vector<int>& labels,
                         double beta, std::vector<double>& out) {
  std::fill(out.begin(), out.end(), 0.0);
  double sum = 0.0;
  if (!nearest.empty()) {
    const double least =
        std::max(kMinSquaredDistance, static_cast<double>(nearest.front().distance));
    for (const Neighbor& n : nearest) {
      const double w = std::exp(-beta * std::max(0.0, n.distance - least) / least);
      out[static_cast<std::size_t>(labels[n.sample])] += w;
      sum += w;
    }
  }
  const double places = static_cast<double>(out.size());
  for (double& p : out) {
    p = std::log(((sum > 0.0 ? p / sum : 1.0 / places) + kFloor) / (1.0 + kFloor * places));
  }
}

void weightsAt(const FusionCalibration& calibration, const std::vector<double>& nearest,
               std::vector<double>& weights) {
  // Where the parts lie, 0 as near as the next frame, 1 as far as another tour: for now in
  // `weights`, since no memory is to be allocated for a frame.
  std::size_t known = 0;
  for (std::size_t p = 0; p < nearest.size(); ++p) {
    const PartCalibration& part = calibration.parts[p];
    if (part.near_median <= 0.0 || part.median <= 0.0) continue;
    const double span = std::log(part.median / part.near_median);
    if (span < kLeastSpan) continue;
    weights[known++] =
        std::log(std::max(kMinSquaredDistance, nearest[p]) / part.near_median) / span;
  }
  double far = 1.0;
  if (known > 0) {
    const auto begin = weights.begin(),
               middle = begin + static_cast<std::ptrdiff_t>((known - 1) / 2);
    std::nth_element(begin, middle, begin + static_cast<std::ptrdiff_t>(known));
    far = std::clamp(*middle, 0.0, 1.0);
  }
  for (std::size_t p = 0; p < nearest.size(); ++p) {
    const PartCalibration& part = calibration.parts[p];
    weights[p] = std::pow(part.weight, far) * std::pow(part.near_weight, 1.0 - far);
  }
}

double rangeShare(const PartCalibration& part, double nearest) {
  if (std::isinf(part.largest)) return 1.0;
  return std::clamp((part.largest - nearest) / (part.largest - part.median), 0.0, 1.0);
}

void shareByRange(const FusionCalibration& calibration, const std::vector<SignaturePart>& parts,
                  const std::vector<double>& nearest, std::vector<double>& shares) {
  double least_color = 1.0, most = 0.0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    shares[p] = rangeShare(calibration.parts[p], nearest[p]);
    if (parts[p].absolute_color) least_color = std::min(least_color, shares[p]);
  }
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].absolute_color) shares[p] = least_color;
    most = std::max(most, shares[p]);
  }
  if (most <= 0.0) std::fill(shares.begin(), shares.end(), kLittle);
}

double evidenceScale(double weights, double asked) {
  return asked > kLittle * weights * 1.5 ? std::min(kMaxEvidenceScale, weights / asked) : 1.0;
}

FusionCalibration calibrateFusion(const Samples& samples, int places, double beta,
                                  const FrameIndex& frames, std::vector<PartExemplars>& exemplars) {
  FusionCalibration c;
  c.parts.resize(samples.parts.size());
  for (std::size_t p = 0; p < c.parts.size(); ++p) {
    c.parts[p].weight = c.parts[p].near_weight = priorWeight(samples.parts[p]);
  }
  Examiner examiner(samples, places, beta, frames, exemplars);
  int gap = LeavingOut::kWholeTour;
  std::vector<std::size_t> asked = examiner.leaving.askable(gap);
  if (static_cast<double>(asked.size()) < kLeastShare * static_cast<double>(frames.count())) {
    gap = kStretch;
    asked = examiner.leaving.askable(gap);
  }
  if (asked.size() < kLeastFrames) {
    learnTypicalDistances(examiner, c);
    for (std::size_t p = 0; p < c.parts.size(); ++p) {
      if (samples.parts[p].learned_elsewhere) c.parts[p].weight = c.parts[p].near_weight = 0.0;
    }
    return c;
  }
  c.left_out = gap == LeavingOut::kWholeTour ? "tours" : "stretches";
  asked = thinned(asked, kMaxFrames);
  c.frames = asked.size();
  std::vector<Question> questions;
  examiner.askAll(asked, gap, questions);
  learnFar(questions, examiner, c);
  learnNear(examiner, c);
  learnTemperature(questions, gap, examiner, c);
  learnNovelty(questions, asked, gap, examiner, c);
  return c;
}

std::string toText(const FusionCalibration& c, const std::vector<SignaturePart>& parts) {
  json j = {{"left_out", c.left_out},
            {"frames", c.frames},
            {"temperature", c.temperature},
            {"accuracy", c.accuracy},
            {"log_loss", c.log_loss},
            {"unknown_novelty", c.unknown_novelty},
            {"unknown_noticed", c.unknown_noticed},
            {"parts", json::array()}};
  for (std::size_t p = 0; p < parts.size(); ++p) {
    json part = {{"name", parts[p].name},
                 {"size", parts[p].size},
                 {"weight", c.parts[p].weight},
                 {"accuracy", c.parts[p].accuracy},
                 {"median", c.parts[p].median},
                 {"near_weight", c.parts[p].near_weight},
                 {"near_median", c.parts[p].near_median}};
    part["largest"] = std::isinf(c.parts[p].largest) ? json(nullptr) : json(c.parts[p].largest);
    j["parts"].push_back(part);
  }
  return j.dump();
}

FusionCalibration fusionCalibrationFromText(const std::string& text,
                                            const std::vector<SignaturePart>& parts) {
  try {
    const json j = json::parse(text);
    const auto number = [](const json& from, const char* name, double low, double high) {
      const double value = from.at(name).get<double>();
      if (!(value >= low && value <= high)) {
        throw hyselam::InputError("fusion", name, "is out of range");
      }
      return value;
    };
    constexpr double kMost = 1e12;
    FusionCalibration c;
    c.left_out = j.at("left_out").get<std::string>();
    c.frames = static_cast<std::size_t>(number(j, "frames", 0.0, 1e9));
    c.temperature = number(j, "temperature", 1e-3, 1e3);
    c.accuracy = number(j, "accuracy", 0.0, 1.0);
    c.log_loss = number(j, "log_loss", 0.0, kMost);
    c.unknown_novelty = number(j, "unknown_novelty", 0.0, kMost);
    c.unknown_noticed = number(j, "unknown_noticed", 0.0, 1.0);
    if (j.at("parts").size() != parts.size()) {
      throw hyselam::InputError("fusion", "parts", "are not those of the descriptor");
    }
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const json& part = j.at("parts").at(p);
      if (part.at("name").get<std::string>() != parts[p].name) {
        throw hyselam::InputError("fusion", "parts", "are not those of the descriptor");
      }
      PartCalibration calibration;
      calibration.weight = number(part, "weight", 0.0, kMaxWeight);
      calibration.accuracy = number(part, "accuracy", 0.0, 1.0);
      calibration.median = number(part, "median", 0.0, kMost);
      // Older models have one weight.
      if (part.contains("near_weight") != part.contains("near_median")) {
        throw hyselam::InputError("fusion", "near_weight, near_median",
                                  "one is there without the other");
      }
      calibration.near_weight = part.contains("near_weight")
                                    ? number(part, "near_weight", 0.0, kMaxWeight)
                                    : calibration.weight;
      calibration.near_median =
          part.contains("near_median") ? number(part, "near_median", 0.0, kMost) : 0.0;
      if (!part.at("largest").is_null()) {
        calibration.largest = number(part, "largest", 0.0, kMost);
        if (calibration.largest <= calibration.median) {
          throw hyselam::InputError("fusion", "largest", "is not above the median");
        }
      }
      c.parts.push_back(calibration);
    }
    return c;
  } catch (const json::exception& e) {
    throw hyselam::InputError("fusion", "", std::string("is no calibration: ") + e.what());
  }
}

}  // namespace selovis
