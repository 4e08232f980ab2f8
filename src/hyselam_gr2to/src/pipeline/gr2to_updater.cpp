#include "hyselam_gr2to/gr2to_updater.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <set>
#include <tuple>

#include "hyselam_common/errors.hpp"
#include "hyselam_gr2to/map_builder/doors.hpp"
#include "map_builder/place_builder.hpp"
#include "map_patch.hpp"

namespace hyselam_topo {

using hyselam::OccupancyGrid;
using hyselam::Pose2;

namespace {

constexpr double kTouch = 0.3;    // [m] around changed cells: whose places are there is touched
constexpr double kLeaks = 0.5;    // [m] around them, free cells without a place are looked at again
constexpr double kDoorRim = 0.3;  // [m] around the part: doors there are found again
constexpr double kDoors = 1.5;    // [m] around the part that is looked at to find them

cv::Rect grown(const cv::Rect& r, int by, const cv::Size& limit) {
  return cv::Rect(r.x - by, r.y - by, r.width + 2 * by, r.height + 2 * by) &
         cv::Rect({0, 0}, limit);
}

bool within(const cv::Rect& inner, const cv::Rect& outer) {
  return (inner & outer) == inner;
}

OccupancyGrid part(const OccupancyGrid& grid, const cv::Rect& box) {
  hyselam::GridGeometry g = grid.geometry;
  g.width = box.width;
  g.height = box.height;
  g.origin = grid.geometry.origin * Pose2{box.x * g.resolution, box.y * g.resolution, 0.0};
  OccupancyGrid out(g);
  for (int y = 0; y < box.height; ++y) {
    std::memcpy(&out.at({0, y}), &grid.cells[grid.geometry.index({box.x, box.y + y})],
                static_cast<std::size_t>(box.width));
  }
  return out;
}

std::set<int> labelsIn(const cv::Mat& labels, const cv::Rect& box) {
  std::set<int> out;
  std::uint16_t last = 0;
  for (int y = box.y; y < box.y + box.height; ++y) {
    const auto* row = labels.ptr<std::uint16_t>(y);
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (row[x] == last) continue;
      last = row[x];
      if (last != 0) out.insert(last);
    }
  }
  return out;
}

hyselam::Cell middleCell(const DoorLine& door, const hyselam::GridGeometry& g) {
  return g.cellAt({0.5 * (door.a.x + door.b.x), 0.5 * (door.a.y + door.b.y)});
}

}  // namespace

void UpdateParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("context", context, Range::atLeast(0.5), "m",
        "around a change that decide about its places");
  visit("max_share", max_share, Range::between(0.0, 1.0), "",
        "of the map that is segmented again; more is done from scratch");
}

void UpdateParams::validate() const {
  hyselam::checkParameters(*this);
}

Gr2ToUpdater::Gr2ToUpdater(const UpdateParams& params) : params_(params) {
  params.validate();
}

int Gr2ToUpdater::cellsIn(double meters) const {
  return static_cast<int>(std::ceil(meters * (1.0 / grid_.geometry.resolution)));
}

bool Gr2ToUpdater::sameAsBefore(const OccupancyGrid& grid, const Gr2ToParams& params) const {
  const auto& a = grid.geometry;
  const auto& b = grid_.geometry;
  const auto &p = params.segmentation, &q = used_.segmentation;
  return result_ && params.mode == Gr2ToParams::Mode::kDefault && params.mode == used_.mode &&
         p.free_max == q.free_max && p.working_resolution == q.working_resolution &&
         p.max_clutter_size == q.max_clutter_size && p.min_place_area == q.min_place_area &&
         p.border_model == q.border_model && a.width == b.width && a.height == b.height &&
         a.resolution == b.resolution && a.origin.x == b.origin.x && a.origin.y == b.origin.y &&
         a.origin.theta == b.origin.theta && grid.cells.size() == grid_.cells.size();
}

