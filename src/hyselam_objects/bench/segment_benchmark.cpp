// CloudSegmentation of the clouds of mOSD beside PCL's Euclidean clustering and LCCP, both as PCL's
// own examples set them. Counters: mean best overlap (IoU) of the true objects, over- and
// under-segmentation, summed over the clouds.
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
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/segmentation/segment_cloud.hpp"
#include "segmentation_score.hpp"

namespace {

using namespace hyselam_objects;  // NOLINT: a bench, not a header
namespace fs = std::filesystem;
using Labels = std::vector<std::uint32_t>;

Labels ours(const CloudFile& file) {
  return segmentCloud(file.cloud).labels;
}

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

void run(benchmark::State& state, const std::vector<CloudFile>& files,
         Labels (*segment)(const CloudFile&)) {
  SegmentationScore score;
  for (auto _ : state) {
    score = {};
    for (const CloudFile& file : files) {
      const Labels labels = segment(file);
      state.PauseTiming();
      addScore(labels, file.labels, score);
      state.ResumeTiming();
    }
  }
  state.counters["iou"] = score.meanIou();
  state.counters["true_objects"] = score.objects;
  state.counters["over"] = score.over;
  state.counters["under"] = score.under;
  state.counters["items"] = static_cast<double>(files.size());
}

const bool kAdded = [] {
  const char* data = std::getenv("HYSELAM_DATA");
  const fs::path folder = fs::path(data != nullptr ? data : HYSELAM_DEFAULT_DATA) / "objects/mosd";
  auto files = std::make_shared<std::vector<CloudFile>>();
  std::vector<fs::path> paths;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".pcd") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  for (const fs::path& path : paths) files->push_back(readPcd(path.string()));
  if (files->empty()) {
    std::cerr << "left out: no clouds in " << folder << " (set HYSELAM_DATA)\n";
    return false;
  }
  const std::pair<const char*, Labels (*)(const CloudFile&)> methods[] = {
      {"SegmentCloud/euclidean", euclidean},
      {"SegmentCloud/lccp", lccp},
      {"SegmentCloud/ours", ours}};
  for (const auto& [name, method] : methods) {
    const bool peer = method != ours;
    benchmark::RegisterBenchmark(name, [files, method = method, peer](benchmark::State& state) {
      run(state, *files, method);
      if (!peer) state.SetLabel("baseline=SegmentCloud/lccp");
    })->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace

BENCHMARK_MAIN();
