// When the results of the engine's jobs count: at scans that their stamps tell, so that equal scans
// give equal maps, offline and live, however busy the machine is.
#pragma once

#include <optional>
#include <utility>

#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

/// The jobs of an engine, one at a time. A result counts at the first scan that was taken `latency`
/// after the one before which, or behind which, its job was made; at once before the first scan,
/// after a pause, and where time goes back. Not thread-safe: with a thread for the jobs, all but
/// runJob() is called with a lock held.
///
///   while (!jobs.takeIn(scan.stamp, &engine)) jobs.runHere();  // or wait for the other thread
///   engine.add(scan, odometry);
///   jobs.noteScan(scan.stamp, &engine);
class BackgroundJobs {
 public:
  /// After so long without a scan [s] work counts as soon as it is done.
  static constexpr double kPause = 5.0;

  /// `latency` [s]: SlamParams::loop_latency.
  explicit BackgroundJobs(double latency) : latency_(latency) {}

  /// Before a scan of this stamp is added: applies what counts from it on. False: a result counts
  /// that is not there. Either this is called again when it is, or the scan is added without it.
  bool takeIn(double stamp, SlamEngine* engine);
  /// After a scan has been added.
  void noteScan(double stamp, SlamEngine* engine);
  /// Without a scan: applies a result that is there, and makes the next job. False: nothing to do,
  /// or a job is out.
  bool takeInNow(SlamEngine* engine);

  /// A job that nobody has begun; it is out until finish().
  std::optional<SlamJob> begin();
  void finish(SlamJobResult result);
  /// Runs the job that nobody has begun, if there is one.
  void runHere();
  /// Runs and applies all there is to do.
  void runAll(SlamEngine* engine);

  /// A job waits to be begun, is being run, or its result has not been applied.
  bool isOut() const { return waiting_ || running_ || result_; }

 private:
  bool counts(double stamp) const;
  void applyResult(SlamEngine* engine);
  void makeJob(double stamp, SlamEngine* engine);

  double latency_;
  std::optional<SlamJob> waiting_;
  bool running_ = false;
  std::optional<SlamJobResult> result_;
  double made_ = 0.0;                // stamp of the scan at which the job that is out was made
  std::optional<double> last_scan_;  // stamp
};

}  // namespace ngram_slam
