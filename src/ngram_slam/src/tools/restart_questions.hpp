// What a run that is not tied to the map asked of the map and of the scans, as a table.
#pragma once

#include <array>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_score.hpp"

namespace ngram_slam {

/// The places found on the drawn maps (source "place"; its score is the probability) and the far
/// loops between runs and map that the scans were asked for: what was answered, and how far from
/// the truth that is.
class RestartQuestions {
 public:
  /// Writes no table without a file. @throws hyselam::InputError
  explicit RestartQuestions(const std::string& file) {
    if (file.empty()) return;
    out_.open(file);
    if (!out_) throw hyselam::InputError(file, "", "cannot be written");
    out_ << "log,mode,start,path,place,older,newer,path_older,path_newer,source,apart,verified,"
            "score,ambiguous,inliers,observed,fit,error,error_deg\n";
  }
  bool wanted() const { return out_.is_open(); }
  /// `start`: the first three columns. `truth`: null where there is none, as in another building.
  void note(const std::string& start, const SlamEngine& engine,
            const std::vector<hyselam::StampedPose2>* truth, const SlamJobResult& result) {
    if (result.place && result.place->place) {
      const KnownPlace& p = *result.place->place;
      begin(start, engine, p.keyframe, result.place->keyframe);
      out_ << "place,,," << p.probability << ",,,,";
      end(errorOf(engine, p.keyframe, result.place->keyframe, p.base_in_keyframe, truth));
    }
    for (std::size_t i = 0; i < result.tasks.size(); ++i) {
      const LoopTask& task = result.tasks[i];
      const LoopVerification& answer = result.verifications[i];
      if (!task.far || task.step ||
          keyframe(engine, task.older).run == keyframe(engine, task.newer).run) {
        continue;
      }
      const auto apart = errorOf(engine, task.older, task.newer, {}, truth);
      begin(start, engine, task.older, task.newer);
      out_ << kSources[static_cast<std::size_t>(task.source)] << ','
           << (apart ? apart->distance : kUnknown) << ',' << answer.verified << ',' << answer.score
           << ',' << answer.ambiguous_score << ',' << answer.loop.inlier_ratio << ','
           << answer.new_in_old.observed_ratio << ',' << answer.loop.fit;
      end(errorOf(engine, task.older, task.newer, answer.loop.measured, truth));
    }
  }

 private:
  static constexpr std::array<const char*, 3> kSources = {"outline", "words", "signatures"};
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  static const SlamKeyframe& keyframe(const SlamEngine& engine, int k) {
    return engine.keyframes()[static_cast<std::size_t>(k)];
  }
  static std::optional<LoopError> errorOf(const SlamEngine& engine, int older, int newer,
                                          const hyselam::Pose2& newer_in_older,
                                          const std::vector<hyselam::StampedPose2>* truth) {
    if (truth == nullptr) return std::nullopt;
    return loopError(keyframe(engine, older), keyframe(engine, newer), newer_in_older, *truth);
  }
  void begin(const std::string& start, const SlamEngine& engine, int older, int newer) {
    out_ << start << ',' << engine.pathOfRun() << ',' << toString(engine.runPlace()) << ',' << older
         << ',' << newer << ',' << keyframe(engine, older).path_length << ','
         << keyframe(engine, newer).path_length << ',';
  }
  void end(const std::optional<LoopError>& error) {
    out_ << ',' << (error ? error->distance : kUnknown) << ','
         << (error ? hyselam::degrees(error->angle) : kUnknown) << '\n';
  }

  std::ofstream out_;
};

}  // namespace ngram_slam
