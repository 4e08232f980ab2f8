#include "ngram_slam/matching/ngram_recognizer.hpp"

#include <algorithm>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

void NgramRecognizerParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("levels", levels, Range::between(1, WordLattice::kMaxLevels), "", "levels of words");
  // What is not given for the levels depends on their number.
  fitMinN();
  visit.group("", matcher, {{"index_gram", visit.kNotOffered}, {"index_bits", visit.kNotOffered}});
  visit("min_region", min_region, Range::between(1, 10000), "observations",
        "t_o: smallest length of a region");
  visit("uniform_classes", uniform_classes, Range::between(1, WordLattice::kMaxClasses), "",
        "density classes of equal width");
  visit("learn_classes", learn_classes, "density classes by mean shift instead");
  visit("class_hysteresis", class_hysteresis, Range::fromBelow(0.0, 0.5), "",
        "a class is kept while the density lies within this of its bounds");
  visit("word_density", word_density, {{"soft", WordDensity::kSoft}, {"full", WordDensity::kFull}},
        "density that words are made of");
  visit("reverse", reverse, "also recognize places travelled in the reverse direction");
  visit("max_chance", max_chance, Range::atLeast(0.0), "",
        "matches with fewer expected by chance are accepted whatever their length; 0: off");
  visit("with_probability", with_probability, "estimate the probability that a match is right");
  visit("min_probability", min_probability, Range::between(0.0, 1.0), "",
        "of a match that is accepted");
}

void NgramRecognizerParams::validate() const {
  hyselam::checkParameters(*this);
  if (matcher.min_n.size() != static_cast<std::size_t>(levels)) {
    throw hyselam::ParameterError("min_n", std::to_string(matcher.min_n.size()) + " numbers",
                                  "one per level, " + std::to_string(levels));
  }
  mean_shift.validate();
  confidence.validate();
  matcher.validate();
}

/// As many numbers as levels: each further level asks for three words more, as 7, 10, 13 do, or
/// for as many where all levels ask for the same.
void NgramRecognizerParams::fitMinN() {
  std::vector<int>& min_n = matcher.min_n;
  if (min_n.empty() || levels < 1 || levels > WordLattice::kMaxLevels) return;
  const int step = min_n.back() > min_n.front() ? kMinNStep : 0;
  while (min_n.size() < static_cast<std::size_t>(levels)) min_n.push_back(min_n.back() + step);
  min_n.resize(static_cast<std::size_t>(levels));
}

NgramRecognizerParams NgramRecognizerParams::improved() {
  NgramRecognizerParams p;
  p.word_density = WordDensity::kFull;
  p.reverse = true;
  p.matcher.min_n.assign(static_cast<std::size_t>(p.levels), 3);
  p.with_probability = true;
  p.min_probability = 0.75;
  return p;
}

NgramRecognizer::NgramRecognizer(const NgramRecognizerParams& params)
    : NgramRecognizer(params, Corpus{}) {}

NgramRecognizer::NgramRecognizer(const NgramRecognizerParams& params, Corpus corpus)
    : params_((params.validate(), params)),
      observations_(std::move(corpus.observations)),
      fixed_classes_(DensityClasses::uniform(params.uniform_classes)),
      quantizer_(params.mean_shift),
      regions_(params.min_region) {
  if (params_.learn_classes) {
    if (!corpus.histogram.empty()) {
      quantizer_.restore(corpus.classes, corpus.histogram);
    } else {
      for (std::uint32_t i = 0; i < observations_.size(); ++i) quantizer_.add(densityOf(i));
    }
  }
  rebuild(false);
}

void NgramRecognizer::reset() {
  learnt_ = 0;
  text_ =
      std::make_unique<WordLattice>(params_.levels, [this](std::uint32_t begin, std::uint32_t end) {
        return angleVariation(observations_, begin, end);
      });
  matcher_ = std::make_unique<NgramMatcher>(*text_, params_.matcher);
  confidence_ = std::make_unique<MatchConfidence>(*text_, observations_, params_.matcher.tolerance,
                                                  params_.word_density, params_.confidence);
  if (params_.reverse) {
    reverse_matcher_ = std::make_unique<ReverseNgramMatcher>(*text_, params_.matcher);
  }
}

