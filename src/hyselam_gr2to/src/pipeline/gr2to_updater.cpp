#include "hyselam_gr2to/gr2to_updater.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_gr2to/map_builder/doors.hpp"
#include "map_builder/place_builder.hpp"
#include "map_patch.hpp"

namespace hyselam_topo {

using hyselam::OccupancyGrid;
using hyselam::Pose2;

namespace {

constexpr double kTouch = 0.3;  // [m] around changed cells: whose places are there is touched
constexpr double kLeaks = 0.5;  // [m] around them, free cells without a place are looked at again
constexpr double kDoors = 1.5;  // [m] around the part that is looked at, to find doors at its rim

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

Gr2ToUpdater::Gr2ToUpdater(const UpdateParams& params) : params_(params) {
  if (!(params.context >= 0.5)) {
    throw hyselam::ParameterError("update_context", params.context, ">= 0.5 m");
  }
  if (!(params.largest >= 0.0 && params.largest <= 1.0)) {
    throw hyselam::ParameterError("update_largest", params.largest, "within 0 .. 1");
  }
}

bool Gr2ToUpdater::sameAsBefore(const OccupancyGrid& grid, const Gr2ToParams& params) const {
  const auto& a = grid.geometry;
  const auto& b = grid_.geometry;
  const auto &p = params.segmentation, &q = used_.segmentation;
  return result_ && params.mode == Gr2ToParams::Mode::kDefault && params.mode == used_.mode &&
         p.free_max == q.free_max && p.working_resolution == q.working_resolution &&
         p.clutter == q.clutter && p.smallest_place == q.smallest_place && a.width == b.width &&
         a.height == b.height && a.resolution == b.resolution && a.origin.x == b.origin.x &&
         a.origin.y == b.origin.y && a.origin.theta == b.origin.theta &&
         grid.cells.size() == grid_.cells.size();
}

// Around all cells that changed from free, unknown, occupied or in between to another of these.
cv::Rect Gr2ToUpdater::changedBox(const OccupancyGrid& grid) const {
  const int free_max = used_.segmentation.free_max;
  const int occupied = std::max(WallParams().occupied_min, free_max + 1);
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
      way_ = Way::kUnchanged;
      return *result_;
    }
    try {
      if (updatePart(grid, changed)) {
        way_ = Way::kPartial;
        return *result_;
      }
    } catch (...) {
      result_.reset();  // labels, doors and places may no longer fit each other
      throw;
    }
  }
  way_ = Way::kFromScratch;
  result_.reset();
  result_ = gr2to(grid, params);
  used_ = params;
  grid_ = grid;
  findBoxes();
  return *result_;
}

// Places that went leave gaps in the labels: the labels above them move down.
int Gr2ToUpdater::closeGaps(const std::set<int>& touched, std::set<int>* cut,
                            std::set<int>* renewed, int places) {
  std::vector<int> moved(static_cast<std::size_t>(places) + 1, 0);
  int count = 0;
  for (int label = 1; label <= places; ++label) {
    const bool went = touched.count(label) != 0 && renewed->count(label) == 0;
    moved[static_cast<std::size_t>(label)] = went ? 0 : ++count;
  }
  if (count == places) return places;
  const auto now = [&](int label) { return moved[static_cast<std::size_t>(label)]; };
  const auto rename = [&](std::set<int>* labels) {
    std::set<int> out;
    for (const int label : *labels) out.insert(now(label));
    *labels = out;
  };
  rename(cut);
  rename(renewed);
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
    if (now(label) != 0) {
      boxes[static_cast<std::size_t>(now(label))] = boxes_[static_cast<std::size_t>(label)];
    }
  }
  boxes_ = std::move(boxes);
  return count;
}

