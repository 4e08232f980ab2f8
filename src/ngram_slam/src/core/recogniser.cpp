#include "ngram_slam/recogniser.hpp"

#include <utility>

namespace ngram_slam {

void RecogniserParams::validate() const {
  const Text level_check(levels);
  const RegionBuilder region_check(min_region);
  mean_shift.validate();
  matcher.validate();
  const DensityClasses class_check = DensityClasses::uniform(uniform_classes);
}

Recogniser::Recogniser(const RecogniserParams& params) : Recogniser(params, Corpus{}) {}

Recogniser::Recogniser(const RecogniserParams& params, Corpus corpus)
    : params_((params.validate(), params)),
      observations_(std::move(corpus.observations)),
      fixed_classes_(DensityClasses::uniform(params.uniform_classes)),
      quantizer_(params.mean_shift),
      regions_(params.min_region) {
  if (params_.learn_classes) {
    if (!corpus.histogram.empty()) {
      quantizer_.restore(corpus.classes, corpus.histogram);
    } else {
      for (std::uint32_t i = 0; i < observations_.size(); ++i)
        quantizer_.add(observations_.soft(i));
    }
  }
  rebuild(false);
}

void Recogniser::startAnew() {
  text_ = std::make_unique<Text>(params_.levels, [this](std::uint32_t begin, std::uint32_t end) {
    return angleVariation(observations_, begin, end);
  });
  matcher_ = std::make_unique<Matcher>(*text_, params_.matcher);
}

/// Writes the text of all observations again.
std::vector<Match> Recogniser::rebuild(bool match_old_runs) {
  startAnew();
  for (std::uint32_t run = 0; run < observations_.runs(); ++run) {
    const std::uint32_t begin = observations_.runBegin(run), end = observations_.runEnd(run);
    regions_ = RegionBuilder(params_.min_region, begin);
    text_->startRun(begin);
    for (std::uint32_t i = begin; i < end; ++i)
      if (const auto region = regions_.add(classes().classOf(observations_.soft(i))))
        write(*region);
    if (run_open_ && run + 1 == observations_.runs()) break;
    if (const auto region = regions_.finish()) write(*region);
  }
  if (match_old_runs) return matcher_->update();
  matcher_->skip();
  return {};
}

void Recogniser::write(const Region& region) {
  text_->push({region.density_class, region.size(),
               static_cast<float>(angleVariation(observations_, region.begin, region.end))});
}

RecogniserUpdate Recogniser::add(const Observation& observation) {
  if (!run_open_) observations_.startRun();
  const std::uint32_t at = observations_.append(observation);
  if (!run_open_) {
    run_open_ = true;
    regions_ = RegionBuilder(params_.min_region, at);
    text_->startRun(at);
  }
  RecogniserUpdate update;
  if (params_.learn_classes && quantizer_.add(observations_.soft(at))) {
    ++requantisations_;
    update.requantised = true;
    const Position before = text_->positions();
    update.matches = rebuild(true);
    update.word = text_->positions() != before;
    return update;
  }
  const auto region = regions_.add(classes().classOf(observations_.soft(at)));
  if (!region) return update;
  write(*region);
  update.word = true;
  update.matches = matcher_->update();
  return update;
}

RecogniserUpdate Recogniser::endRun() {
  RecogniserUpdate update;
  if (!run_open_) return update;
  run_open_ = false;
  if (const auto region = regions_.finish()) {
    write(*region);
    update.word = true;
    update.matches = matcher_->update();
  }
  return update;
}

Corpus Recogniser::corpus() const {
  return {observations_, classes(), params_.learn_classes ? quantizer_.histogram() : Histogram{}};
}

}  // namespace ngram_slam
