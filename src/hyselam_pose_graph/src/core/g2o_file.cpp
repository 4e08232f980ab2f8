#include "hyselam_pose_graph/g2o_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"

namespace hyselam_pose_graph {

namespace {

using hyselam::InputError;
using Fields = std::vector<std::string_view>;

struct IdEdge {
  std::int64_t from, to;
  PoseEdge edge;
};

/// Parses the lines of one file; its errors name file and line.
class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {}

  void take(std::size_t line, std::string_view text) {
    line_ = line;
    hyselam::splitFields(text.substr(0, text.find('#')), &fields_);
    if (fields_.empty()) return;
    const std::string_view tag = fields_[0];
    if (tag == "VERTEX_SE2") {
      const auto v = numbers<3>(1);
      if (!vertices_.emplace(id(1), hyselam::Pose2{v[0], v[1], hyselam::normalizeAngle(v[2])})
               .second)
        fail("pose " + std::string(fields_[1]) + " is given twice");
    } else if (tag == "EDGE_SE2") {
      const auto v = numbers<9>(2);
      IdEdge e{id(1), id(2), {}};
      e.edge.measured = {v[0], v[1], hyselam::normalizeAngle(v[2])};
      e.edge.information << v[3], v[4], v[5], v[4], v[6], v[7], v[5], v[7], v[8];
      check(e);
      edges_.push_back(e);
    } else if (tag == "FIX") {
      for (std::size_t i = 1; i < fields_.size(); ++i) id(i);
    } else {
      fail("'" + hyselam::printable(tag) +
           "' is none of VERTEX_SE2, EDGE_SE2, FIX: only graphs of the plane can be read");
    }
  }

  PoseGraph finish() const {
    const bool bare = vertices_.empty();
    std::map<std::int64_t, hyselam::Pose2> all = vertices_;
    for (const IdEdge& e : edges_)
      for (const std::int64_t id : {e.from, e.to}) all.emplace(id, hyselam::Pose2{});
    if (all.empty()) throw InputError(path_, "", "holds no pose");
    PoseGraph graph;
    std::map<std::int64_t, int> index;
    for (const auto& [id, pose] : all) {
      index[id] = static_cast<int>(graph.ids.size());
      graph.ids.push_back(id);
      graph.poses.push_back(pose);
    }
    for (const IdEdge& e : edges_) {
      graph.edges.push_back(e.edge);
      graph.edges.back().from = index.at(e.from);
      graph.edges.back().to = index.at(e.to);
    }
    if (bare) graph.poses = composedPoses(graph);
    return graph;
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(path_, "line " + std::to_string(line_), reason);
  }

  double number(std::size_t field) const {
    if (field >= fields_.size())
      fail(std::string(fields_[0]) + " has " + std::to_string(fields_.size() - 1) +
           " numbers, too few");
    const std::optional<double> v = hyselam::parseNumber(fields_[field]);
    if (!v) fail("'" + hyselam::printable(fields_[field]) + "' is not a finite number");
    return *v;
  }
  std::int64_t id(std::size_t field) const {
    const double v = number(field);
    if (v != std::floor(v) || std::abs(v) > 9e15)
      fail("'" + hyselam::printable(fields_[field]) + "' is not the number of a pose");
    return static_cast<std::int64_t>(v);
  }
  /// N numbers after `names` names of poses, and nothing else.
  template <std::size_t N>
  std::array<double, N> numbers(std::size_t names) const {
    std::array<double, N> v{};
    for (std::size_t i = 0; i < N; ++i) v[i] = number(1 + names + i);
    if (fields_.size() != 1 + names + N)
      fail(std::string(fields_[0]) + " has " + std::to_string(fields_.size() - 1) +
           " numbers, not " + std::to_string(names + N));
    return v;
  }
  void check(const IdEdge& e) const {
    if (e.from == e.to) fail("the edge connects pose " + std::to_string(e.from) + " to itself");
    PoseGraph pair{{0, 1}, {{}, {}}, {e.edge}};
    pair.edges[0].from = 0;
    pair.edges[0].to = 1;
    try {
      pair.validate();
    } catch (const InputError&) {
      fail("the information is not positive semidefinite");
    }
  }

  std::string path_;
  std::size_t line_ = 0;
  Fields fields_;
  std::map<std::int64_t, hyselam::Pose2> vertices_;
  std::vector<IdEdge> edges_;
};

}  // namespace

PoseGraph readG2o(const std::string& path) {
  const std::string text = hyselam::readTextFile(path);
  Reader reader(path);
  hyselam::forEachLine(
      text, [&](std::size_t line, std::string_view content) { reader.take(line, content); });
  return reader.finish();
}

void writeG2o(const std::string& path, const PoseGraph& graph) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    const auto put = [&](double v) { out << ' ' << hyselam::formatNumber(v); };
    for (std::size_t i = 0; i < graph.poses.size(); ++i) {
      out << "VERTEX_SE2 " << graph.ids[i];
      put(graph.poses[i].x);
      put(graph.poses[i].y);
      put(graph.poses[i].theta);
      out << '\n';
    }
    for (const PoseEdge& e : graph.edges) {
      out << "EDGE_SE2 " << graph.ids[static_cast<std::size_t>(e.from)] << ' '
          << graph.ids[static_cast<std::size_t>(e.to)];
      put(e.measured.x);
      put(e.measured.y);
      put(e.measured.theta);
      for (int r = 0; r < 3; ++r)
        for (int c = r; c < 3; ++c) put(e.information(r, c));
      out << '\n';
    }
  });
}

}  // namespace hyselam_pose_graph
