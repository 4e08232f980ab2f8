#include "ngram_slam/matching/ngram_recognizer.hpp"

#include <algorithm>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

void NgramRecognizerParams::validate() const {
  const WordLattice level_check(levels);
  const DensityRegionBuilder region_check(min_region);
  mean_shift.validate();
  judge.validate();
  matcher.validate();
  const DensityClasses class_check = DensityClasses::uniform(uniform_classes);
  if (!(class_hysteresis >= 0.0 && class_hysteresis < 0.5))
    throw hyselam::ParameterError("class_hysteresis", class_hysteresis, "in [0, 0.5)");
  if (!(max_chance >= 0.0)) throw hyselam::ParameterError("max_chance", max_chance, ">= 0");
  if (!(min_probability >= 0.0 && min_probability <= 1.0))
    throw hyselam::ParameterError("min_probability", min_probability, "in [0, 1]");
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

void NgramRecognizer::startAnew() {
  judged_ = 0;
  text_ =
      std::make_unique<WordLattice>(params_.levels, [this](std::uint32_t begin, std::uint32_t end) {
        return angleVariation(observations_, begin, end);
      });
  matcher_ = std::make_unique<NgramMatcher>(*text_, params_.matcher);
  judge_ = std::make_unique<MatchConfidence>(*text_, observations_, params_.matcher.tolerance,
                                             params_.word_density, params_.judge);
  if (params_.reverse)
    reverse_matcher_ = std::make_unique<ReverseNgramMatcher>(*text_, params_.matcher);
}

/// Writes the text of all observations again.
std::vector<NgramMatch> NgramRecognizer::rebuild(bool match_old_runs) {
  startAnew();
  for (std::uint32_t run = 0; run < observations_.runs(); ++run) {
    const std::uint32_t begin = observations_.runBegin(run), end = observations_.runEnd(run);
    startRun(begin);
    for (std::uint32_t i = begin; i < end; ++i)
      if (const auto region = regions_.add(classOf(i))) write(*region);
    if (run_open_ && run + 1 == observations_.runs()) break;
    if (const auto region = regions_.finish()) write(*region);
  }
  if (match_old_runs) return newMatches();
  matcher_->skip();
  if (reverse_matcher_) reverse_matcher_->skip();
  judge({});
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
  return judge(std::move(matches));
}

/// What chance and probability leave of the matches of the newest words, given in the order of
/// these.
std::vector<NgramMatch> NgramRecognizer::judge(std::vector<NgramMatch> matches) {
  if (!params_.judges()) return matches;
  auto at = matches.begin();
  for (; judged_ < text_->positions(); ++judged_) {
    for (; at != matches.end() && at->newer == text_->realWord(judged_); ++at)
      judge_->judge(*at, params_.with_probability || params_.min_probability > 0.0);
    judge_->learn(judged_);
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
         (reverse_matcher_ ? reverse_matcher_->bytes() : 0) + judge_->bytes();
}

Corpus NgramRecognizer::corpus() const {
  return {observations_, classes(),
          params_.learn_classes ? quantizer_.histogram() : DensityHistogram{}};
}

}  // namespace ngram_slam
