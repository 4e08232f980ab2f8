// The descriptor of views beside VFH (Rusu et al. 2010) and ESF (Wohlkinger and Vincze 2011) of
// PCL: nine kinds of things, learnt in a show room (20 views each), recognized by the nearest view
// (L1). Pixels of a thing are the true ones, points are those of every second row and column.
//
// Counters: views of a kind and share recognized as the right kind: `view_out`, each view of the
// show room by the others; `flats`, views in drawn flats, among other things and partly hidden.
// With the acceptance that is learnt (1.6 times the largest gap between the learnt views):
// `accepted`, share of the views in the flats that are told as the right kind; `object_out`, share
// of those whose kind was left out of the dictionary that are told as no kind. Time: of one
// description.
#include <benchmark/benchmark.h>
#include <pcl/features/esf.h>
#include <pcl/features/normal_3d.h>
#include <pcl/features/vfh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "flat_show.hpp"

namespace {

using namespace hyselam_objects;             // NOLINT: a bench, not a header
using namespace hyselam_objects::simulated;  // NOLINT

constexpr std::size_t kFewestPoints = 60;
constexpr int kFlats = 3, kEvery = 7;  // drawn flats; every n-th frame of a tour

struct View {
  std::string kind;
  std::vector<Eigen::Vector3f> points;  ///< map frame [m]
  std::vector<std::uint32_t> colors;
  Eigen::Vector3f eye;
};

using Descriptor = std::vector<float>;

/// The views of all things in a frame.
void addViews(const Flat& flat, const Frame& frame, std::vector<View>& to) {
  std::map<std::int32_t, View> views;
  const Eigen::Isometry3f pose = frame.camera.in_map.cast<float>();
  for (int y = 0; y < frame.cloud.height; y += 2) {
    for (int x = 0; x < frame.cloud.width; x += 2) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.cloud.width) +
                     static_cast<std::size_t>(x);
      if (!frame.cloud.isValid(i) || frame.cloud.points[i].z() > 4.0f) continue;
      View& view = views[frame.owners[i]];
      view.points.push_back(pose * frame.cloud.points[i]);
      view.colors.push_back(frame.cloud.colors[i]);
    }
  }
  for (auto& [owner, view] : views) {
    const std::string name = flat.ownerName(owner);
    for (const Thing& thing : flat.allThings()) {
      if (thing.name == name) view.kind = thing.kind;
    }
    if (view.kind.empty() || view.points.size() < kFewestPoints) continue;
    view.eye = pose.translation();
    to.push_back(std::move(view));
  }
}

const std::vector<View>& shownViews() {
  static const std::vector<View> views = [] {
    std::vector<View> out;
    showKinds([&](const std::string&, const Flat& flat, const Frame& frame) {
      addViews(flat, frame, out);
    });
    return out;
  }();
  return views;
}

const std::vector<View>& flatViews() {
  static const std::vector<View> views = [] {
    std::vector<View> out;
    for (std::uint64_t seed = 1; seed <= kFlats; ++seed) {
      const Furnished furnished = drawnFlat(HYSELAM_FLAT_PLAN, seed);
      const Flat flat(furnished.plan, furnished.before, furnished.targets);
      const std::vector<hyselam::Pose2> way = flat.tour();
      for (std::size_t i = 0; i < way.size(); i += kEvery) {
        addViews(flat, flat.take(way[i], 0.0, i + 1), out);
      }
    }
    return out;
  }();
  return views;
}

pcl::PointCloud<pcl::PointXYZ>::Ptr cloudOf(const View& view) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (const Eigen::Vector3f& p : view.points) cloud->push_back({p.x(), p.y(), p.z()});
  return cloud;
}

/// With a sum of one, so that views of any number of points compare.
template <std::size_t n>
Descriptor normalized(const float (&histogram)[n]) {
  Descriptor out(histogram, histogram + n);
  float sum = 0.0f;
  for (const float value : out) sum += std::abs(value);
  for (float& value : out) value /= std::max(sum, 1e-9f);
  return out;
}

