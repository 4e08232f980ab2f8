// Topological maps of any shape, from a seed: everything that may stand in a map does so somewhere.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {
namespace testing {

class RandomMaps {
 public:
  explicit RandomMaps(unsigned seed) : rng_(seed) {}

  AugmentedTopologicalMap map() {
    AugmentedTopologicalMap map;
    if (chance(0.7)) map.frame_id = text();
    map.stamp = chance(0.5) ? 0.0 : number(2e9);
    map.extras = extras();
    Id place_id = 0;
    for (int i = upTo(6); i > 0; --i) {
      place_id += 1u + static_cast<Id>(upTo(3));
      map.places.push_back(place(place_id));
    }
    for (std::size_t i = 0; i < map.places.size(); ++i) {
      for (std::size_t j = i + 1; j < map.places.size(); ++j) {
        if (chance(0.4)) map.edges.push_back(edge(map.places[i].id, map.places[j].id));
      }
    }
    if (chance(0.6)) map.grid = grid(map.places);
    map.next_place_id = place_id + 1u + static_cast<Id>(upTo(5));
    map.next_wall_id = next_wall_;
    map.next_door_id = next_door_;
    return map;
  }

 private:
  bool chance(double p) { return std::uniform_real_distribution<double>(0.0, 1.0)(rng_) < p; }
  int upTo(int n) { return std::uniform_int_distribution<int>(0, n)(rng_); }
  /// Numbers of all sizes, short and long ones.
  double number(double scale) {
    if (chance(0.2)) return upTo(10) - 5.0;
    if (chance(0.1)) return -1e-300 * upTo(3);
    return std::uniform_real_distribution<double>(-scale, scale)(rng_);
  }
  double size() { return std::abs(number(50.0)); }
  Point3 point() { return {number(100.0), number(100.0), number(3.0)}; }
  Point3 direction() {
    const double angle = number(3.0), up = chance(0.8) ? 0.0 : number(1.0);
    return {std::cos(up) * std::cos(angle), std::cos(up) * std::sin(angle), std::sin(up)};
  }
  std::string text() {
    static const std::vector<std::string> kTexts = {
        "kitchen", "John's office", "\"Lab\" <2> & more", "Küche", "厨房", " two  blanks ", "a=b;",
        "]]>",     "&amp;"};
    return kTexts[static_cast<std::size_t>(upTo(static_cast<int>(kTexts.size()) - 1))];
  }
  std::vector<PlaceTerm> words() {
    std::vector<PlaceTerm> list;
    for (int i = upTo(2); i > 0; --i) list.push_back({text(), chance(0.5)});
    return list;
  }
  Extras extras() {
    Extras extras;
    if (chance(0.3)) extras.attributes.emplace_back("ext:note", "x < 1 & \"y\"");
    if (chance(0.3)) extras.elements.push_back("<ext:tag/>");
    if (chance(0.3)) {
      extras.elements.push_back(
          "<ext:tree xmlns:ext=\"urn:ext\" n=\"1\"><ext:leaf>a &lt; b</ext:leaf>"
          "<!-- kept --><ext:leaf/></ext:tree>");
    }
    return extras;
  }
  template <std::size_t N>
  std::optional<std::array<double, N>> covariance() {
    if (chance(0.5)) return std::nullopt;
    constexpr std::size_t kSide = N == 4 ? 2 : 3;
    std::array<double, N> matrix{};
    for (std::size_t i = 0; i < kSide; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const double value = i == j ? 1.0 + size() : 0.05 * number(6.0);
        matrix[i * kSide + j] = matrix[j * kSide + i] = value;
      }
    }
    return matrix;
  }
  Appearance appearance() {
    Appearance a;
    a.type = text();
    a.rows = 1 + upTo(3);
    a.cols = 1 + upTo(5);
    for (int i = 0; i < a.rows * a.cols; ++i) a.values.push_back(static_cast<float>(number(9.0)));
    return a;
  }
  Wall wall() {
    Wall wall;
    wall.id = next_wall_++;
    wall.kind = static_cast<WallKind>(upTo(2));
    wall.position = point();
    wall.position_covariance = covariance<9>();
    wall.normal = direction();
    wall.normal_covariance = covariance<9>();
    wall.length = size();
    wall.height = size();
    wall.size_covariance = covariance<4>();
    wall.curvature = number(6.0) / (1.0 + wall.length);
    wall.vertical_curvature = number(1.0);
    wall.extras = extras();
    return wall;
  }
  VisualSignature signature() {
    VisualSignature s;
    s.appearance = appearance();
    s.position = point();
    s.position_covariance = covariance<9>();
    if (chance(0.5)) s.heading = number(3.0);
    s.aperture_x = size();
    s.aperture_y = size();
    s.stamp = number(2e9);
    s.extras = extras();
    return s;
  }
  Place place(Id id) {
    Place place;
    place.id = id;
    place.kind = static_cast<PlaceKind>(upTo(2));
    place.words = words();
    for (int i = upTo(3); i > 0; --i) place.walls.push_back(wall());
    for (int i = upTo(1); i > 0; --i) place.signatures.push_back(signature());
    place.area = size();
    if (chance(0.7)) place.centre = point();
    for (int i = upTo(4); i > 0; --i) place.outline.push_back({number(50.0), number(50.0)});
    place.extras = extras();
    return place;
  }
  Door door() {
    Door door;
    door.id = next_door_++;
    door.real = chance(0.5);
    door.state = static_cast<DoorState>(upTo(2));
    door.position = point();
    door.position_covariance = covariance<9>();
    door.normal = direction();
    door.width = size();
    door.height = size();
    if (chance(0.3)) door.appearance = appearance();
    door.extras = extras();
    return door;
  }
  Edge edge(Id a, Id b) {
    Edge edge;
    edge.a = a;
    edge.b = b;
    edge.words = words();
    for (int i = upTo(2); i > 0; --i) edge.doors.push_back(door());
    edge.extras = extras();
    return edge;
  }
  PlaceGrid grid(const std::vector<Place>& places) {
    PlaceGrid grid;
    grid.geometry.width = 1 + upTo(30);
    grid.geometry.height = 1 + upTo(30);
    grid.geometry.resolution = 0.01 + size();
    grid.geometry.origin = {number(100.0), number(100.0), number(3.0)};
    for (const Place& place : places) {
      if (chance(0.9)) grid.places.push_back(chance(0.9) ? place.id : 0);
    }
    for (std::size_t i = 0; i < grid.geometry.cellCount(); ++i) {
      grid.labels.push_back(static_cast<std::uint16_t>(upTo(static_cast<int>(grid.places.size()))));
    }
    return grid;
  }

  std::mt19937 rng_;
  Id next_wall_ = 1, next_door_ = 1;
};

}  // namespace testing
}  // namespace hyselam_topo
