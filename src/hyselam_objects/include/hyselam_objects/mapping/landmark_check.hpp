// Objects as landmarks (dos Santos, chapter 8): a check of the localization. Objects that hardly
// move should be seen where the map has them.
#pragma once

#include <deque>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/segmentation/detect_objects.hpp"

namespace hyselam_objects {

struct LandmarkParams {
  double max_movability = 0.35;       ///< of a landmark, 0 .. 1
  int min_views = 3;                  ///< of a landmark
  int min_visits = 2;                 ///< of a landmark (stays of its history), unless furniture
  double appearance_threshold = 0.5;  ///< descriptor distance of an object to its landmark, below
  double position_sigma = 0.08;  ///< of an object's position, small errors of the pose included [m]
  double max_offset = 2.5;       ///< largest offset of the pose that is searched for [m]
  int min_compared = 3;          ///< objects with a landmark that a verdict needs
  double min_chi2_gain = 12.0;   ///< by which an offset must explain the frame better
  double min_offset = 0.25;      ///< smaller offsets are not reported [m]

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

enum class LandmarkVerdict { kUnknown, kConsistent, kDisplaced, kDoubtful };
/// "unknown", "consistent", "displaced", "doubtful".
const char* toString(LandmarkVerdict verdict);

struct LandmarkCheck {
  LandmarkVerdict verdict = LandmarkVerdict::kUnknown;
  int compared = 0;  ///< number of detections with the appearance of a landmark
  int inliers = 0;   ///< number of these within 3 sigma of it, with the offset applied
  /// Mean over those compared of the squared distance by variance, truncated at 9: for the
  /// estimated pose, and with the offset applied.
  double chi2 = 0.0, chi2_with_offset = 0.0;
  /// Offset to be added to the estimated position of the robot, map frame [m]; 0 unless displaced.
  double x = 0.0, y = 0.0;
};

/// `detections`: in the map, by the estimated pose. They are compared with hardly movable objects
/// of the map of similar appearance (furniture: of similar height, and its visible part must lie
/// within it). Each pair proposes an offset; the one with the smallest truncated chi^2 counts. A
/// wrong heading is found only as far as it acts like an offset.
/// @throws hyselam::ParameterError.
LandmarkCheck checkLandmarks(const ObjectMap& map, const std::vector<DetectedObject>& detections,
                             const LandmarkParams& params = {});

/// The same check over the last images: a single one shows too few objects.
class LandmarkMonitor {
 public:
  explicit LandmarkMonitor(const LandmarkParams& params = {}, std::size_t frames = 6)
      : params_(params), frames_(frames) {}

  LandmarkCheck add(const ObjectMap& map, const std::vector<DetectedObject>& detections);
  void clear() { last_.clear(); }

 private:
  LandmarkParams params_;
  std::size_t frames_;
  std::deque<std::vector<DetectedObject>> last_;
};

/// Rejects map updates while the landmarks contradict the pose. If the contradiction persists, the
/// map is assumed to be outdated and updates are allowed again.
class MapUpdateGuard {
 public:
  /// Whether the image with these detections may update the map.
  bool allowsUpdate(const ObjectMap& map, const std::vector<DetectedObject>& detections);
  /// Clears the images that are kept.
  void clear() { monitor_.clear(); }

  /// Result of the check of the last images.
  const LandmarkCheck& lastCheck() const { return last_check_; }
  /// Number of consecutive images that were rejected.
  int framesHeldBack() const { return held_back_; }

 private:
  LandmarkMonitor monitor_;
  LandmarkCheck last_check_;
  int held_back_ = 0;
};

}  // namespace hyselam_objects
