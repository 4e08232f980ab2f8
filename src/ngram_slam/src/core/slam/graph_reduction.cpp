#include "ngram_slam/slam/graph_reduction.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::Pose2;
using hyselam_pose_graph::PoseEdge;

namespace {

using Matrix = Eigen::Matrix3d;
using Vector = Eigen::Vector3d;

Matrix symmetric(const Matrix& m) {
  return 0.5 * (m + m.transpose());
}

Eigen::Matrix2d rotation(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Eigen::Matrix2d r;
  r << c, -s, s, c;
  return r;
}

/// An edge at the given poses: W and f of the difference of the motions of its ends. Motions are
/// (dx, dy, dtheta) in the axes of the map, turning about one point for all edges.
struct Spring {
  Matrix weight = Matrix::Zero();
  Vector force = Vector::Zero();  // on `to`; the opposite on `from`
};

/// From motions about one point to those about a point that lies `x`, `y` beside it.
Matrix shift(double x, double y) {
  Matrix m = Matrix::Identity();
  m(0, 2) = -y;
  m(1, 2) = x;
  return m;
}

class Springs {
 public:
  explicit Springs(const std::vector<Pose2>& poses) : poses_(poses) {
    // Numbers stay small about the middle of the map.
    double x0 = 0.0, x1 = 0.0, y0 = 0.0, y1 = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      x0 = i == 0 ? poses[i].x : std::min(x0, poses[i].x);
      x1 = i == 0 ? poses[i].x : std::max(x1, poses[i].x);
      y0 = i == 0 ? poses[i].y : std::min(y0, poses[i].y);
      y1 = i == 0 ? poses[i].y : std::max(y1, poses[i].y);
    }
    x_ = 0.5 * (x0 + x1);
    y_ = 0.5 * (y0 + y1);
  }

  Spring of(const PoseEdge& edge) const {
    const Pose2 &from = at(edge.from), &to = at(edge.to);
    const Eigen::Matrix2d turn = rotation(from.theta + edge.measured.theta).transpose();
    Matrix j = Matrix::Identity();
    j.topLeftCorner<2, 2>() = turn;
    j = (j * shift(to.x - x_, to.y - y_)).eval();
    const Matrix information = symmetric(edge.information);
    Spring s;
    s.weight = symmetric(j.transpose() * information * j);
    s.force = j.transpose() * information * edgeError(edge, from, to);
    return s;
  }

  /// The edge that of() makes the spring of.
  PoseEdge edge(int from, int to, const Spring& spring) const {
    const Pose2 &a = at(from), &b = at(to);
    const Matrix back = shift(x_ - b.x, y_ - b.y);  // about the end instead of the middle
    const Matrix weight = symmetric(back.transpose() * spring.weight * back);
    const Vector motion = weight.ldlt().solve(back.transpose() * spring.force);
    PoseEdge e;
    e.from = from;
    e.to = to;
    e.measured.theta = hyselam::normalizeAngle(b.theta - a.theta - motion.z());
    const Eigen::Matrix2d turn = rotation(a.theta + e.measured.theta).transpose();
    const Eigen::Vector2d apart(b.x - a.x, b.y - a.y);
    const Eigen::Vector2d measured =
        rotation(a.theta).transpose() * (apart - Eigen::Vector2d(motion.head<2>()));
    e.measured.x = measured.x();
    e.measured.y = measured.y();
    Matrix j = Matrix::Identity();
    j.topLeftCorner<2, 2>() = turn;
    e.information = symmetric(j * weight * j.transpose());
    return e;
  }

 private:
  const Pose2& at(int i) const { return poses_[static_cast<std::size_t>(i)]; }

  const std::vector<Pose2>& poses_;
  double x_ = 0.0, y_ = 0.0;  // about which motions turn [m]
};

/// The weight of two springs in a row: the inverse of the sum of their covariances.
Matrix inRow(const Matrix& a, const Matrix& b) {
  return symmetric(a * (a + b).ldlt().solve(b));
}

[[noreturn]] void refuse(const PoseEdge& e) {
  throw hyselam::InputError("graph",
                            "edge from " + std::to_string(e.from) + " to " + std::to_string(e.to),
                            "has an information without inverse: its poses cannot be taken out");
}

/// Poses, dropped ones and their neighbors, with the springs between them.
class Network {
 public:
  Network(const std::vector<Pose2>& poses, const std::vector<ReducedEdge>& edges,
          const std::vector<bool>& dropped)
      : springs_(poses), dropped_(dropped), links_(poses.size()) {
    for (const ReducedEdge& e : edges) {
      if (!isDropped(e.edge.from) && !isDropped(e.edge.to)) continue;
      if (!isInvertible(e.edge)) refuse(e.edge);
      connect(e.edge.from, e.edge.to, springs_.of(e.edge), e.odometry);
    }
  }

  /// Takes out all dropped poses, those with the fewest neighbors first: few are then changed by
  /// each.
  void eliminate() {
    using Open = std::pair<std::size_t, int>;
    std::priority_queue<Open, std::vector<Open>, std::greater<Open>> open;
    const auto push = [&](int i) {
      if (isDropped(i)) open.push({linksOf(i).size(), i});
    };
    for (std::size_t i = 0; i < links_.size(); ++i) push(static_cast<int>(i));
    std::vector<bool> done(links_.size(), false);
    while (!open.empty()) {
      const auto [degree, i] = open.top();
      open.pop();
      const auto here = static_cast<std::size_t>(i);
      if (done[here] || degree != linksOf(i).size()) continue;
      done[here] = true;
      const auto links = std::move(links_[here]);
      links_[here].clear();
      for (const auto& [other, link] : links) linksOf(other).erase(i);
      replace(links);
      for (const auto& [other, link] : links) push(other);
    }
  }

