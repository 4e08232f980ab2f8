// The learned frames by pose: what a camera at a pose should see, by kernel regression.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "selovis/classifiers/samples.hpp"

namespace selovis {

/// Views of learned frames in a grid of cells, with the similarity of one frame to each of them.
class LearnedViews {
 public:
  struct Frame {  ///< position of a learned frame, with its views
    hyselam::Point2 position;
    int place;
    std::uint32_t begin, end;  // of views()
  };
  struct View {
    double heading;        ///< [rad]
    std::uint32_t sample;  ///< index into the samples
    std::uint32_t frame;   ///< index into frames()
  };
  /// The kernel regression at a pose.
  struct Regression {
    double weight = 0.0;  ///< sum of the kernels, in frames at the pose itself; 0: nothing learned
    double sum = 0.0;     ///< of the similarities, each times its kernel
    double nearest2 = 0.0;  ///< squared distance to the nearest learned frame [m^2]
    int place = -1;         ///< of that frame; -1: there is none within the radius
  };

  /// Samples without a pose are not used. A view counts for a pose within `radius` [m] and `angle`
  /// [rad] of it, by (1 - r^2 / radius^2)^2 (1 - phi^2 / angle^2)^2.
  /// @throws hyselam::InputError with whyNot().
  LearnedViews(const Samples& samples, double radius, double angle);

  /// Why these samples cannot be ordered by their poses; empty if they can.
  static std::string whyNot(const Samples& samples);

  /// A view at the squared distance d^2 gets the similarity exp(-beta (d^2 - d_min^2) / d_min^2).
  /// @param distances squared, of the frame's signature to that of each sample.
  /// @returns the sum of the similarities.
  /// @throws hyselam::InputError for another number of distances.
  double compare(const std::vector<float>& distances, double beta);
  /// Of the last frame compared; 0 to 1.
  double similarity(const View& view) const { return similarity_[view.sample]; }
  Regression at(const hyselam::Pose2& pose) const;
  /// Those of the views that `wanted` accepts that look most like the last frame compared: at most
  /// `count` indices into views(), the most similar first, of equal ones the lowest. `wanted` is
  /// asked for the views alone that are similar enough: few of all.
  template <typename Wanted>
  void mostSimilar(std::size_t count, Wanted&& wanted, std::vector<std::uint32_t>* out) const;

  const std::vector<Frame>& frames() const { return frames_; }
  const std::vector<View>& views() const { return views_; }
  hyselam::Pose2 poseOf(const View& view) const {
    const Frame& f = frames_[view.frame];
    return {f.position.x, f.position.y, view.heading};
  }
  double radius() const { return radius_; }

 private:
  struct Extent {
    hyselam::Point2 low, high;
  };

  static Extent extentOf(const Samples& samples);
  void buildGrid(const Extent& extent);
  std::size_t cellOf(const hyselam::Point2& p) const;

  double radius_, angle_;
  std::vector<Frame> frames_;  // sorted by cell
  std::vector<View> views_;
  std::vector<double> similarity_;  // by sample
  // Square cells of at least the radius.
  hyselam::Point2 origin_;
  double cell_ = 1.0;  // [m]
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> begin_;  // of the frames in each cell, and the end
};

template <typename Wanted>
void LearnedViews::mostSimilar(std::size_t count, Wanted&& wanted,
                               std::vector<std::uint32_t>* out) const {
  out->clear();
  if (count == 0) return;
  const auto better = [&](std::uint32_t a, std::uint32_t b) {
    const double s = similarity(views_[a]), t = similarity(views_[b]);
    return s != t ? s > t : a < b;
  };
  for (std::uint32_t v = 0; v < views_.size(); ++v) {  // a heap, its worst one in front
    const bool full = out->size() == count;
    if ((full && !better(v, out->front())) || !wanted(views_[v])) continue;
    if (full) {
      std::pop_heap(out->begin(), out->end(), better);
      out->pop_back();
    }
    out->push_back(v);
    std::push_heap(out->begin(), out->end(), better);
  }
  std::sort_heap(out->begin(), out->end(), better);
}

}  // namespace selovis