Descriptor vfh(const View& view) {
  const auto cloud = cloudOf(view);
  pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimate;
  estimate.setKSearch(12);
  estimate.setViewPoint(view.eye.x(), view.eye.y(), view.eye.z());
  estimate.setInputCloud(cloud);
  estimate.compute(*normals);
  pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> describe;
  describe.setViewPoint(view.eye.x(), view.eye.y(), view.eye.z());
  describe.setInputCloud(cloud);
  describe.setInputNormals(normals);
  pcl::PointCloud<pcl::VFHSignature308> out;
  describe.compute(out);
  return normalized(out.front().histogram);
}

Descriptor esf(const View& view) {
  pcl::ESFEstimation<pcl::PointXYZ, pcl::ESFSignature640> describe;
  describe.setInputCloud(cloudOf(view));
  pcl::PointCloud<pcl::ESFSignature640> out;
  describe.compute(out);
  return normalized(out.front().histogram);
}

Descriptor ours(const View& view) {
  return describeView(view.points, view.colors);
}

Descriptor oursWithoutColors(const View& view) {
  return describeView(view.points, {});
}

double distanceOf(const Descriptor& a, const Descriptor& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(static_cast<double>(a[i]) - b[i]);
  return sum;
}

class Recognition {
 public:
  Recognition(const std::vector<View>& views, std::vector<Descriptor> descriptors)
      : views_(views), descriptors_(std::move(descriptors)) {
    // As learnObject() does.
    constexpr double kFactor = 1.6;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < views_.size(); ++j) {
        if (i == j || views_[i].kind != views_[j].kind) continue;
        nearest = std::min(nearest, distanceOf(descriptors_[i], descriptors_[j]));
      }
      double& accepted = accepted_[views_[i].kind];
      accepted = std::max(accepted, kFactor * nearest);
    }
  }

  struct Answer {
    std::string kind;
    bool accepted = false;
  };
  /// `left_out`: a view, `kind_left_out`: a kind that is not compared with.
  Answer ask(const Descriptor& descriptor, std::size_t left_out,
             const std::string& kind_left_out = "") const {
    Answer answer;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (i == left_out || views_[i].kind == kind_left_out) continue;
      const double away = distanceOf(descriptor, descriptors_[i]);
      if (away >= least) continue;
      least = away;
      answer = {views_[i].kind, away <= accepted_.at(views_[i].kind)};
    }
    return answer;
  }

 private:
  const std::vector<View>& views_;
  std::vector<Descriptor> descriptors_;
  std::map<std::string, double> accepted_;
};

void BM_Recognition(benchmark::State& state, Descriptor (*describe)(const View&)) {
  const std::vector<View>&shown = shownViews(), &others = flatViews();
  std::vector<Descriptor> of_shown, of_others;
  for (auto _ : state) {
    of_shown.clear();
    of_others.clear();
    for (const View& view : shown) of_shown.push_back(describe(view));
    for (const View& view : others) of_others.push_back(describe(view));
  }
  const Recognition recognition(shown, of_shown);
  constexpr auto kNone = std::numeric_limits<std::size_t>::max();
  double view_out = 0.0, in_flats = 0.0, accepted = 0.0, refused = 0.0;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    view_out += recognition.ask(of_shown[i], i).kind == shown[i].kind;
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    const Recognition::Answer answer = recognition.ask(of_others[i], kNone);
    in_flats += answer.kind == others[i].kind;
    accepted += answer.kind == others[i].kind && answer.accepted;
    refused += !recognition.ask(of_others[i], kNone, others[i].kind).accepted;
  }
  const auto n = static_cast<double>(shown.size()), m = static_cast<double>(others.size());
  state.counters["views"] = n;
  state.counters["views_in_flats"] = m;
  state.counters["view_out"] = view_out / n;
  state.counters["flats"] = in_flats / m;
  state.counters["accepted"] = accepted / m;
  state.counters["object_out"] = refused / m;
  state.counters["numbers"] = static_cast<double>(of_shown.front().size());
  state.counters["items"] = n + m;
}

BENCHMARK_CAPTURE(BM_Recognition, ours, ours)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(BM_Recognition, ours_without_colors, oursWithoutColors)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(BM_Recognition, VFH, vfh)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(BM_Recognition, ESF, esf)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
