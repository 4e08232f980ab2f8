#include "hyselam_gr2to/background_gr2to.hpp"

#include <algorithm>
#include <chrono>
#include <new>

#include "hyselam_common/errors.hpp"
#include "hyselam_gr2to/gr2to_updater.hpp"

namespace hyselam_topo {
namespace {

bool sameGrid(const hyselam::OccupancyGrid& a, const hyselam::OccupancyGrid& b) {
  const auto &g = a.geometry, &h = b.geometry;
  return g.width == h.width && g.height == h.height && g.resolution == h.resolution &&
         g.origin.x == h.origin.x && g.origin.y == h.origin.y && g.origin.theta == h.origin.theta &&
         a.cells == b.cells;
}

}  // namespace

BackgroundGr2To::Pipeline BackgroundGr2To::updating(int max_partial_updates) {
  struct Memory {
    std::optional<Gr2ToUpdater> updater;
    int updates = 0;  // since the whole map was segmented
  };
  return [memory = std::make_shared<Memory>(), max_partial_updates](
             const hyselam::OccupancyGrid& grid, const Gr2ToParams& params) {
    if (!memory->updater || memory->updates >= max_partial_updates) {
      memory->updater.emplace();
      memory->updates = 0;
    }
    Gr2ToResult result = memory->updater->update(grid, params);
    const bool whole_map = memory->updater->lastUpdate() == Gr2ToUpdater::UpdateKind::kFromScratch;
    memory->updates = whole_map ? 0 : memory->updates + 1;
    return result;
  };
}

BackgroundGr2To::BackgroundGr2To(std::function<void(const Outcome&)> done, Pipeline pipeline)
    : on_done_(std::move(done)), pipeline_(std::move(pipeline)), thread_([this] { run(); }) {}

BackgroundGr2To::~BackgroundGr2To() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void BackgroundGr2To::start(Input input) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    next_ = std::move(input);
  }
  wake_.notify_all();
}

BackgroundGr2To::MapPtr BackgroundGr2To::current() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return current_;
}

void BackgroundGr2To::replace(const AugmentedTopologicalMap& map, const std::string& source) {
  checkMap(map, source);
  if (!map.grid) throw hyselam::InputError(source, "", "it has no grid");
  auto copy = std::make_shared<AugmentedTopologicalMap>(map);
  normalize(*copy);
  const std::lock_guard<std::mutex> lock(mutex_);
  current_ = std::move(copy);
  last_grid_.reset();
}

bool BackgroundGr2To::busy() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return working_ || next_;
}

void BackgroundGr2To::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stop_ || next_; });
    if (stop_) return;
    const Input input = std::move(*next_);
    next_.reset();
    working_ = true;
    lock.unlock();
    on_done_(work(input));
    lock.lock();
    working_ = false;
  }
}

BackgroundGr2To::Outcome BackgroundGr2To::work(const Input& input) {
  Outcome outcome;
  const auto begin = std::chrono::steady_clock::now();
  try {
    const auto grid = std::make_shared<hyselam::OccupancyGrid>(input.grid());
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (last_grid_ && last_frame_ == input.frame_id &&
          last_params_version_ == input.params_version && sameGrid(*last_grid_, *grid)) {
        outcome.map = current_;
        outcome.grid = last_grid_;
        outcome.unchanged = true;
        return outcome;
      }
    }
    Gr2ToResult result = pipeline_(*grid, input.params);
    result.map.frame_id = input.frame_id;
    result.map.stamp = input.stamp;
    normalize(result.map);
    outcome.seconds = std::move(result.seconds);
    outcome.grid = grid;
    adopt(result.map, outcome);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (current_ == outcome.map) {
      last_grid_ = grid;
      last_frame_ = input.frame_id;
      last_params_version_ = input.params_version;
    }
  } catch (const std::bad_alloc&) {
    outcome.error = "not enough memory for this map";
  } catch (const std::exception& e) {
    outcome.error = e.what();
  }
  outcome.total_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return outcome;
}

void BackgroundGr2To::adopt(const AugmentedTopologicalMap& fresh, Outcome& outcome) {
  for (;;) {
    const MapPtr base = current();
    auto map = std::make_shared<AugmentedTopologicalMap>(fresh);
    outcome.warning.clear();
    if (base && base->frame_id != fresh.frame_id) {
      outcome.warning = "the map is in frame '" + fresh.frame_id + "' now, not in '" +
                        base->frame_id + "': its places and names are new";
    }
    if (base && outcome.warning.empty()) {
      *map = carryOver(*base, fresh, {}, outcome.report);
    } else {
      checkMap(fresh, "new map");
      outcome.report = {};
      for (const Place& place : fresh.places) outcome.report.created.push_back(place.id);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    if (current_ != base) continue;  // replaced meanwhile: what is known is something else now
    current_ = map;
    outcome.map = std::move(map);
    return;
  }
}

}  // namespace hyselam_topo
