// Signatures labeled with their places: the training set of the classifiers.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"

namespace selovis {

/// A pose that is not known.
constexpr hyselam::Pose2 kNoPose{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};

/// A stretch of a signature that means something by itself: a term of a joined descriptor.
struct SignaturePart {
  std::string name;
  int size = 0;
  double power = 0.5;  ///< that each value is raised to before distances are taken
  /// It counts colors as they are, and so hangs on the color of the light.
  bool absolute_color = false;
  /// Its weights were learned in other buildings: it is believed where its worth can be measured.
  bool learned_elsewhere = false;
};

/// Frame numbers of two tours are at least so far apart, ...
constexpr int kTourGap = 100;
/// ... those before and after a pause on one tour so far: they are not consecutive.
constexpr int kPauseGap = 20;

struct Samples {
  std::size_t size = 0;       ///< length of one signature
  std::vector<float> values;  ///< one signature after the other
  /// Of each signature, in order (Descriptor::parts); needed by the fusion of parts only.
  std::vector<SignaturePart> parts;
  std::vector<int> places;  ///< class of each sample, from 0 on
  /// Number of the frame that each sample was computed from, ascending; views of a frame share it.
  std::vector<int> frames;
  /// Of the camera in the map, turned as the view is; kNoPose where it is not known.
  std::vector<hyselam::Pose2> poses;

  std::size_t count() const { return places.size(); }
  const float* row(std::size_t i) const { return values.data() + i * size; }
  void add(const float* signature, int place, int frame, const hyselam::Pose2& pose = kNoPose) {
    values.insert(values.end(), signature, signature + size);
    places.push_back(place);
    frames.push_back(frame);
    poses.push_back(pose);
  }
};

/// Dot product of n values, summed in a fixed order.
float dot(const float* a, const float* b, std::size_t n);

}  // namespace selovis
