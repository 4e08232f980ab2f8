#include "loop_company.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <optional>

namespace hyselam_pose_graph {

namespace {

using hyselam::Pose2;

constexpr double kMedian = 2.366;  // of chi^2 with three degrees of freedom

/// A relative pose and the covariance of its error, in the frame it leads to.
struct Step {
  Pose2 pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// How an error in the frame before `p` shows in the frame after it.
Eigen::Matrix3d carried(const Pose2& p) {
  const Pose2 back = p.inverse();
  const double c = std::cos(back.theta), s = std::sin(back.theta);
  Eigen::Matrix3d a;
  a << c, -s, back.y, s, c, -back.x, 0.0, 0.0, 1.0;
  return a;
}

Step operator*(const Step& a, const Step& b) {
  const Eigen::Matrix3d m = carried(b.pose);
  return {a.pose * b.pose, m * a.covariance * m.transpose() + b.covariance};
}

Step inverse(const Step& a) {
  const Eigen::Matrix3d m = carried(a.pose.inverse());
  return {a.pose.inverse(), m * a.covariance * m.transpose()};
}

std::optional<Step> stepOf(const PoseEdge& edge) {
  const Eigen::LDLT<Eigen::Matrix3d> solver(edge.information);
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0.0)) return {};
  return Step{edge.measured, solver.solve(Eigen::Matrix3d::Identity())};
}

class Chain {
 public:
  explicit Chain(const PoseGraph& graph) : steps_(graph.poses.size()) {
    for (const PoseEdge& edge : graph.edges) {
      if (!isOdometry(edge)) continue;
      const std::optional<Step> step = stepOf(edge);
      const bool forward = edge.to == edge.from + 1;
      auto& place = steps_[static_cast<std::size_t>(std::min(edge.from, edge.to))];
      if (step && !place) place = forward ? *step : inverse(*step);
    }
  }
  /// Along odometry from a pose to those up to `reach` after it, itself first; shorter where
  /// odometry ends.
  std::vector<Step> after(int pose, int reach) const {
    std::vector<Step> way(1);
    for (int i = pose; i < pose + reach && i + 1 < static_cast<int>(steps_.size()); ++i) {
      const auto& step = steps_[static_cast<std::size_t>(i)];
      if (!step) break;
      way.push_back(way.back() * *step);
    }
    return way;
  }

 private:
  std::vector<std::optional<Step>> steps_;  ///< from each pose to the next
};

/// A loop from the lower of its poses to the higher.
struct Loop {
  std::size_t edge;
  int from, to;
  Step step;
};

double squaredError(const Step& a, const Step& b) {
  const Step e = inverse(a) * b;
  const Eigen::Vector3d v(e.pose.x, e.pose.y, e.pose.theta);
  return v.dot(e.covariance.ldlt().solve(v));
}

}  // namespace

LoopCompany findCompany(const PoseGraph& graph, double limit, int reach) {
  LoopCompany company;
  company.companions.assign(graph.edges.size(), 0);
  const Chain chain(graph);
  std::vector<Loop> loops;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const PoseEdge& edge = graph.edges[k];
    if (isOdometry(edge)) continue;
    const std::optional<Step> step = stepOf(edge);
    if (!step) continue;
    const bool forward = edge.from < edge.to;
    loops.push_back({k, std::min(edge.from, edge.to), std::max(edge.from, edge.to),
                     forward ? *step : inverse(*step)});
  }
  std::stable_sort(loops.begin(), loops.end(),
                   [](const Loop& a, const Loop& b) { return a.from < b.from; });
  // The way from each loop's higher pose onward, as far as it is asked for.
  std::vector<std::vector<Step>> onward(graph.poses.size());
  const auto between = [&](int a, int b) -> std::optional<Step> {
    const int low = std::min(a, b), high = std::max(a, b);
    std::vector<Step>& way = onward[static_cast<std::size_t>(low)];
    if (way.empty()) way = chain.after(low, reach);
    const auto n = static_cast<std::size_t>(high - low);
    if (n >= way.size()) return {};
    return a <= b ? way[n] : inverse(way[n]);
  };
  std::vector<double> errors;
  for (std::size_t i = 0; i < loops.size(); ++i)
    for (std::size_t j = i + 1; j < loops.size() && loops[j].from - loops[i].from <= reach; ++j) {
      const Loop &a = loops[i], &b = loops[j];
      if (std::abs(a.to - b.to) > reach) continue;
      const auto start = between(a.from, b.from), end = between(a.to, b.to);
      if (!start || !end) continue;
      const double error = squaredError(a.step * *end, *start * b.step);
      if (!(error <= limit)) continue;
      errors.push_back(error);
      ++company.companions[a.edge];
      ++company.companions[b.edge];
    }
  if (!errors.empty()) {
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    company.scale = *middle / kMedian;
  }
  return company;
}

}  // namespace hyselam_pose_graph
