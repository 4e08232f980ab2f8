#include "ngram_slam/slam/word_places.hpp"

#include <utility>

#include "ngram_slam/matching/match_place.hpp"

namespace ngram_slam {

WordPlaces::WordPlaces(const ObservationSensorParams& sensor, const NgramRecognizerParams& words,
                       Corpus corpus)
    : sensor_(sensor), recognizer_(std::make_unique<NgramRecognizer>(words, std::move(corpus))) {}

WordPlaces::Update WordPlaces::add(const hyselam::LaserScan& scan, const hyselam::Pose2& base) {
  Update update;
  addObservations(sensor_.add(scan, base), &update);
  return update;
}

WordPlaces::Update WordPlaces::finish() {
  Update update;
  addObservations(sensor_.finish(), &update);
  addMatches(recognizer_->endRun(), &update);
  last_.reset();
  return update;
}

void WordPlaces::addObservations(const std::vector<DensityObservation>& observations,
                                 Update* update) {
  for (const DensityObservation& o : observations) {
    if (last_ && odometryJumped(*last_, o)) addMatches(recognizer_->endRun(), update);
    addMatches(recognizer_->add(o), update);
    update->stamps.push_back(o.stamp);
    last_ = o;
  }
}

void WordPlaces::addMatches(const NgramRecognizerUpdate& recognized, Update* update) {
  if (recognized.requantised) {
    update->requantized = true;
    update->matches.clear();
  }
  const ObservationStore& observations = recognizer_->observations();
  for (const NgramMatch& m : recognized.matches) {
    const auto place = placeOf(*recognizer_, m);
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