// Around all cells that changed from free, unknown, occupied or in between to another of these.
cv::Rect Gr2ToUpdater::changedBox(const OccupancyGrid& grid) const {
  const int free_max = used_.segmentation.free_max;
  const int occupied = mapBuilderParams(used_).walls.occupied_min;
  const auto kind = [&](int v) { return v < 0 ? 0 : v <= free_max ? 1 : v >= occupied ? 2 : 3; };
  cv::Rect box;
  for (int y = 0; y < grid.geometry.height; ++y) {
    const std::size_t start = grid.geometry.index({0, y});
    const std::int8_t *now = &grid.cells[start], *before = &grid_.cells[start];
    if (std::memcmp(now, before, static_cast<std::size_t>(grid.geometry.width)) == 0) continue;
    int first = -1, last = -1;
    for (int x = 0; x < grid.geometry.width; ++x) {
      if (now[x] == before[x] || kind(now[x]) == kind(before[x])) continue;
      if (first < 0) first = x;
      last = x;
    }
    if (first < 0) continue;
    const cv::Rect row(first, y, last - first + 1, 1);
    box = box.empty() ? row : box | row;
  }
  return box;
}

void Gr2ToUpdater::findBoxes() {
  const cv::Mat& labels = result_->labels;
  boxes_.assign(result_->map.places.size() + 1, cv::Rect());
  for (int y = 0; y < labels.rows; ++y) {
    const auto* row = labels.ptr<std::uint16_t>(y);
    for (int x = 0; x < labels.cols;) {
      const std::uint16_t label = row[x];
      const int first = x;
      while (x < labels.cols && row[x] == label) ++x;
      if (label == 0) continue;
      cv::Rect& box = boxes_[label];
      const cv::Rect run(first, y, x - first, 1);
      box = box.empty() ? run : box | run;
    }
  }
}

const Gr2ToResult& Gr2ToUpdater::update(const OccupancyGrid& grid, const Gr2ToParams& params) {
  if (sameAsBefore(grid, params)) {
    const cv::Rect changed = changedBox(grid);
    if (changed.empty()) {
      last_update_ = UpdateKind::kUnchanged;
      return *result_;
    }
    try {
      if (updatePart(grid, changed)) {
        last_update_ = UpdateKind::kPartial;
        return *result_;
      }
    } catch (...) {
      result_.reset();  // labels, doors and places may no longer fit each other
      throw;
    }
  }
  last_update_ = UpdateKind::kFromScratch;
  result_.reset();
  result_ = gr2to(grid, params);
  used_ = params;
  grid_ = grid;
  findBoxes();
  return *result_;
}

// Places that went leave gaps in the labels: the labels above them move down.
void Gr2ToUpdater::closeGaps(Patch& patch, Renewed& renewed) {
  const int places = renewed.places;
  std::vector<int> moved(static_cast<std::size_t>(places) + 1, 0);
  int count = 0;
  for (int label = 1; label <= places; ++label) {
    const bool went = patch.touched.count(label) != 0 && renewed.labels.count(label) == 0;
    moved[static_cast<std::size_t>(label)] = went ? 0 : ++count;
  }
  if (count == places) return;
  renewed.places = count;
  const auto now = [&](int label) { return moved[static_cast<std::size_t>(label)]; };
  const auto renamed = [&](const std::set<int>& labels) {
    std::set<int> out;
    for (const int label : labels) out.insert(now(label));
    return out;
  };
  patch.cut = renamed(patch.cut);
  renewed.labels = renamed(renewed.labels);
  for (int y = 0; y < result_->labels.rows; ++y) {
    auto* row = result_->labels.ptr<std::uint16_t>(y);
    for (int x = 0; x < result_->labels.cols; ++x) row[x] = static_cast<std::uint16_t>(now(row[x]));
  }
  std::vector<DoorLine> doors;
  for (DoorLine d : result_->doors) {
    d.place_a = now(d.place_a);
    d.place_b = now(d.place_b);
    if (d.place_a != 0 && d.place_b != 0) doors.push_back(d);
  }
  result_->doors = std::move(doors);
  std::vector<Place> kept;
  for (Place& place : result_->map.places) {
    const int label = now(static_cast<int>(place.id));
    if (label == 0) continue;
    place.id = static_cast<Id>(label);
    kept.push_back(std::move(place));
  }
  result_->map.places = std::move(kept);
  std::vector<cv::Rect> boxes(static_cast<std::size_t>(count) + 1);
  for (int label = 1; label <= places; ++label) {
    if (now(label) != 0) boxes[static_cast<std::size_t>(now(label))] = boxOf(label);
  }
  boxes_ = std::move(boxes);
}

