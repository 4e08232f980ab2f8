#include "segment_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "hyselam_common/errors.hpp"
#include "merge_patches.hpp"
#include "support_plane.hpp"

namespace hyselam_objects {
namespace {

constexpr int kNone = Patches::kNone;

/// Of each pixel: 0 no measurement, 1 background, 2 ... objects. Each takes what the reduced pixel
/// around has whose point is nearest.
std::vector<std::uint32_t> labelPixels(const OrganizedCloud& cloud, const SurfaceGrid& grid,
                                       const std::vector<int>& objects, int downsampling) {
  std::vector<std::uint32_t> labels(cloud.size(), 0);
  for (int y = 0; y < cloud.height; ++y) {
    for (int x = 0; x < cloud.width; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(cloud.width) +
                     static_cast<std::size_t>(x);
      if (!cloud.isValid(i)) continue;
      float least = std::numeric_limits<float>::infinity();
      int object = kNone;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const int gx = x / downsampling + dx, gy = y / downsampling + dy;
          if (gx < 0 || gy < 0 || gx >= grid.width() || gy >= grid.height()) continue;
          const std::size_t j = grid.index(gx, gy);
          if (!grid.isValid(j)) continue;
          const float off = (grid.point(j) - cloud.points[i]).squaredNorm();
          if (off < least) {
            least = off;
            object = objects[j];
          }
        }
      }
      labels[i] = object == kNone ? 1u : static_cast<std::uint32_t>(object + 2);
    }
  }
  return labels;
}

/// Whether a coordinate over depth falls along the rows or columns.
bool runsBackwards(const OrganizedCloud& cloud, int axis) {
  double sum = 0.0, sum_place = 0.0, sum_slope = 0.0, n = 0.0;
  const auto width = static_cast<std::size_t>(std::max(1, cloud.width));
  for (std::size_t i = 0; i < cloud.size(); i += 7) {
    if (!cloud.isValid(i) || cloud.points[i].z() == 0.0f) continue;
    const auto place = static_cast<double>(axis == 0 ? i % width : i / width);
    const double slope = static_cast<double>(cloud.points[i][axis]) /
                         std::abs(static_cast<double>(cloud.points[i].z()));
    sum += place * slope;
    sum_place += place;
    sum_slope += slope;
    n += 1.0;
  }
  return n > 1.0 && sum * n < sum_place * sum_slope;
}

}  // namespace

UprightFrame::UprightFrame(const OrganizedCloud& cloud, const SegmentParams& params,
                           const std::optional<Eigen::Vector3f>& up)
    : original_(cloud), cloud_(&cloud) {
  constexpr float kDown = 0.5f;  // the support faces that much down in the image
  const bool has_rows = cloud.width > 1 && cloud.height > 1;
  alignAxes();
  if (!has_rows && cloud.size() > 1) organize(*cloud_);
  grid_.emplace(*cloud_, params);
  std::optional<Eigen::Vector3f> up_here;
  if (up) up_here = (up->array() * sign_).matrix().normalized();
  support_ = findSupportPlane(*grid_, params, up_here);
  const float down = up_here ? up_here->y() : support_ ? support_->normal.y() : 0.0f;
  if (down < kDown) return;
  turnOver();
  if (up_here) up_here = Eigen::Vector3f(-up_here->x(), -up_here->y(), up_here->z());
  grid_.emplace(*cloud_, params);
  support_ = findSupportPlane(*grid_, params, up_here);
}

OrganizedCloud& UprightFrame::ownCloud() {
  if (cloud_ != &own_) {
    own_ = *cloud_;
    cloud_ = &own_;
  }
  return own_;
}

void UprightFrame::organize(const OrganizedCloud& cloud) {
  std::optional<OrganizedView> view = organizeCloud(cloud);
  if (!view && usablePoints(cloud) < kLeastPoints) {  // as a frame in which little was measured
    pixel_of_.assign(cloud.size(), -1);
    own_ = {};
    cloud_ = &own_;
    return;
  }
  if (!view) {
    throw hyselam::InputError("cloud", "",
                              "has no rows, and its points were not seen from its origin");
  }
  own_ = std::move(view->cloud);
  cloud_ = &own_;
  pixel_of_ = std::move(view->pixel_of);
}

// Depth forward, x and y along columns and rows. Which point is in which pixel stays.
void UprightFrame::alignAxes() {
  turn_.behind = liesBehind(*cloud_);
  const bool has_rows = cloud_->width > 1 && cloud_->height > 1;
  if (turn_.behind) sign_.z() = -1.0f;
  if (!has_rows) {
    if (!turn_.behind) return;
    sign_.y() = -1.0f;
    turnToFront(ownCloud());
    return;
  }
  for (const int axis : {0, 1}) {
    if (runsBackwards(*cloud_, axis)) sign_[axis] = -1.0f;
  }
  turn_.mirrored = sign_.prod() < 0.0f;
  if (sign_.minCoeff() > 0.0f) return;
  for (Point& p : ownCloud().points) p = (p.array() * sign_).matrix();
}

// By half a turn in the image.
void UprightFrame::turnOver() {
  turn_.upside_down = true;
  const auto last = static_cast<std::int32_t>(cloud_->size()) - 1;
  OrganizedCloud& own = ownCloud();
  if (pixel_of_.empty()) {
    pixel_of_.resize(own.size());
    std::iota(pixel_of_.begin(), pixel_of_.end(), 0);
  }
  for (std::int32_t& pixel : pixel_of_) {
    if (pixel >= 0) pixel = last - pixel;
  }
  std::reverse(own.points.begin(), own.points.end());
  std::reverse(own.colors.begin(), own.colors.end());
  const Eigen::Array3f half(-1.0f, -1.0f, 1.0f);
  for (Point& p : own.points) p = (p.array() * half).matrix();
  sign_ *= half;
}

std::optional<Plane> UprightFrame::originalSupport() const {
  if (!support_) return std::nullopt;
  return Plane{(support_->normal.array() * sign_).matrix(), support_->distance};
}

std::vector<std::uint32_t> UprightFrame::originalLabels(
    const std::vector<std::uint32_t>& labels) const {
  if (pixel_of_.empty()) return labels;
  std::vector<std::uint32_t> out(original_.size(), 0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!original_.isValid(i)) continue;
    const std::int32_t pixel = pixel_of_[i];
    out[i] = pixel < 0 ? 1u : std::max(1u, labels[static_cast<std::size_t>(pixel)]);
  }
  return out;
}

CloudSegmentation segmentCloudBy(const OrganizedCloud& cloud, const SegmentParams& params,
                                 const std::optional<Eigen::Vector3f>& up,
                                 const RelationModel& model) {
  checkCloud(cloud);
  params.validate();
  if (up && !(up->allFinite() && up->norm() > 1e-6f)) {
    throw hyselam::InputError("up", "", "is no direction");
  }
  const UprightFrame frame(cloud, params, up);
  std::vector<int> objects(frame.grid().size(), kNone);
  if (frame.support()) {
    const std::vector<bool> marked = pixelsAbove(frame.grid(), *frame.support(), params);
    const Patches patches(frame.grid(), marked, params);
    objects = mergePatches(frame.grid(), patches, params, model);
  }
  CloudSegmentation out;
  out.turn = frame.turn();
  out.support = frame.originalSupport();
  out.labels =
      frame.originalLabels(labelPixels(frame.cloud(), frame.grid(), objects, params.downsampling));
  for (const std::uint32_t label : out.labels) {
    if (label >= 2) out.objects = std::max(out.objects, label - 1);
  }
  return out;
}

}  // namespace hyselam_objects
