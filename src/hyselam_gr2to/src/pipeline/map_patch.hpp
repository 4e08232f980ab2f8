// A part of a segmented map that is segmented again, and how its pieces join what lies around it.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <set>

#include "hyselam_gr2to/segmentation/place_segmentation.hpp"

namespace hyselam_topo {

/// The part that is segmented again, before and after.
struct Patch {
  cv::Rect box;
  std::set<int> touched;  ///< labels that may change in it
  std::set<int> cut;      ///< those of them that go on outside of it
  PlaceSegmentation pieces;
};

/// Which label each piece of a patch gets.
using LabelOfPiece = std::map<int, int>;

/// What joinAtRim() finds.
struct RimJoin {
  LabelOfPiece label_of_piece;
  /// The places whose rest may have come apart: those with other than one piece, with a part of
  /// the rim lost, or that left a piece to another.
  std::set<int> doubtful;
};

/// Pieces that touch the rest of a place outside of the box belong to it; if they touch several, to
/// the one with the longest common rim.
RimJoin joinAtRim(const cv::Mat& labels, const Patch& patch);

/// Whether the cells of a label in a box are connected.
bool isConnected(const cv::Mat& labels, const cv::Rect& box, int label);

/// The other pieces get the label of the place that they overlap most, each label once, or a new
/// one beyond `places`.
void labelByOverlap(const cv::Mat& labels, const Patch& patch, int places,
                    LabelOfPiece& label_of_piece);

}  // namespace hyselam_topo
