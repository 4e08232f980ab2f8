// Ceres on a pose graph: Levenberg-Marquardt on (x, y, theta) from the poses given, sparse
// Cholesky.
#include <ceres/ceres.h>
#include <time.h>

#include "peer.hpp"

namespace pose_graph_bench {

namespace {

/// e^T Omega e as squares: L^T e with Omega = L L^T.
struct EdgeResidual {
  Eigen::Matrix3d root;
  hyselam::Pose2 measured;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    using std::atan2;
    using std::cos;
    using std::sin;
    const T c = cos(a[2]), s = sin(a[2]);
    const T dx = b[0] - a[0], dy = b[1] - a[1];
    const T px = c * dx + s * dy - measured.x, py = -s * dx + c * dy - measured.y;
    const double mc = std::cos(measured.theta), ms = std::sin(measured.theta);
    const T turn = b[2] - a[2] - measured.theta;
    const T e[3] = {mc * px + ms * py, -ms * px + mc * py, atan2(sin(turn), cos(turn))};
    for (int r = 0; r < 3; ++r)
      residual[r] = root(r, 0) * e[0] + root(r, 1) * e[1] + root(r, 2) * e[2];
    return true;
  }
};

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

std::vector<PeerRun> runCeres(const hyselam_pose_graph::PoseGraph& graph) {
  std::vector<PeerRun> runs;
  // The second is next to Gauss-Newton: hardly any damping to begin with.
  for (const double radius : {1e4, 1e12}) {
    std::vector<Eigen::Vector3d> poses;
    for (const hyselam::Pose2& p : graph.poses) poses.emplace_back(p.x, p.y, p.theta);
    ceres::Problem problem;
    for (const auto& edge : graph.edges) {
      const Eigen::Matrix3d root = edge.information.llt().matrixL().transpose();
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EdgeResidual, 3, 3, 3>(
                                   new EdgeResidual{root, edge.measured}),
                               nullptr, poses[static_cast<std::size_t>(edge.from)].data(),
                               poses[static_cast<std::size_t>(edge.to)].data());
    }
    problem.SetParameterBlockConstant(poses.front().data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 100;
    options.initial_trust_region_radius = radius;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    ceres::Solver::Summary summary;
    PeerRun run;
    run.peer = "ceres";
    run.setting = radius > 1e10 ? "LM, undamped at first" : "LM";
    const double begin = cpuSeconds();
    ceres::Solve(options, &problem, &summary);
    run.seconds = cpuSeconds() - begin;
    run.iterations = static_cast<int>(summary.iterations.size()) - 1;
    std::vector<hyselam::Pose2> solved;
    for (const Eigen::Vector3d& p : poses) solved.push_back({p[0], p[1], p[2]});
    run.cost = hyselam_pose_graph::graphCost(graph, solved);
    runs.push_back(run);
  }
  return runs;
}

}  // namespace pose_graph_bench
