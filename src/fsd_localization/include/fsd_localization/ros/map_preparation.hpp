// Makes localisers out of maps in a thread of its own: density fields of a large map take seconds,
// and nothing else may wait for them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "fsd_localization/localizer.hpp"

namespace fsd_localization {

/// Safe to call from any thread. The newest map wins: one that waits is replaced, one that is being
/// prepared is finished and thrown away.
class MapPreparation {
 public:
  /// Brings the map, in the thread of the preparation; empty when `cancelled()` became true
  /// meanwhile. What it throws becomes Outcome::error.
  using Source =
      std::function<std::optional<hyselam::OccupancyGrid>(const std::function<bool()>& cancelled)>;
  struct Outcome {
    std::unique_ptr<Localizer> localizer;  ///< null: the map cannot be used
    std::string error;
    double seconds = 0.0;
    bool cached = false;
    std::string cache_problem;  ///< why the density fields could not be kept; empty: they were
  };

  /// @param cache_dir keeps density fields, one file per map and parameters; empty: nowhere.
  MapPreparation(const LocalizerParams& params, const std::string& cache_dir);
  /// Waits until the preparation has ended.
  ~MapPreparation();

  void start(Source source);
  /// For the next start().
  void setParams(const LocalizerParams& params);
  /// The newest finished map, once.
  std::optional<Outcome> take();
  bool busy() const;
  /// Progress of the preparation, 0..1.
  double progress() const { return progress_; }

 private:
  void run();
  Outcome prepare(const Source& source, const LocalizerParams& params);
  bool superseded() const;

  LocalizerParams params_;
  std::string cache_dir_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Source next_;
  bool working_ = false;
  bool stop_ = false;
  std::optional<Outcome> done_;
  std::atomic<double> progress_{0.0};
  std::thread thread_;
};

}  // namespace fsd_localization
