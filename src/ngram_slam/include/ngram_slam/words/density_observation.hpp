// Observations at equal steps of the path: pose and free-space density (Eq. 4.1 without the class,
// which may change later), and a store for millions of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "ngram_slam/words/block_vector.hpp"

namespace ngram_slam {

struct DensityObservation {
  double stamp = 0.0;           ///< [s]
  hyselam::Pose2 base_in_odom;  ///< odometry of the run; frames of two runs have nothing in common
  double soft = 0.0;            ///< Psi, 0..1: always defined
  std::optional<double> hard;   ///< Psi-diamond, 0..1: empty where unknown cells are in reach
  int frontiers = 0;            ///< frontiers of free space, 0..255
  /// Psi of the same spot, 0..1, from a map in which all around it has been observed, also what
  /// lies behind the robot and around the corner: the same in both directions of travel. Empty
  /// where it was not computed (ObservationSensorParams::look_back).
  std::optional<double> full;
};

/// Which of the densities of an observation is used to build words.
enum class WordDensity {
  kSoft,  ///< DensityObservation::soft, from the map at that moment (4.2.1)
  kFull   ///< DensityObservation::full, from the map some metres later; soft where it is missing
};

/// Where along the path observations are due: one for every `step` metres of displacement.
class DistanceSampler {
 public:
  /// @throws hyselam::ParameterError unless step > 0.
  explicit DistanceSampler(double step = 0.1);
  /// The poses on the straight line from the last one given out to `pose` at which an observation
  /// is due, in order; several if the robot came further than a step, so that a count of
  /// observations is a length (Eq. 4.4). The first pose of all is due itself. More than `kMaxGap`
  /// metres at once are an odometry jump, not a path: one pose, the new one.
  std::vector<hyselam::Pose2> due(const hyselam::Pose2& pose);
  /// Restarts sampling: the next pose is treated as the first one.
  void reset() { last_.reset(); }

  static constexpr double kMaxGap = 5.0;  ///< [m]

 private:
  double step_;
  std::optional<hyselam::Pose2> last_;
};

/// All observations of all runs in 27 bytes each; nothing is moved when the store grows. Values
/// are rounded when they are added (positions to 0.1 mm, densities to 1/65534), so that what is
/// built from the store is the same before it is saved and after it is loaded.
class ObservationStore {
 public:
  /// Starts a run: the next observations have another odometry frame.
  void startRun();
  /// Adds an observation; starts a run if there is none. Returns its index.
  /// @throws hyselam::InputError for values that are not finite or not in range, and for a position
  /// more than 200 km from the first one of the run; the store is unchanged then.
  std::uint32_t append(const DensityObservation& o);

  std::uint32_t size() const { return static_cast<std::uint32_t>(stamps_.size()); }
  DensityObservation operator[](std::uint32_t i) const;
  double soft(std::uint32_t i) const { return soft_[i] * (1.0 / kDensitySteps); }
  /// What words are made of. Where there is no full density, the soft one takes its place.
  double density(std::uint32_t i, WordDensity which) const {
    return which == WordDensity::kFull && full_[i] != kUndefined ? full_[i] * (1.0 / kDensitySteps)
                                                                 : soft(i);
  }
  double stamp(std::uint32_t i) const { return stamps_[i]; }
  hyselam::Pose2 pose(std::uint32_t i) const;

  std::uint32_t runs() const { return static_cast<std::uint32_t>(runs_.size()); }
  std::uint32_t runBegin(std::uint32_t run) const { return runs_[run].begin; }
  std::uint32_t runEnd(std::uint32_t run) const {
    return run + 1 < runs() ? runs_[run + 1].begin : size();
  }
  /// The run of an observation.
  std::uint32_t runOf(std::uint32_t i) const;
  std::size_t bytes() const;

 private:
  friend class CorpusFile;
  static constexpr int kDensitySteps = 65534;
  static constexpr std::uint16_t kUndefined = 65535;
  static constexpr double kLength = 1e-4;  // [m] of a count
  static constexpr double kAngle = hyselam::kPi / 2147483647.0;
  struct Run {
    std::uint32_t begin;
    double x, y;  // [m] of the first observation
  };

  std::vector<Run> runs_;
  BlockVector<double> stamps_;
  BlockVector<std::int32_t> x_, y_, theta_;
  BlockVector<std::uint16_t> soft_, hard_, full_;
  BlockVector<std::uint8_t> frontiers_;
};

}  // namespace ngram_slam
