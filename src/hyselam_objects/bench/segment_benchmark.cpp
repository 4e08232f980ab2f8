// Segmentation of the clouds of mOSD beside PCL's Euclidean clustering and LCCP, both as PCL's own
// examples set them. Counters, over all true objects: mean best overlap (IoU), over- and
// under-segmentation; the overlap also of learn*, of test*, and of piles (8 objects and more).
// `ours` has the shipped model (in sample), `ours_left_out` one trained without the cloud that is
// judged, `ours_of_learn` one trained on learn* only: its iou_test is of clouds it never saw.
#include <benchmark/benchmark.h>
#include <pcl/features/normal_3d.h>
#include <pcl/kdtree/kdtree.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/lccp_segmentation.h>
#include <pcl/segmentation/sac_segmentation.h>
#include <pcl/segmentation/supervoxel_clustering.h>

#include <cstdlib>
#include <ctime>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/segmentation/segment_cloud.hpp"
#include "segmentation/segment_frame.hpp"
#include "train/relation_training.hpp"

namespace {

using namespace hyselam_objects;  // NOLINT: a bench, not a header
using Labels = std::vector<std::uint32_t>;

// PCL's tutorial "Euclidean Cluster Extraction": the largest plane is taken away, clusters of what
// is left, tolerance 2 cm.
Labels euclidean(const CloudFile& file) {
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;
  Cloud::Ptr cloud(new Cloud);
  std::vector<std::size_t> origin;
  for (std::size_t i = 0; i < file.cloud.size(); ++i) {
    if (!file.cloud.isValid(i)) continue;
    const Point& p = file.cloud.points[i];
    cloud->push_back({p.x(), p.y(), p.z()});
    origin.push_back(i);
  }
  pcl::SACSegmentation<pcl::PointXYZ> finder;
  finder.setOptimizeCoefficients(true);
  finder.setModelType(pcl::SACMODEL_PLANE);
  finder.setMethodType(pcl::SAC_RANSAC);
  finder.setMaxIterations(100);
  finder.setDistanceThreshold(0.02);
  finder.setInputCloud(cloud);
  pcl::PointIndices plane;
  pcl::ModelCoefficients coefficients;
  finder.segment(plane, coefficients);
  std::vector<bool> in_plane(cloud->size(), false);
  for (const int i : plane.indices) in_plane[static_cast<std::size_t>(i)] = true;
  Cloud::Ptr rest(new Cloud);
  std::vector<std::size_t> rest_origin;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if (in_plane[i]) continue;
    rest->push_back((*cloud)[i]);
    rest_origin.push_back(origin[i]);
  }
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(rest);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(0.02);
  extraction.setMinClusterSize(100);
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(rest);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  Labels labels(file.cloud.size(), 1);
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    for (const int i : clusters[k].indices) {
      labels[rest_origin[static_cast<std::size_t>(i)]] = static_cast<std::uint32_t>(k + 2);
    }
  }
  return labels;
}

// PCL's example lccp_segmentation with its default settings.
Labels lccp(const CloudFile& file) {
  using PointT = pcl::PointXYZRGBA;
  pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  cloud->width = static_cast<std::uint32_t>(file.cloud.width);
  cloud->height = static_cast<std::uint32_t>(file.cloud.height);
  cloud->is_dense = false;
  cloud->resize(file.cloud.size());
  cloud->width = static_cast<std::uint32_t>(file.cloud.width);
  cloud->height = static_cast<std::uint32_t>(file.cloud.height);
  for (std::size_t i = 0; i < file.cloud.size(); ++i) {
    (*cloud)[i].getVector3fMap() = file.cloud.points[i];
    if (!file.cloud.colors.empty()) (*cloud)[i].rgba = file.cloud.colors[i];
  }
  pcl::SupervoxelClustering<PointT> voxels(0.0075f, 0.03f);
  voxels.setUseSingleCameraTransform(true);
  voxels.setInputCloud(cloud);
  voxels.setColorImportance(0.0f);
  voxels.setSpatialImportance(1.0f);
  voxels.setNormalImportance(4.0f);
  std::map<std::uint32_t, pcl::Supervoxel<PointT>::Ptr> clusters;
  voxels.extract(clusters);
  std::multimap<std::uint32_t, std::uint32_t> adjacency;
  voxels.getSupervoxelAdjacency(adjacency);
  pcl::LCCPSegmentation<PointT> segmentation;
  segmentation.setConcavityToleranceThreshold(10.0f);
  segmentation.setSanityCheck(true);
  segmentation.setSmoothnessCheck(true, 0.0075f, 0.03f, 0.1f);
  segmentation.setKFactor(0);
  segmentation.setInputSupervoxels(clusters, adjacency);
  segmentation.setMinSegmentSize(0);
  segmentation.segment();
  pcl::PointCloud<pcl::PointXYZL>::Ptr labelled = voxels.getLabeledCloud();
  segmentation.relabelCloud(*labelled);
  Labels labels(file.cloud.size(), 0);
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = (*labelled)[i].label + 2;
  return labels;
}

