// Training in a thread of its own, one at a time.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "selovis/learning/learner.hpp"

namespace selovis {

class BackgroundTraining {
 public:
  struct Outcome {
    std::shared_ptr<const PlaceModel> model;  ///< null if the training failed
    std::string error;
    std::size_t frames = 0;
  };

  /// Waits for the end of a running training.
  ~BackgroundTraining();
  /// Starts learnFrames(model, frames). @param done is called in the other thread, before busy()
  /// ends; what it throws is lost. @returns false if a training is running, or no thread is
  /// available.
  bool start(std::shared_ptr<const PlaceModel> model, std::vector<LearnedFrame> frames,
             std::function<void(const Outcome&)> done);
  bool busy() const;

 private:
  mutable std::mutex mutex_;
  bool busy_ = false;
  std::thread thread_;
};

}  // namespace selovis
