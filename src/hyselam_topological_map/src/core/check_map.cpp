// What every map must fulfil before it is written, sent or used.
#include <cmath>
#include <string>
#include <unordered_set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {
namespace {

constexpr double kUnitTolerance = 1e-6;
/// Farther than any building, near enough for every cell index to be a number.
constexpr double kMaxCoordinate = 1e7;

/// Checks the parts of a map; knows where it is for its messages.
class Checker {
 public:
  Checker(const AugmentedTopologicalMap& map, std::string source)
      : map_(map), source_(std::move(source)) {}

  void run() {
    where_ = "map";
    text(map_.frame_id, "frame_id");
    finite(map_.stamp, "stamp");
    for (const Place& place : map_.places) check(place);
    for (const Edge& edge : map_.edges) check(edge);
    if (map_.grid) check(*map_.grid);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw hyselam::InputError(source_, where_, reason);
  }
  void require(bool good, const std::string& reason) const {
    if (!good) fail(reason);
  }
  void finite(double value, const char* name) const {
    require(std::isfinite(value), std::string(name) + " is not a finite number");
  }
  void notNegative(double value, const char* name) const {
    finite(value, name);
    require(value >= 0.0, std::string(name) + " is negative");
  }
  void text(const std::string& value, const char* name) const {
    const std::string wrong = hyselam::wordError(value);
    require(wrong.empty(), std::string(name) + " " + wrong);
  }
  void coordinate(double value, const char* name) const {
    finite(value, name);
    require(std::abs(value) <= kMaxCoordinate, std::string(name) + " lies more than 10000 km away");
  }
  void point(const Point3& p, const char* name) const {
    for (const double value : {p.x, p.y, p.z}) coordinate(value, name);
  }
  void unit(const Point3& n) const {
    point(n, "the normal");
    const double length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    require(std::abs(length - 1.0) <= kUnitTolerance, "the normal is not of length 1");
  }
  template <std::size_t N>
  void covariance(const std::optional<std::array<double, N>>& matrix) const {
    if (!matrix) return;
    constexpr std::size_t kSide = N == 4 ? 2 : 3;
    for (std::size_t i = 0; i < kSide; ++i) {
      for (std::size_t j = 0; j < kSide; ++j) {
        const double value = (*matrix)[i * kSide + j];
        finite(value, "a covariance");
        require(value == (*matrix)[j * kSide + i], "a covariance is not symmetric");
        // Cauchy-Schwarz, with room for rounding.
        const double bound = (*matrix)[i * kSide + i] * (*matrix)[j * kSide + j];
        require(i != j || value >= 0.0, "a variance is negative");
        require(value * value <= bound * (1.0 + 1e-9), "a covariance exceeds its variances");
      }
    }
  }
  void id(Id value, Id next, std::unordered_set<Id>* known, const char* kind) const {
    require(value != 0, std::string("a ") + kind + " has the id 0");
    require(value < next,
            "the id is not below the next " + std::string(kind) + " id, " + std::to_string(next));
    require(known->insert(value).second,
            std::string("two ") + kind + "s have the id " + std::to_string(value));
  }
  void words(const std::vector<PlaceTerm>& list) const {
    for (const PlaceTerm& word : list) text(word.text, "a word");
  }
  void appearance(const Appearance& a) const {
    text(a.type, "the type of an appearance");
    require(a.rows > 0 && a.cols > 0, "an appearance has no rows or columns");
    require(a.values.size() == static_cast<std::size_t>(a.rows) * static_cast<std::size_t>(a.cols),
            "an appearance has not rows * cols values");
    for (const float value : a.values) finite(value, "a value of an appearance");
  }

  void check(const Wall& wall) {
    id(wall.id, map_.next_wall_id, &walls_, "wall");
    point(wall.position, "the position");
    covariance(wall.position_covariance);
    unit(wall.normal);
    covariance(wall.normal_covariance);
    notNegative(wall.length, "length");
    notNegative(wall.height, "height");
    covariance(wall.size_covariance);
    finite(wall.curvature, "curvature");
    finite(wall.vertical_curvature, "vertical_curvature");
    require(std::abs(wall.curvature) * wall.length <= 2.0 * hyselam::kPi * (1.0 + 1e-9),
            "the wall is bent into more than a circle");
  }

  void check(const VisualSignature& signature) const {
    appearance(signature.appearance);
    point(signature.position, "the position");
    covariance(signature.position_covariance);
    if (signature.heading) finite(*signature.heading, "heading");
    notNegative(signature.aperture_x, "aperture_x");
    notNegative(signature.aperture_y, "aperture_y");
    finite(signature.stamp, "stamp");
  }

  void check(const Place& place) {
    where_ = "place " + std::to_string(place.id);
    id(place.id, map_.next_place_id, &places_, "place");
    const std::string here = where_;
    words(place.words);
    for (const Wall& wall : place.walls) {
      where_ = here + ", wall " + std::to_string(wall.id);
      check(wall);
    }
    for (std::size_t i = 0; i < place.signatures.size(); ++i) {
      where_ = here + ", signature " + std::to_string(i + 1);
      check(place.signatures[i]);
    }
    where_ = here;
    notNegative(place.area, "area");
    if (place.centre) point(*place.centre, "the centre");
    for (const hyselam::Point2& p : place.outline) {
      coordinate(p.x, "the outline");
      coordinate(p.y, "the outline");
    }
  }

  void check(const Door& door) {
    id(door.id, map_.next_door_id, &doors_, "door");
    point(door.position, "the position");
    covariance(door.position_covariance);
    unit(door.normal);
    notNegative(door.width, "width");
    notNegative(door.height, "height");
    if (door.appearance) appearance(*door.appearance);
  }

  void check(const Edge& edge) {
    where_ = "edge " + std::to_string(edge.a) + "-" + std::to_string(edge.b);
    const std::string here = where_;
    for (const Id end : {edge.a, edge.b}) {
      require(places_.count(end) != 0, "there is no place " + std::to_string(end));
    }
    require(edge.a != edge.b, "it connects a place with itself");
    require(edge.a < edge.b, "the smaller id must come first");
    require(edges_.insert(std::uint64_t{edge.a} << 32 | edge.b).second, "it is there twice");
    words(edge.words);
    for (const Door& door : edge.doors) {
      where_ = here + ", door " + std::to_string(door.id);
      check(door);
    }
  }

  void check(const PlaceGrid& grid) {
    where_ = "grid";
    const auto& g = grid.geometry;
    require(g.width > 0 && g.height > 0, "it has no cells");
    require(std::isfinite(g.resolution) && g.resolution > 0.0, "the resolution is not positive");
    require(g.origin.isFinite(), "the origin is not finite");
    coordinate(g.origin.x, "the origin");
    coordinate(g.origin.y, "the origin");
    require(grid.labels.size() == g.cellCount(), "it has not width * height labels");
    for (const Id place : grid.places) {
      require(place == 0 || places_.count(place) != 0,
              "there is no place " + std::to_string(place));
    }
    std::uint16_t largest = 0;
    for (const std::uint16_t label : grid.labels) largest = std::max(largest, label);
    require(largest <= grid.places.size(),
            "label " + std::to_string(largest) + " stands for no place");
  }

  const AugmentedTopologicalMap& map_;
  std::string source_;
  std::string where_;
  std::unordered_set<Id> places_, walls_, doors_;
  std::unordered_set<std::uint64_t> edges_;
};

}  // namespace

void checkMap(const AugmentedTopologicalMap& map, const std::string& source) {
  Checker(map, source).run();
}

}  // namespace hyselam_topo
