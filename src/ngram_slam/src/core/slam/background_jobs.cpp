#include "ngram_slam/slam/background_jobs.hpp"

#include <algorithm>

namespace ngram_slam {

bool BackgroundJobs::counts(double stamp) const {
  if (!isOut()) return false;
  if (!last_scan_ || stamp < *last_scan_ || stamp - *last_scan_ >= kPause) return true;
  return stamp - made_ >= latency_;
}

void BackgroundJobs::applyResult(SlamEngine* engine) {
  const SlamJobResult result = *std::exchange(result_, std::nullopt);
  engine->apply(result);
}

void BackgroundJobs::makeJob(double stamp, SlamEngine* engine) {
  // With a latency each job costs as much, whatever is in it.
  waiting_ = latency_ > 0.0 ? engine->takeAllWork() : engine->takeJob();
  made_ = stamp;
}

bool BackgroundJobs::takeIn(double stamp, SlamEngine* engine) {
  if (!isOut() && !last_scan_) makeJob(stamp, engine);  // of a saved map
  while (counts(stamp)) {
    if (!result_) return false;
    applyResult(engine);
    makeJob(stamp, engine);
  }
  return true;
}

void BackgroundJobs::noteScan(double stamp, SlamEngine* engine) {
  last_scan_ = stamp;
  if (isOut()) {
    made_ = std::min(made_, stamp);  // time has gone back: it does not wait until it was made again
  } else {
    makeJob(stamp, engine);
  }
}

bool BackgroundJobs::takeInNow(SlamEngine* engine) {
  if (waiting_ || running_) return false;
  const bool applied = result_.has_value();
  if (applied) applyResult(engine);
  makeJob(last_scan_.value_or(0.0), engine);
  return applied || waiting_;
}

std::optional<SlamJob> BackgroundJobs::begin() {
  running_ = running_ || waiting_;
  return std::exchange(waiting_, std::nullopt);
}

void BackgroundJobs::finish(SlamJobResult result) {
  running_ = false;
  result_ = std::move(result);
}

void BackgroundJobs::runHere() {
  if (const auto job = begin()) finish(runJob(*job));
}

void BackgroundJobs::runAll(SlamEngine* engine) {
  runHere();
  while (takeInNow(engine)) runHere();
}

}  // namespace ngram_slam
