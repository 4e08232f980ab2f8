#include "ngram_slam/slam/word_places.hpp"

#include <utility>

#include "ngram_slam/matching/match_place.hpp"

namespace ngram_slam {

WordPlaces::WordPlaces(const ObservationSensorParams& sensor, const NgramRecognizerParams& words,
                       Corpus corpus)
    : sensor_(sensor), recogniser_(std::make_unique<NgramRecognizer>(words, std::move(corpus))) {}

WordPlaces::Update WordPlaces::add(const hyselam::LaserScan& scan, const hyselam::Pose2& base) {
  Update update;
  take(sensor_.add(scan, base), &update);
  return update;
}

WordPlaces::Update WordPlaces::finish() {
  Update update;
  take(sensor_.finish(), &update);
  note(recogniser_->endRun(), &update);
  last_.reset();
  return update;
}

void WordPlaces::take(const std::vector<DensityObservation>& seen, Update* update) {
  for (const DensityObservation& o : seen) {
    if (last_ && leapt(*last_, o)) note(recogniser_->endRun(), update);
    note(recogniser_->add(o), update);
    update->stamps.push_back(o.stamp);
    last_ = o;
  }
}

void WordPlaces::note(const NgramRecognizerUpdate& u, Update* update) {
  if (u.requantised) {
    update->requantised = true;
    update->matches.clear();
  }
  const ObservationStore& observations = recogniser_->observations();
  for (const NgramMatch& m : u.matches) {
    const auto place = placeOf(*recogniser_, m);
    if (!place) continue;
    SlamMatch match;
    match.newer = place->newer;
    match.older = place->older;
    match.stamp_newer = observations.stamp(place->newer);
    match.stamp_older = observations.stamp(place->older);
    match.level = m.levels - 1;
    match.n = m.n;
    match.direction = m.direction;
    match.probability = m.probability;
    update->matches.push_back(match);
  }
}

}  // namespace ngram_slam
