#include "map_patch.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace hyselam_topo {

namespace {

/// Goes along the rim of a patch: which pieces touch which labels beyond it.
class RimWalk {
 public:
  RimWalk(const cv::Mat& labels, const Patch& patch) : labels_(labels), patch_(patch) {
    const cv::Rect& b = patch.box;
    const int right = b.x + b.width - 1, top = b.y + b.height - 1;
    for (int x = b.x; x <= right; ++x) visit({x, b.y}, {x, b.y - 1});
    endRun();
    for (int x = b.x; x <= right; ++x) visit({x, top}, {x, top + 1});
    endRun();
    for (int y = b.y; y <= top; ++y) visit({b.x, y}, {b.x - 1, y});
    endRun();
    for (int y = b.y; y <= top; ++y) visit({right, y}, {right + 1, y});
    endRun();
  }

  std::map<std::pair<int, int>, int> common;  ///< cells of (piece, label) side by side
  std::set<int> lost;                         ///< labels with a run of the rim without a piece

 private:
  void endRun() {
    if (!run_met_) lost.insert(run_label_);
    run_label_ = 0;
    run_met_ = true;
  }

  void visit(cv::Point inside, cv::Point beyond) {
    if (!cv::Rect({0, 0}, labels_.size()).contains(beyond)) return endRun();
    const int own = labels_.at<std::uint16_t>(inside);
    if (own == 0 || own != labels_.at<std::uint16_t>(beyond) || patch_.touched.count(own) == 0) {
      return endRun();
    }
    if (own != run_label_) {
      endRun();
      run_label_ = own;
      run_met_ = false;
    }
    const int piece = patch_.pieces.labels.at<std::uint16_t>(inside - patch_.box.tl());
    if (piece == 0) return;
    run_met_ = true;
    ++common[{piece, own}];
  }

  const cv::Mat& labels_;
  const Patch& patch_;
  int run_label_ = 0;
  bool run_met_ = true;
};

}  // namespace

RimJoin joinAtRim(const cv::Mat& labels, const Patch& patch) {
  const RimWalk rim(labels, patch);
  RimJoin join;
  join.doubtful = rim.lost;
  std::map<int, int> longest, pieces;
  for (const auto& [pair, cells] : rim.common) {
    const auto& [piece, label] = pair;
    int& best = longest[piece];
    if (best > 0) {
      join.doubtful.insert(label);
      join.doubtful.insert(join.label_of_piece[piece]);
    }
    if (cells <= best) continue;
    best = cells;
    join.label_of_piece[piece] = label;
  }
  for (const auto& [piece, label] : join.label_of_piece) ++pieces[label];
  for (const int label : patch.cut) {
    if (pieces[label] != 1) join.doubtful.insert(label);
  }
  return join;
}

bool isConnected(const cv::Mat& labels, const cv::Rect& box, int label) {
  cv::Mat parts;
  return cv::connectedComponents(labels(box) == label, parts, 4) == 2;
}

void labelByOverlap(const cv::Mat& labels, const Patch& patch, int places,
                    LabelOfPiece& label_of_piece) {
  std::map<std::pair<int, int>, int> overlap;
  for (int y = 0; y < patch.box.height; ++y) {
    const auto* piece = patch.pieces.labels.ptr<std::uint16_t>(y);
    const auto* label = labels.ptr<std::uint16_t>(patch.box.y + y) + patch.box.x;
    for (int x = 0; x < patch.box.width; ++x) {
      if (piece[x] != 0 && label[x] != 0) ++overlap[{piece[x], label[x]}];
    }
  }
  std::vector<std::pair<int, std::pair<int, int>>> pairs;
  pairs.reserve(overlap.size());
  for (const auto& [pair, cells] : overlap) pairs.push_back({cells, pair});
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& p, const auto& q) { return p.first > q.first; });
  std::set<int> used = patch.cut;
  for (const auto& [cells, pair] : pairs) {
    if (patch.touched.count(pair.second) == 0 || used.count(pair.second) != 0 ||
        label_of_piece.count(pair.first) != 0) {
      continue;
    }
    label_of_piece[pair.first] = pair.second;
    used.insert(pair.second);
  }
  // New places take the labels that went, then new ones.
  std::vector<int> spare;
  for (const int label : patch.touched) {
    if (used.count(label) == 0) spare.push_back(label);
  }
  std::size_t next_spare = 0;
  int next = places;
  for (int piece = 1; piece <= patch.pieces.places; ++piece) {
    if (label_of_piece.count(piece) != 0) continue;
    label_of_piece[piece] = next_spare < spare.size() ? spare[next_spare++] : ++next;
  }
}

}  // namespace hyselam_topo