  std::vector<ReducedEdge> edges() const {
    std::vector<ReducedEdge> out;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      for (const auto& [other, link] : links_[i]) {
        const auto from = static_cast<int>(i);
        if (from > other) continue;
        if (link.has_odometry) out.push_back({springs_.edge(from, other, link.odometry), true});
        if (link.has_other) out.push_back({springs_.edge(from, other, link.other), false});
      }
    }
    return out;
  }

 private:
  /// All springs to a neighbor, side by side; odometry stays apart, as nothing weakens it later.
  struct Link {
    Spring odometry, other;  // forces on the neighbor
    bool has_odometry = false, has_other = false;

    Spring sum() const { return {odometry.weight + other.weight, odometry.force + other.force}; }
  };
  using Links = std::map<int, Link>;

  bool isDropped(int i) const { return dropped_[static_cast<std::size_t>(i)]; }
  Links& linksOf(int i) { return links_[static_cast<std::size_t>(i)]; }

  static void addTo(Link* link, const Spring& s, double sign, bool odometry) {
    (odometry ? link->has_odometry : link->has_other) = true;
    Spring& sum = odometry ? link->odometry : link->other;
    sum.weight += s.weight;
    sum.force += sign * s.force;
  }
  void connect(int from, int to, const Spring& s, bool odometry) {
    addTo(&linksOf(from)[to], s, 1.0, odometry);
    addTo(&linksOf(to)[from], s, -1.0, odometry);
  }

  /// Connects the neighbors of a pose that was taken out: all with the one that knows its place
  /// best.
  void replace(const Links& links) {
    if (links.size() < 2) return;
    Matrix weight = Matrix::Zero();
    Vector force = Vector::Zero();
    int best = -1;
    double best_determinant = 0.0;
    for (const auto& [other, link] : links) {
      const Spring s = link.sum();
      weight += s.weight;
      force += s.force;
      const double determinant = s.weight.determinant();
      if (best < 0 || determinant > best_determinant) {
        best = other;
        best_determinant = determinant;
      }
    }
    const Vector motion = weight.ldlt().solve(force);  // of the pose, where nothing pulls it
    const Link& to_best = links.at(best);
    const Matrix best_weight = to_best.sum().weight;
    for (const auto& [other, link] : links) {
      if (other == best) continue;
      const Spring s = link.sum();
      connect(best, other, {inRow(s.weight, best_weight), s.force - s.weight * motion},
              links.size() == 2 && isOdometry(link) && isOdometry(to_best));
    }
  }
  static bool isOdometry(const Link& l) { return l.has_odometry && !l.has_other; }

  Springs springs_;
  const std::vector<bool>& dropped_;
  std::vector<Links> links_;
};

}  // namespace

bool isInvertible(const PoseEdge& edge) {
  if (!edge.information.allFinite()) return false;
  const Eigen::LDLT<Matrix> ldlt(symmetric(edge.information));
  const Vector d = ldlt.vectorD();
  return ldlt.info() == Eigen::Success && d.minCoeff() > 1e-12 * std::max(1.0, d.maxCoeff());
}

std::vector<ReducedEdge> marginalizedEdges(const std::vector<Pose2>& poses,
                                           const std::vector<ReducedEdge>& edges,
                                           const std::vector<bool>& dropped) {
  Network network(poses, edges, dropped);
  network.eliminate();
  return network.edges();
}

PoseEdge composedEdge(const std::vector<Pose2>& poses, const std::vector<PathStep>& path) {
  if (path.empty()) throw hyselam::InputError("graph", "", "a path has no edge");
  const Springs springs(poses);
  Matrix covariance = Matrix::Zero();
  Vector error = Vector::Zero();
  for (const PathStep& step : path) {
    if (!isInvertible(step.edge)) refuse(step.edge);
    const Spring s = springs.of(step.edge);
    covariance += s.weight.inverse();
    error += (step.backward ? -1.0 : 1.0) * s.weight.ldlt().solve(s.force);
  }
  Spring sum;
  sum.weight = symmetric(covariance.inverse());
  sum.force = sum.weight * error;
  const PathStep &first = path.front(), &last = path.back();
  return springs.edge(first.backward ? first.edge.to : first.edge.from,
                      last.backward ? last.edge.from : last.edge.to, sum);
}

PoseEdge meanEdge(const std::vector<Pose2>& poses, const std::vector<PoseEdge>& edges) {
  if (edges.empty()) throw hyselam::InputError("graph", "", "no edge has no mean");
  const Springs springs(poses);
  // A length of information: the same about whatever point.
  const auto size = [](const Matrix& weight) { return std::cbrt(weight.determinant()); };
  Spring sum;
  double largest = 0.0;
  for (const PoseEdge& e : edges) {
    const Spring s = springs.of(e);
    sum.weight += s.weight;
    sum.force += s.force;
    largest = std::max(largest, size(s.weight));
  }
  const double scale = largest / size(sum.weight);
  sum.weight *= scale;
  sum.force *= scale;
  return springs.edge(edges.front().from, edges.front().to, sum);
}

}  // namespace ngram_slam