using Clouds = std::vector<LabelledCloud>;
using Segment = std::function<Labels(const LabelledCloud&)>;

void run(benchmark::State& state, const Clouds& clouds, const Segment& segment) {
  std::map<std::string, SegmentationScore> scores;
  double slowest = 0.0;
  for (auto _ : state) {
    scores.clear();
    for (const LabelledCloud& cloud : clouds) {
      const std::clock_t begin = std::clock();
      const Labels labels = segment(cloud);
      slowest = std::max(slowest, 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
      state.PauseTiming();
      SegmentationScore score;
      addScore(labels, cloud.file.labels, score);
      scores[""] += score;
      scores[cloud.name.compare(0, 5, "learn") == 0 ? "_learn" : "_test"] += score;
      if (score.objects >= 8) scores["_piles"] += score;
      state.ResumeTiming();
    }
  }
  for (const auto& [group, score] : scores) state.counters["iou" + group] = score.meanIou();
  state.counters["true_objects"] = scores[""].objects;
  state.counters["over"] = scores[""].over;
  state.counters["under"] = scores[""].under;
  state.counters["slowest_ms"] = slowest;
  state.counters["items"] = static_cast<double>(clouds.size());
}

/// The clouds and models, read and trained when a row first needs them.
struct Data {
  Clouds clouds;
  std::map<std::string, RelationModel> left_out, of_learn;
  std::string missing;  ///< why there is none
};

Data prepare() {
  const char* data = std::getenv("HYSELAM_DATA");
  const std::string folder =
      std::string(data != nullptr ? data : HYSELAM_DEFAULT_DATA) + "/objects/";
  Data out;
  try {
    out.clouds = readLabelledClouds({folder + "mosd", folder + "mosd_piles"});
  } catch (const hyselam::InputError& error) {
    out.missing = error.what();
    return out;
  }
  const RelationModel learn = trainRelations(
      out.clouds, [](const LabelledCloud& each) { return each.name.compare(0, 5, "learn") == 0; });
  for (const LabelledCloud& cloud : out.clouds) {
    out.left_out[cloud.name] =
        trainRelations(out.clouds, [&](const LabelledCloud& each) { return &each != &cloud; });
    out.of_learn[cloud.name] = learn;
  }
  return out;
}

const Data& theData() {
  static const Data kData = prepare();
  return kData;
}

Labels leftOut(const LabelledCloud& cloud) {
  return segmentCloudBy(cloud.file.cloud, {}, {}, theData().left_out.at(cloud.name)).labels;
}

Labels ofLearn(const LabelledCloud& cloud) {
  return segmentCloudBy(cloud.file.cloud, {}, {}, theData().of_learn.at(cloud.name)).labels;
}

const bool kAdded = [] {
  const std::pair<const char*, Segment> methods[] = {
      {"SegmentCloud/euclidean", [](const LabelledCloud& cloud) { return euclidean(cloud.file); }},
      {"SegmentCloud/lccp", [](const LabelledCloud& cloud) { return lccp(cloud.file); }},
      {"SegmentCloud/ours",
       [](const LabelledCloud& cloud) { return segmentCloud(cloud.file.cloud).labels; }},
      {"SegmentCloud/ours_left_out", leftOut},
      {"SegmentCloud/ours_of_learn", ofLearn}};
  for (const auto& [name, method] : methods) {
    const bool peer = std::string(name).find("ours") == std::string::npos;
    benchmark::RegisterBenchmark(name, [method = method, peer](benchmark::State& state) {
      const Data& data = theData();
      if (!data.missing.empty()) {
        state.SetLabel("skipped=" + data.missing + " (set HYSELAM_DATA)");
        for (auto _ : state) {
        }
        return;
      }
      run(state, data.clouds, method);
      if (!peer) state.SetLabel("baseline=SegmentCloud/lccp");
    })->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace

BENCHMARK_MAIN();