bool Gr2ToUpdater::updatePart(const OccupancyGrid& grid, const cv::Rect& changed) {
  const double cells = 1.0 / grid.geometry.resolution;
  const cv::Mat& labels = result_->labels;
  const auto in_cells = [&](double metres) { return static_cast<int>(std::ceil(metres * cells)); };
  const double most = params_.largest * static_cast<double>(labels.total());

  Patch patch;
  patch.box = grown(changed, in_cells(params_.context), labels.size());
  if (patch.box.area() > most) return false;
  patch.touched = labelsIn(labels, grown(changed, in_cells(kTouch), labels.size()));
  // Whole places, the small ones first, as long as they do not make the part large.
  std::vector<int> by_size(patch.touched.begin(), patch.touched.end());
  const auto box_of = [&](int label) { return boxes_[static_cast<std::size_t>(label)]; };
  std::stable_sort(by_size.begin(), by_size.end(),
                   [&](int p, int q) { return box_of(p).area() < box_of(q).area(); });
  const double allowed = std::min(most, 2.0 * patch.box.area());
  for (const int label : by_size) {
    const cv::Rect with = patch.box | grown(box_of(label), 2, labels.size());
    if (with.area() <= allowed) patch.box = with;
  }
  for (const int label : by_size) {
    if (!within(box_of(label), patch.box)) patch.cut.insert(label);
  }

  // All that is not touched becomes wall.
  OccupancyGrid seen = part(grid, patch.box);
  const int free_max = used_.segmentation.free_max;
  const cv::Rect leaks = grown(changed, in_cells(kLeaks), labels.size());
  for (int y = 0; y < patch.box.height; ++y) {
    const auto* row = labels.ptr<std::uint16_t>(patch.box.y + y) + patch.box.x;
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
  patch.pieces = segmentPlaces(seen, used_.segmentation);

  std::map<int, int> names;
  const int places_before = static_cast<int>(result_->map.places.size());
  const std::set<int> doubtful = joinAtRim(labels, patch, &names);
  nameByOverlap(labels, patch, places_before, &names);
  std::set<int> renewed;
  int places = places_before;
  for (const auto& [piece, label] : names) {
    renewed.insert(label);
    places = std::max(places, label);
  }
  renewed.insert(patch.cut.begin(), patch.cut.end());
  if (places > 65535) return false;

  const cv::Mat before = labels(patch.box).clone();
  for (int y = 0; y < patch.box.height; ++y) {
    auto* row = result_->labels.ptr<std::uint16_t>(patch.box.y + y) + patch.box.x;
    const auto* piece = patch.pieces.labels.ptr<std::uint16_t>(y);
    for (int x = 0; x < patch.box.width; ++x) {
      if (row[x] != 0 && patch.touched.count(row[x]) == 0) continue;
      row[x] = piece[x] == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(names.at(piece[x]));
    }
  }
  for (const int label : doubtful) {
    if (!inOnePart(labels, box_of(label) | patch.box, label)) return false;
  }
  const double cell_area = grid.geometry.resolution * grid.geometry.resolution;
  for (const int label : patch.cut) {
    result_->map.places[static_cast<std::size_t>(label - 1)].area +=
        cell_area *
        (cv::countNonZero(labels(patch.box) == label) - cv::countNonZero(before == label));
  }
  boxes_.resize(static_cast<std::size_t>(places) + 1);
  places = closeGaps(patch.touched, &patch.cut, &renewed, places);

  // From here on nothing fails.
  grid_ = grid;

  // Doors in and around the part are found anew, the others stay.
  const cv::Rect door_box = grown(patch.box, in_cells(0.3), labels.size());
  const cv::Rect wide = grown(patch.box, in_cells(kDoors), labels.size());
  DoorParams door_params;
  door_params.free_max = free_max;
  std::vector<DoorLine> doors;
  const auto inside = [&](const DoorLine& d) {
    const hyselam::Cell c = middleCell(d, grid.geometry);
    return door_box.contains({c.x, c.y});
  };
  for (const DoorLine& d : result_->doors) {
    if (!inside(d)) doors.push_back(d);
  }
  for (const DoorLine& d : refineDoors(part(grid, wide), result_->labels(wide), door_params)) {
    if (inside(d)) doors.push_back(d);
  }
  std::sort(doors.begin(), doors.end(), [](const DoorLine& p, const DoorLine& q) {
    if (p.place_a != q.place_a) return p.place_a < q.place_a;
    if (p.place_b != q.place_b) return p.place_b < q.place_b;
    return p.a.x != q.a.x ? p.a.x < q.a.x : p.a.y < q.a.y;
  });
  result_->doors = std::move(doors);

  // Renewed places are built anew; of those that are cut only walls and outline.
  PlaceSelection selection;
  selection.wanted.assign(static_cast<std::size_t>(places) + 1, 0);
  selection.measured = selection.wanted;
  selection.measured_box = patch.box;
  selection.box = patch.box;
  for (const int label : renewed) {
    selection.wanted[static_cast<std::size_t>(label)] = 1;
    if (patch.cut.count(label) == 0) {
      selection.measured[static_cast<std::size_t>(label)] = 1;
      continue;
    }
    const cv::Rect& all_of_it = boxes_[static_cast<std::size_t>(label)];
    selection.box = selection.box | all_of_it;
    // Unless its centre is where it no longer is.
    const auto& centre = result_->map.places[static_cast<std::size_t>(label - 1)].centre;
    const hyselam::Cell c = centre ? grid.geometry.cellAt({centre->x, centre->y}) : hyselam::Cell{};
    if (centre && result_->labels.at<std::uint16_t>(c.y, c.x) == label) continue;
    selection.measured[static_cast<std::size_t>(label)] = 1;
    selection.measured_box = selection.measured_box | all_of_it;
  }
  std::vector<Place> built =
      buildPlaces(grid, result_->labels, places, neighboursOf(result_->doors), {}, selection);
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
  for (const int label : renewed) {
    boxes_[static_cast<std::size_t>(label)] =
        patch.cut.count(label) != 0
            ? boxes_[static_cast<std::size_t>(label)] | patch.box
            : cv::boundingRect(cv::Mat(result_->labels(patch.box) == label)) + patch.box.tl();
  }
  result_->map = assembleMap(grid, result_->labels, std::move(all), result_->doors);
  result_->seconds.clear();
  return true;
}

}  // namespace hyselam_topo
