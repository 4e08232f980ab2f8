#include "relation_training.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "hyselam_common/errors.hpp"
#include "segmentation/segment_frame.hpp"
#include "segmentation/support_plane.hpp"

namespace hyselam_objects {
namespace {

namespace fs = std::filesystem;

/// Of each patch: the object that most of its points belong to; 0 none.
std::vector<std::uint32_t> truthOfPatches(const CloudFile& file, const UprightFrame& frame,
                                          const Patches& patches, int downsampling) {
  std::vector<std::map<std::uint32_t, int>> votes(patches.count());
  const int width = frame.cloud().width;
  for (std::size_t i = 0; i < file.cloud.size(); ++i) {
    const std::int32_t pixel = frame.pixelOf(i);
    const std::uint32_t object = objectOfPart(file.labels[i]);
    if (pixel < 0 || object == 0 || !file.cloud.isValid(i)) continue;
    const int patch =
        patches[frame.grid().index(pixel % width / downsampling, pixel / width / downsampling)];
    if (patch != Patches::kNone) ++votes[static_cast<std::size_t>(patch)][object];
  }
  std::vector<std::uint32_t> out(patches.count(), 0);
  for (std::size_t p = 0; p < votes.size(); ++p) {
    int most = 0;
    for (const auto& [object, count] : votes[p]) {
      if (count <= most) continue;
      most = count;
      out[p] = object;
    }
  }
  return out;
}

std::vector<RelationExample> examplesOf(const CloudFile& file) {
  const SegmentParams params;
  const UprightFrame frame(file.cloud, params, {});
  std::vector<RelationExample> out;
  if (!frame.support()) return out;
  const std::vector<bool> marked = pixelsAbove(frame.grid(), *frame.support(), params);
  const Patches patches(frame.grid(), marked, params);
  const std::vector<std::uint32_t> truth =
      truthOfPatches(file, frame, patches, params.downsampling);
  for (const PatchRelation& relation : relatePatches(frame.grid(), patches, params)) {
    const std::uint32_t a = truth[static_cast<std::size_t>(relation.first)];
    const std::uint32_t b = truth[static_cast<std::size_t>(relation.second)];
    out.push_back({relation, a == b && a >= 2});
  }
  return out;
}

struct Samples {
  std::vector<Eigen::VectorXd> features;
  std::vector<double> answers, weights;
};

/// Least sum of half the squared weights and the losses times kLossWeight, features scaled to a
/// standard deviation of 1, by Newton's method. The first feature is one.
Eigen::VectorXd regress(const Samples& samples) {
  constexpr double kLossWeight = 0.1;
  constexpr int kRounds = 30;
  const Eigen::Index n = samples.features.empty() ? 1 : samples.features.front().size();
  const auto count = static_cast<double>(std::max<std::size_t>(1, samples.features.size()));
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n), deviation = Eigen::VectorXd::Zero(n);
  for (const Eigen::VectorXd& x : samples.features) mean += x / count;
  for (const Eigen::VectorXd& x : samples.features) deviation += (x - mean).cwiseAbs2() / count;
  deviation = deviation.cwiseSqrt();
  mean(0) = 0.0;
  deviation(0) = 1.0;
  const Eigen::VectorXd scale =
      (deviation.array() > 1e-9).select(deviation.array().max(1e-9).inverse(), 0.0);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < kRounds; ++round) {
    Eigen::VectorXd gradient = weights;
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Identity(n, n);
    for (std::size_t i = 0; i < samples.features.size(); ++i) {
      const Eigen::VectorXd x = (samples.features[i] - mean).cwiseProduct(scale);
      const double p = 1.0 / (1.0 + std::exp(-weights.dot(x)));
      const double w = kLossWeight * samples.weights[i];
      gradient += w * (p - samples.answers[i]) * x;
      curvature += w * p * (1.0 - p) * x * x.transpose();
    }
    weights -= curvature.ldlt().solve(gradient);
  }
  Eigen::VectorXd out = weights.cwiseProduct(scale);
  out(0) = weights(0) - out.tail(n - 1).dot(mean.tail(n - 1));
  return out;
}

template <std::size_t n>
Eigen::VectorXd vectorOf(const std::array<float, n>& values,
                         const std::array<RelationFeature, n>& features, bool with_colors) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const bool known = with_colors || !features[i].of_color;
    out(static_cast<Eigen::Index>(i)) = known ? static_cast<double>(values[i]) : 0.0;
  }
  return out;
}

RelationWeights trainWeights(const std::vector<const RelationExample*>& examples,
                             bool with_colors) {
  constexpr int kFullSize = 100;  // [pixel]; larger patches weigh no more
  Samples contact, bridge;
  for (const RelationExample* example : examples) {
    const PatchRelation& relation = example->relation;
    const auto add = [&](Samples& to, Eigen::VectorXd features) {
      to.features.push_back(std::move(features));
      to.answers.push_back(example->one_object ? 1.0 : 0.0);
      to.weights.push_back(static_cast<double>(std::min(relation.smaller, kFullSize)) / kFullSize);
    };
    if (relation.touches()) {
      add(contact, vectorOf(relation.contactFeatures(), kContactFeatures, with_colors));
    }
    if (relation.isBridged()) {
      add(bridge, vectorOf(relation.bridgeFeatures(), kBridgeFeatures, with_colors));
    }
  }
  RelationWeights out;
  const auto copy = [](const Samples& samples, auto& to) {
    if (samples.features.empty()) return;
    const Eigen::VectorXd weights = regress(samples);
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = weights(static_cast<Eigen::Index>(i));
  };
  copy(contact, out.contact);
  copy(bridge, out.bridge);
  return out;
}

}  // namespace

std::vector<LabelledCloud> readLabelledClouds(const std::vector<std::string>& folders) {
  std::vector<fs::path> paths;
  for (const std::string& folder : folders) {
    const std::size_t before = paths.size();
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
      if (entry->path().extension() == ".pcd") paths.push_back(entry->path());
    }
    if (error) throw hyselam::InputError(folder, "", "cannot be listed: " + error.message());
    if (paths.size() == before) throw hyselam::InputError(folder, "", "holds no .pcd file");
  }
  std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(a.filename(), a) < std::pair(b.filename(), b);
  });
  std::vector<LabelledCloud> out;
  for (const fs::path& path : paths) {
    LabelledCloud cloud{path.stem().string(), readPcd(path.string()), {}};
    if (cloud.file.labels.empty()) {
      throw hyselam::InputError(path.string(), "field label", "is missing");
    }
    cloud.examples = examplesOf(cloud.file);
    out.push_back(std::move(cloud));
  }
  return out;
}

RelationModel trainRelations(const std::vector<LabelledCloud>& clouds,
                             const std::function<bool(const LabelledCloud&)>& used) {
  std::vector<const RelationExample*> examples;
  for (const LabelledCloud& cloud : clouds) {
    if (!used(cloud)) continue;
    for (const RelationExample& example : cloud.examples) examples.push_back(&example);
  }
  RelationModel model;
  model.with_colors = trainWeights(examples, true);
  model.without_colors = trainWeights(examples, false);
  return model;
}

SegmentationScore scoreCloud(const LabelledCloud& cloud, const RelationModel& model,
                             bool with_colors) {
  OrganizedCloud plain;
  if (!with_colors) {
    plain = cloud.file.cloud;
    plain.colors.clear();
  }
  SegmentationScore score;
  addScore(segmentCloudBy(with_colors ? cloud.file.cloud : plain, {}, {}, model).labels,
           cloud.file.labels, score);
  return score;
}

}  // namespace hyselam_objects
