#include "selovis/learning/background_training.hpp"

#include <exception>
#include <system_error>
#include <utility>

namespace selovis {

BackgroundTraining::~BackgroundTraining() {
  if (thread_.joinable()) thread_.join();
}

bool BackgroundTraining::busy() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return busy_;
}

bool BackgroundTraining::start(std::shared_ptr<const PlaceModel> model,
                               std::vector<LearnedFrame> frames,
                               std::function<void(const Outcome&)> done) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (busy_) return false;
    busy_ = true;
  }
  if (thread_.joinable()) thread_.join();
  const auto run = [this, model = std::move(model), frames = std::move(frames),
                    done = std::move(done)] {
    Outcome outcome;
    outcome.frames = frames.size();
    try {
      outcome.model = std::make_shared<PlaceModel>(learnFrames(*model, frames));
    } catch (const std::exception& e) {
      outcome.error = e.what();
    }
    try {
      done(outcome);
    } catch (const std::exception&) {
      // There is nobody to report it to.
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    busy_ = false;
  };
  try {
    thread_ = std::thread(run);
  } catch (const std::system_error&) {
    const std::lock_guard<std::mutex> lock(mutex_);
    busy_ = false;
    return false;
  }
  return true;
}

}  // namespace selovis