/// Writes the text of all observations again.
std::vector<NgramMatch> NgramRecognizer::rebuild(bool match_old_runs) {
  reset();
  for (std::uint32_t run = 0; run < observations_.runs(); ++run) {
    const std::uint32_t begin = observations_.runBegin(run), end = observations_.runEnd(run);
    startRun(begin);
    for (std::uint32_t i = begin; i < end; ++i) {
      if (const auto region = regions_.add(classOf(i))) write(*region);
    }
    if (run_open_ && run + 1 == observations_.runs()) break;
    if (const auto region = regions_.finish()) write(*region);
  }
  if (match_old_runs) return newMatches();
  matcher_->skip();
  if (reverse_matcher_) reverse_matcher_->skip();
  withConfidence({});
  return {};
}

std::vector<NgramMatch> NgramRecognizer::newMatches() {
  std::vector<NgramMatch> matches = matcher_->update();
  if (reverse_matcher_) {
    const std::vector<NgramMatch>& more = reverse_matcher_->update();
    matches.insert(matches.end(), more.begin(), more.end());
    std::stable_sort(matches.begin(), matches.end(),
                     [](const NgramMatch& a, const NgramMatch& b) { return a.newer < b.newer; });
  }
  return withConfidence(std::move(matches));
}

/// What chance and probability leave of the matches of the newest words, given in the order of
/// these.
std::vector<NgramMatch> NgramRecognizer::withConfidence(std::vector<NgramMatch> matches) {
  if (!params_.needsConfidence()) return matches;
  auto at = matches.begin();
  for (; learnt_ < text_->positions(); ++learnt_) {
    for (; at != matches.end() && at->newer == text_->realWord(learnt_); ++at) {
      confidence_->estimate(*at, params_.with_probability || params_.min_probability > 0.0);
    }
    confidence_->learn(learnt_);
  }
  const auto unlikely = [&](const NgramMatch& m) {
    return (params_.max_chance > 0.0 && m.chance >= params_.max_chance) ||
           (params_.min_probability > 0.0 && m.probability < params_.min_probability);
  };
  matches.erase(std::remove_if(matches.begin(), matches.end(), unlikely), matches.end());
  return matches;
}

void NgramRecognizer::startRun(std::uint32_t first_observation) {
  regions_ = DensityRegionBuilder(params_.min_region, first_observation);
  text_->startRun(first_observation);
  last_class_.reset();
}

int NgramRecognizer::classOf(std::uint32_t i) {
  const double density = densityOf(i);
  last_class_ = last_class_ && params_.class_hysteresis > 0.0
                    ? classes().classOf(density, *last_class_, params_.class_hysteresis)
                    : classes().classOf(density);
  return *last_class_;
}

void NgramRecognizer::write(const DensityRegion& region) {
  text_->push({region.density_class, region.size(),
               static_cast<float>(angleVariation(observations_, region.begin, region.end))});
}

NgramRecognizerUpdate NgramRecognizer::add(const DensityObservation& observation) {
  if (!run_open_) observations_.startRun();
  const std::uint32_t at = observations_.append(observation);
  if (!run_open_) {
    run_open_ = true;
    startRun(at);
  }
  NgramRecognizerUpdate update;
  if (params_.learn_classes && quantizer_.add(densityOf(at))) {
    ++requantisations_;
    update.requantised = true;
    const Position before = text_->positions();
    update.matches = rebuild(true);
    update.word = text_->positions() != before;
    return update;
  }
  const auto region = regions_.add(classOf(at));
  if (!region) return update;
  write(*region);
  update.word = true;
  update.matches = newMatches();
  return update;
}

NgramRecognizerUpdate NgramRecognizer::endRun() {
  NgramRecognizerUpdate update;
  if (!run_open_) return update;
  run_open_ = false;
  if (const auto region = regions_.finish()) {
    write(*region);
    update.word = true;
    update.matches = newMatches();
  }
  return update;
}

std::size_t NgramRecognizer::bytes() const {
  return observations_.bytes() + text_->bytes() + matcher_->bytes() +
         (reverse_matcher_ ? reverse_matcher_->bytes() : 0) + confidence_->bytes();
}

Corpus NgramRecognizer::corpus() const {
  return {observations_, classes(),
          params_.learn_classes ? quantizer_.histogram() : DensityHistogram{}};
}

}  // namespace ngram_slam
