// How well labels agree with the truth of mOSD (parts of objects: 10 k ... 10 k + 9).
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace hyselam_objects {

/// 0 invalid, 1 support, 2 ... objects.
inline std::uint32_t objectOfPart(std::uint32_t label) {
  return label >= 10 ? label / 10 : std::min<std::uint32_t>(label, 1);
}

struct SegmentationScore {
  double iou_sum = 0.0;  ///< of the best overlap of each true object
  int objects = 0;
  int over = 0;   ///< segments beyond the first whose largest overlap is with the same object
  int under = 0;  ///< objects beyond the first that are best covered by the same segment
  SegmentationScore& operator+=(const SegmentationScore& other) {
    iou_sum += other.iou_sum;
    objects += other.objects;
    over += other.over;
    under += other.under;
    return *this;
  }
  double meanIou() const { return objects > 0 ? iou_sum / objects : 0.0; }
};

/// `found`: labels >= 2 are objects; `truth`: parts. Points without truth are left out.
inline void addScore(const std::vector<std::uint32_t>& found,
                     const std::vector<std::uint32_t>& truth, SegmentationScore& score) {
  std::map<std::uint32_t, int> truth_size, found_size;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> both;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::uint32_t t = objectOfPart(truth[i]), f = found[i];
    if (t == 0) continue;
    if (t >= 2) ++truth_size[t];
    if (f >= 2) ++found_size[f];
    if (f >= 2) ++both[{f, t}];
  }
  std::map<std::uint32_t, int> segments_of;  // by true object
  std::map<std::uint32_t, int> objects_of;   // by segment
  for (const auto& [f, size] : found_size) {
    std::uint32_t best = 0;
    int most = 0;
    for (const auto& [pair, count] : both) {
      if (pair.first == f && count > most) {
        most = count;
        best = pair.second;
      }
    }
    // Segments of the support or of the background are no part of an object.
    if (best >= 2 && 2 * most > size) ++segments_of[best];
  }
  for (const auto& [t, size] : truth_size) {
    double best = 0.0;
    std::uint32_t segment = 0;
    for (const auto& [pair, count] : both) {
      if (pair.second != t) continue;
      const double iou = static_cast<double>(count) / (size + found_size[pair.first] - count);
      if (iou > best) {
        best = iou;
        segment = pair.first;
      }
    }
    score.iou_sum += best;
    ++score.objects;
    if (segment != 0) ++objects_of[segment];
  }
  for (const auto& entry : segments_of) score.over += entry.second - 1;
  for (const auto& entry : objects_of) score.under += entry.second - 1;
}

}  // namespace hyselam_objects
