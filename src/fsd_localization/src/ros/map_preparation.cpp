#include "fsd_localization/ros/map_preparation.hpp"

#include <chrono>
#include <cstdio>
#include <new>

namespace fsd_localization {

MapPreparation::MapPreparation(const LocalizerParams& params, const std::string& cache_dir)
    : params_(params), cache_dir_(cache_dir), thread_([this] { run(); }) {}

MapPreparation::~MapPreparation() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void MapPreparation::start(Source source) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    next_ = std::move(source);
    done_.reset();
  }
  wake_.notify_all();
}

void MapPreparation::setParams(const LocalizerParams& params) {
  const std::lock_guard<std::mutex> lock(mutex_);
  params_ = params;
}

std::optional<MapPreparation::Outcome> MapPreparation::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::optional<Outcome> outcome = std::move(done_);
  done_.reset();
  return outcome;
}

bool MapPreparation::busy() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return working_ || next_ || done_;
}

bool MapPreparation::superseded() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return stop_ || next_;
}

void MapPreparation::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stop_ || next_; });
    if (stop_) return;
    const Source source = std::move(next_);
    const LocalizerParams params = params_;
    next_ = nullptr;
    working_ = true;
    progress_ = 0.0;
    lock.unlock();
    Outcome outcome = prepare(source, params);
    lock.lock();
    working_ = false;
    if (!next_ && !stop_) done_ = std::move(outcome);
  }
}

MapPreparation::Outcome MapPreparation::prepare(const Source& source,
                                                const LocalizerParams& params) {
  Outcome outcome;
  try {
    const std::optional<hyselam::OccupancyGrid> map = source([this] { return superseded(); });
    if (!map) return outcome;
    const auto begin = std::chrono::steady_clock::now();
    std::string cache;
    if (!cache_dir_.empty()) {
      char name[32];
      std::snprintf(name, sizeof name, "/%016llx.fsd",
                    static_cast<unsigned long long>(FsdMap::fingerprint(*map, params.map)));
      cache = cache_dir_ + name;
    }
    outcome.localizer = std::make_unique<Localizer>(*map, params, cache,
                                                    [this](double share) { progress_ = share; });
    outcome.cached = outcome.localizer->mapWasCached();
    outcome.cache_problem = outcome.localizer->mapCacheProblem();
    outcome.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  } catch (const std::bad_alloc&) {
    outcome.error = "not enough memory for this map";
  } catch (const std::exception& e) {
    outcome.error = e.what();
  }
  return outcome;
}

}  // namespace fsd_localization
