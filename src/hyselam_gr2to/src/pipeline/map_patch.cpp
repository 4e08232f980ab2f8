#include "map_patch.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace hyselam_topo {

std::set<int> joinAtRim(const cv::Mat& labels, const Patch& patch,
                        std::map<int, int>* piece_to_label) {
  std::map<std::pair<int, int>, int> common;  // of piece and label
  std::set<int> doubtful;
  int run_label = 0;
  bool run_met = true;
  const auto end_run = [&]() {
    if (!run_met) doubtful.insert(run_label);
    run_label = 0;
    run_met = true;
  };
  const auto look = [&](int x, int y, int ox, int oy) {
    if (ox < 0 || oy < 0 || ox >= labels.cols || oy >= labels.rows) return end_run();
    const int own = labels.at<std::uint16_t>(y, x), beyond = labels.at<std::uint16_t>(oy, ox);
    if (own == 0 || own != beyond || patch.touched.count(own) == 0) return end_run();
    if (own != run_label) {
      end_run();
      run_label = own;
      run_met = false;
    }
    const int piece = patch.pieces.labels.at<std::uint16_t>(y - patch.box.y, x - patch.box.x);
    if (piece == 0) return;
    run_met = true;
    ++common[{piece, own}];
  };
  const cv::Rect& b = patch.box;
  for (int x = b.x; x < b.x + b.width; ++x) look(x, b.y, x, b.y - 1);
  end_run();
  for (int x = b.x; x < b.x + b.width; ++x) look(x, b.y + b.height - 1, x, b.y + b.height);
  end_run();
  for (int y = b.y; y < b.y + b.height; ++y) look(b.x, y, b.x - 1, y);
  end_run();
  for (int y = b.y; y < b.y + b.height; ++y) look(b.x + b.width - 1, y, b.x + b.width, y);
  end_run();
  std::map<int, int> longest, pieces;
  for (const auto& [pair, cells] : common) {
    const auto& [piece, label] = pair;
    int& best = longest[piece];
    if (best > 0) {
      doubtful.insert(label);
      doubtful.insert((*piece_to_label)[piece]);
    }
    if (cells <= best) continue;
    best = cells;
    (*piece_to_label)[piece] = label;
  }
  for (const auto& [piece, label] : *piece_to_label) ++pieces[label];
  for (const int label : patch.cut) {
    if (pieces[label] != 1) doubtful.insert(label);
  }
  return doubtful;
}

bool inOnePart(const cv::Mat& labels, const cv::Rect& box, int label) {
  cv::Mat parts;
  return cv::connectedComponents(labels(box) == label, parts, 4) == 2;
}

void nameByOverlap(const cv::Mat& labels, const Patch& patch, int places,
                   std::map<int, int>* piece_to_label) {
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
        piece_to_label->count(pair.first) != 0) {
      continue;
    }
    (*piece_to_label)[pair.first] = pair.second;
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
    if (piece_to_label->count(piece) != 0) continue;
    (*piece_to_label)[piece] = next_spare < spare.size() ? spare[next_spare++] : ++next;
  }
}

}  // namespace hyselam_topo