// Around the change with its context, grown to whole places, the small ones first, as long as they
// do not make it large. Nothing if it is too large.
std::optional<Patch> Gr2ToUpdater::choosePatch(const cv::Rect& changed) const {
  const cv::Size size = result_->labels.size();
  const double max_area = params_.max_share * static_cast<double>(result_->labels.total());
  Patch patch;
  patch.box = grown(changed, cellsIn(params_.context), size);
  if (patch.box.area() > max_area) return std::nullopt;
  patch.touched = labelsIn(result_->labels, grown(changed, cellsIn(kTouch), size));
  std::vector<int> by_size(patch.touched.begin(), patch.touched.end());
  std::stable_sort(by_size.begin(), by_size.end(),
                   [&](int p, int q) { return boxOf(p).area() < boxOf(q).area(); });
  const double allowed = std::min(max_area, 2.0 * patch.box.area());
  for (const int label : by_size) {
    const cv::Rect with = patch.box | grown(boxOf(label), 2, size);
    if (with.area() <= allowed) patch.box = with;
  }
  for (const int label : by_size) {
    if (!within(boxOf(label), patch.box)) patch.cut.insert(label);
  }
  return patch;
}

// The part of the grid in which all that is not touched is wall.
OccupancyGrid Gr2ToUpdater::patchGrid(const OccupancyGrid& grid, const cv::Rect& changed,
                                      const Patch& patch) const {
  OccupancyGrid seen = part(grid, patch.box);
  const int free_max = used_.segmentation.free_max;
  const cv::Rect leaks = grown(changed, cellsIn(kLeaks), result_->labels.size());
  for (int y = 0; y < patch.box.height; ++y) {
    const auto* row = result_->labels.ptr<std::uint16_t>(patch.box.y + y) + patch.box.x;
    for (int x = 0; x < patch.box.width; ++x) {
      std::int8_t& value = seen.at({x, y});
      if (value < 0 || value > free_max) continue;
      if (row[x] == 0) {
        if (!leaks.contains({patch.box.x + x, patch.box.y + y})) value = OccupancyGrid::kUnknown;
      } else if (patch.touched.count(row[x]) == 0) {
        value = OccupancyGrid::kOccupied;
      }
    }
  }
  return seen;
}

// Puts the pieces of the patch into the labels. Nothing if they do not fit the places around: the
// labels are of no use then.
std::optional<Gr2ToUpdater::Renewed> Gr2ToUpdater::relabel(Patch& patch) {
  cv::Mat& labels = result_->labels;
  const int places_before = static_cast<int>(result_->map.places.size());
  RimJoin join = joinAtRim(labels, patch);
  labelByOverlap(labels, patch, places_before, join.label_of_piece);
  Renewed renewed;
  renewed.places = places_before;
  for (const auto& [piece, label] : join.label_of_piece) {
    renewed.labels.insert(label);
    renewed.places = std::max(renewed.places, label);
  }
  renewed.labels.insert(patch.cut.begin(), patch.cut.end());
  if (renewed.places > std::numeric_limits<std::uint16_t>::max()) return std::nullopt;

  const cv::Mat before = labels(patch.box).clone();
  for (int y = 0; y < patch.box.height; ++y) {
    auto* row = labels.ptr<std::uint16_t>(patch.box.y + y) + patch.box.x;
    const auto* piece = patch.pieces.labels.ptr<std::uint16_t>(y);
    for (int x = 0; x < patch.box.width; ++x) {
      if (row[x] != 0 && patch.touched.count(row[x]) == 0) continue;
      row[x] = piece[x] == 0 ? std::uint16_t{0}
                             : static_cast<std::uint16_t>(join.label_of_piece.at(piece[x]));
    }
  }
  for (const int label : join.doubtful) {
    if (!isConnected(labels, boxOf(label) | patch.box, label)) return std::nullopt;
  }
  const double cell_area = grid_.geometry.resolution * grid_.geometry.resolution;
  for (const int label : patch.cut) {
    result_->map.places[static_cast<std::size_t>(label - 1)].area +=
        cell_area *
        (cv::countNonZero(labels(patch.box) == label) - cv::countNonZero(before == label));
  }
  boxes_.resize(static_cast<std::size_t>(renewed.places) + 1);
  closeGaps(patch, renewed);
  return renewed;
}

