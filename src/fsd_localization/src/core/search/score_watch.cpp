#include "fsd_localization/search/score_watch.hpp"

namespace fsd_localization {

namespace {
constexpr double kMemory = 1.0 / 30;  // weight of a look in the usual score: 30 m
}  // namespace

void ScoreWatch::look(double way, double score) {
  looked_at_ = way;
  const double usual = usual_.value_or(score);
  worse_ = score < usual - kWorse;
  usual_ = usual + kMemory * (score - usual);
}

void ScoreWatch::reset() {
  usual_.reset();
  worse_ = false;
}

}  // namespace fsd_localization
