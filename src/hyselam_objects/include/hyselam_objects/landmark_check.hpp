// Objects as landmarks (dos Santos, chapter 8): is the robot where it believes to be? Things that
// do not move should be seen where the map has them.
#pragma once

#include <deque>
#include <vector>

#include "hyselam_objects/detect_objects.hpp"
#include "hyselam_objects/object_map.hpp"

namespace hyselam_objects {

struct LandmarkParams {
  double movable = 0.35;  ///< what is more movable is no landmark, 0 .. 1
  int seen = 3;           ///< views that a landmark needs
  int visits = 2;         ///< and stays, unless it is furniture
  double look = 0.5;      ///< a thing and its landmark look nearer than this
  double sigma = 0.08;    ///< of a thing's place, the pose's small errors included [m]
  double search = 2.5;    ///< farthest offset that is looked for [m]
  int at_least = 3;       ///< things with a landmark that a verdict needs
  double worth = 12.0;    ///< chi^2 that an offset must explain to be believed
  double least = 0.25;    ///< smaller offsets are none [m]
};

enum class LandmarkVerdict { kUnknown, kConsistent, kDisplaced, kDoubtful };
/// "unknown", "consistent", "displaced", "doubtful".
const char* toString(LandmarkVerdict verdict);

struct LandmarkCheck {
  LandmarkVerdict verdict = LandmarkVerdict::kUnknown;
  int compared = 0;  ///< things seen that look like a landmark
  int fitting = 0;   ///< of them, within 3 sigma of one, with the offset
  /// Mean over those compared: squared distance by variance, 9 at most; as believed and with the
  /// offset.
  double chi2 = 0.0, chi2_with_offset = 0.0;
  /// To be added to where the robot believes to be, in the map [m]; 0 unless it is displaced.
  double x = 0.0, y = 0.0;
};

/// `seen`: where the believed pose puts what is seen. Compares with the things of the map that are
/// hardly movable, of like looks (furniture: of like height, and what is seen of it must lie within
/// it). Each pair proposes an offset; the one that explains most counts, what fits none of it at
/// most 9. An error of direction is found only in so far as it is like an offset. Throws
/// hyselam::ParameterError.
LandmarkCheck checkLandmarks(const ObjectMap& map, const std::vector<DetectedObject>& seen,
                             const LandmarkParams& params = {});

/// The same over the last frames: one alone shows too little.
class LandmarkWatch {
 public:
  explicit LandmarkWatch(const LandmarkParams& params = {}, std::size_t frames = 6)
      : params_(params), frames_(frames) {}

  LandmarkCheck add(const ObjectMap& map, const std::vector<DetectedObject>& seen);
  void clear() { last_.clear(); }

 private:
  LandmarkParams params_;
  std::size_t frames_;
  std::deque<std::vector<DetectedObject>> last_;
};

}  // namespace hyselam_objects