// Doors in and around the part are found again, the others stay.
void Gr2ToUpdater::updateDoors(const OccupancyGrid& grid, const cv::Rect& box) {
  const cv::Size size = result_->labels.size();
  const cv::Rect door_box = grown(box, cellsIn(kDoorRim), size);
  const cv::Rect wide = grown(box, cellsIn(kDoors), size);
  DoorParams params;
  params.free_max = used_.segmentation.free_max;
  const auto inside = [&](const DoorLine& d) {
    const hyselam::Cell c = middleCell(d, grid.geometry);
    return door_box.contains({c.x, c.y});
  };
  std::vector<DoorLine> doors;
  for (const DoorLine& d : result_->doors) {
    if (!inside(d)) doors.push_back(d);
  }
  for (const DoorLine& d : refineDoors(part(grid, wide), result_->labels(wide), params)) {
    if (inside(d)) doors.push_back(d);
  }
  std::sort(doors.begin(), doors.end(), [](const DoorLine& p, const DoorLine& q) {
    return std::tie(p.place_a, p.place_b, p.a.x, p.a.y) <
           std::tie(q.place_a, q.place_b, q.a.x, q.a.y);
  });
  result_->doors = std::move(doors);
}

// Renewed places are built again; of those that are cut only walls and outline.
PlaceSelection Gr2ToUpdater::selectPlaces(const OccupancyGrid& grid, const Patch& patch,
                                          const Renewed& renewed) const {
  PlaceSelection selection;
  selection.wanted.assign(static_cast<std::size_t>(renewed.places) + 1, 0);
  selection.measured = selection.wanted;
  selection.measured_box = patch.box;
  selection.box = patch.box;
  for (const int label : renewed.labels) {
    selection.wanted[static_cast<std::size_t>(label)] = 1;
    if (patch.cut.count(label) == 0) {
      selection.measured[static_cast<std::size_t>(label)] = 1;
      continue;
    }
    selection.box = selection.box | boxOf(label);
    // Unless its center is where it no longer is.
    const auto& center = result_->map.places[static_cast<std::size_t>(label - 1)].centre;
    const hyselam::Cell c = center ? grid.geometry.cellAt({center->x, center->y}) : hyselam::Cell{};
    if (center && result_->labels.at<std::uint16_t>(c.y, c.x) == label) continue;
    selection.measured[static_cast<std::size_t>(label)] = 1;
    selection.measured_box = selection.measured_box | boxOf(label);
  }
  return selection;
}

void Gr2ToUpdater::updatePlaces(const OccupancyGrid& grid, const Patch& patch,
                                const Renewed& renewed) {
  const PlaceSelection selection = selectPlaces(grid, patch, renewed);
  std::vector<Place> built =
      buildPlaces(grid, result_->labels, renewed.places, neighborsOf(result_->doors),
                  mapBuilderParams(used_), selection);
  std::vector<Place> all = std::move(result_->map.places);
  for (Place& place : built) {
    const auto label = static_cast<int>(place.id);
    if (label > static_cast<int>(all.size())) {
      all.push_back(std::move(place));
      continue;
    }
    Place& old = all[static_cast<std::size_t>(label - 1)];
    if (selection.measured[place.id] == 0) {
      place.kind = old.kind;
      place.centre = old.centre;
      place.area = old.area;
    }
    old = std::move(place);
  }
  // Tight around what is there now; the rest of a place that is cut has not changed.
  for (const int label : renewed.labels) {
    boxOf(label) =
        patch.cut.count(label) != 0
            ? boxOf(label) | patch.box
            : cv::boundingRect(cv::Mat(result_->labels(patch.box) == label)) + patch.box.tl();
  }
  result_->map = assembleMap(grid, result_->labels, std::move(all), result_->doors);
}

bool Gr2ToUpdater::updatePart(const OccupancyGrid& grid, const cv::Rect& changed) {
  std::optional<Patch> patch = choosePatch(changed);
  if (!patch) return false;
  patch->pieces = segmentPlaces(patchGrid(grid, changed, *patch), used_.segmentation);
  const std::optional<Renewed> renewed = relabel(*patch);
  if (!renewed) return false;
  grid_ = grid;
  updateDoors(grid, patch->box);
  updatePlaces(grid, *patch, *renewed);
  result_->seconds.clear();
  return true;
}

}  // namespace hyselam_topo
