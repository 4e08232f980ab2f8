// A flat with furniture and small things, two tours through it with a camera, and the truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hyselam_objects/mapping/object_mapper.hpp"
#include "hyselam_objects/recognition/object_descriptor.hpp"
#include "hyselam_sim/camera.hpp"
#include "hyselam_sim/floor_plan.hpp"

namespace hyselam_objects {
namespace simulated {

using hyselam_sim::Thing;

inline Thing thing(const std::string& kind, int number) {
  Thing t;
  t.kind = kind;
  t.name = kind + " " + std::to_string(number);
  const auto make = [&t](Thing::Shape shape, std::array<double, 3> size, hyselam_sim::Color color) {
    t.shape = shape;
    t.size = size;
    t.color = color;
  };
  const auto box = Thing::Shape::kBox, round = Thing::Shape::kCylinder;
  if (kind == "cup") make(round, {0.10, 0.10, 0.12}, {0.75f, 0.05f, 0.05f});
  if (kind == "bottle") make(round, {0.09, 0.09, 0.30}, {0.05f, 0.45f, 0.08f});
  if (kind == "cereal box") make(box, {0.20, 0.08, 0.30}, {0.80f, 0.65f, 0.05f});
  if (kind == "book") make(box, {0.24, 0.17, 0.07}, {0.05f, 0.10f, 0.65f});
  if (kind == "PC") make(box, {0.40, 0.18, 0.38}, {0.03f, 0.03f, 0.03f});
  if (kind == "lamp") make(round, {0.20, 0.20, 0.36}, {0.80f, 0.80f, 0.78f});
  if (kind == "plant pot") make(round, {0.26, 0.26, 0.28}, {0.60f, 0.25f, 0.06f});
  if (kind == "bin") make(round, {0.30, 0.30, 0.40}, {0.30f, 0.06f, 0.50f});
  if (kind == "bowl") make(round, {0.22, 0.22, 0.10}, {0.05f, 0.55f, 0.60f});
  return t;
}

inline Thing at(Thing t, double x, double y, double z, double turn = 0.0) {
  t.pose = {x, y, hyselam::radians(turn)};
  t.z = z;
  return t;
}

/// 27 things on 8 pieces of furniture and on the floor; `later`: five of them have been moved.
inline std::vector<Thing> things(bool later) {
  std::vector<Thing> all;
  const auto put = [&](const char* kind, int number, double x, double y, double z,
                       double turn = 0) { all.push_back(at(thing(kind, number), x, y, z, turn)); };
  // kitchen
  put("cup", 1, 2.1, 1.9, 0.75);
  put("cereal box", 1, 2.5, 2.1, 0.75, 20);
  put("bowl", 1, 2.9, 1.85, 0.75);
  put("bottle", 1, 0.5, 0.7, 0.90);
  put("bowl", 2, 0.5, 1.2, 0.90);
  put("cup", 2, 0.5, 1.7, 0.90);
  put("bin", 1, 3.9, 0.9, 0.0);
  // office
  put("PC", 1, 7.15, 2.1, 0.72, 0);
  put("lamp", 1, 8.1, 2.15, 0.72);
  put("cup", 3, 7.7, 1.8, 0.72);
  put("book", 1, 9.4, 0.8, 0.60, 90);
  put("book", 2, 9.4, 1.25, 0.60, 80);
  put("plant pot", 1, 9.4, 1.65, 0.60);
  put("bin", 2, 6.2, 0.9, 0.0);
  // lounge
  put("book", 3, 2.2, 6.05, 0.45, 10);
  put("bottle", 2, 2.6, 5.9, 0.45);
  put("cup", 4, 2.9, 6.15, 0.45);
  put("lamp", 2, 0.5, 6.1, 0.80);
  put("cereal box", 2, 0.5, 6.6, 0.80, 90);
  put("plant pot", 2, 0.5, 7.1, 0.80);
  put("plant pot", 3, 3.9, 7.1, 0.0);
  // bedroom
  put("PC", 2, 7.5, 6.6, 0.50, 30);
  put("book", 4, 7.6, 5.6, 0.50, 0);
  put("lamp", 3, 9.4, 7.0, 0.55);
  put("bottle", 3, 7.8, 6.1, 0.50);
  put("bin", 3, 6.1, 7.1, 0.0);
  // what stands on something small
  put("cup", 5, 2.2, 6.05, 0.52);
  if (!later) return all;
  const auto move = [&](const char* kind, int number, double x, double y, double z) {
    const std::string name = std::string(kind) + " " + std::to_string(number);
    for (Thing& t : all) {
      if (t.name == name) t = at(t, x, y, z, hyselam::degrees(t.pose.theta));
    }
  };
  move("cup", 1, 0.62, 6.35, 0.80);        // to the sideboard
  move("cereal box", 1, 7.5, 2.05, 0.72);  // to the desk
  move("bottle", 2, 9.3, 1.02, 0.60);      // to the low shelf
  move("bin", 2, 9.0, 3.2, 0.0);           // across the office
  move("bowl", 2, 7.4, 5.9, 0.50);         // to the bed
  return all;
}

inline std::set<std::string> moved() {
  return {"cup 1", "cereal box 1", "bottle 2", "bin 2", "bowl 2"};
}

/// A flat, what is in it before and after, and what to look at.
struct Furnished {
  hyselam_sim::FloorPlan plan;
  std::vector<Thing> before, after;
  std::set<std::string> moved;
  std::vector<hyselam::Point2> targets;
};

inline Furnished flatOf(const std::string& plan_file) {
  return {hyselam_sim::loadFloorPlan(plan_file), things(false), things(true), moved(), {}};
}

/// The same rooms with other furniture and other things in other places, all drawn: for figures
/// that nothing was tuned on.
class FlatGenerator {
 public:
  explicit FlatGenerator(std::uint64_t seed) : rng_(seed) {}

  Furnished run(const std::string& plan_file) {
    const hyselam_sim::FloorPlan rooms = hyselam_sim::loadFloorPlan(plan_file);
    flat_.plan = hyselam_sim::parseFloorPlan(planText(), "drawn");
    flat_.plan.places = rooms.places;
    putOnFurniture();
    putBins();
    moveSome();
    return std::move(flat_);
  }

 private:
  struct Top {
    double x, y, lx, ly, height;
  };
  struct Spot {
    double x, y;
  };

  /// Two pieces of furniture in each room: one along the outer wall, one in the middle.
  std::string planText() {
    std::string text =
        "plan: drawn\ndescription: drawn\norigin: [-0.5, -0.5]\nsize: [11.0, 9.0]\n"
        "wall_thickness: 0.15\nwalls:\n"
        "  - {name: outer, closed: true, points: [[0, 0], [10, 0], [10, 8], [0, 8]]}\n"
        "  - {name: across, points: [[5, 0], [5, 8]]}\n"
        "  - {name: along, points: [[0, 4], [10, 4]]}\nfurniture:\n";
    for (int room = 0; room < 4; ++room) {
      for (int piece = 0; piece < 2; ++piece) {
        const Top top = drawTop(room, piece);
        tops_.push_back(top);
        char line[160];
        std::snprintf(line, sizeof(line),
                      "  - {name: piece %d, box: [%.3f, %.3f, %.3f, %.3f, 0], height: %.3f}\n",
                      2 * room + piece, top.x, top.y, top.lx, top.ly, top.height);
        text += line;
        flat_.targets.push_back({top.x, top.y});
      }
    }
    return text +
           "places:\n  - {name: none, at: [1.2, 3.3], polygon: [[0.9, 3.1], [1.5, 3.1], "
           "[1.5, 3.5], [0.9, 3.5]]}\n";
  }

  Top drawTop(int room, int piece) {
    const double ox = room % 2 * 5.0, oy = room / 2 * 4.0;
    Top top{};
    top.lx = piece == 0 ? rng_.uniform(0.45, 0.6) : rng_.uniform(0.9, 1.4);
    top.ly = piece == 0 ? rng_.uniform(1.1, 1.6) : rng_.uniform(0.6, 0.9);
    const double wall = room % 2 == 0 ? 0.15 + 0.5 * top.lx : 9.85 - 0.5 * top.lx;
    top.x = piece == 0 ? wall : ox + rng_.uniform(2.3, 2.7);
    top.y = oy + (piece == 0 ? rng_.uniform(1.2, 2.8) : rng_.uniform(1.8, 2.2));
    top.height = rng_.uniform(0.42, 0.92);
    return top;
  }

  /// A spot on a top, apart from other things.
  std::optional<Spot> spotOn(const Top& top) {
    constexpr double kApart = 0.36, kMargin = 0.3;
    for (int i = 0; i < 200; ++i) {
      const Spot spot{top.x + rng_.uniform(-0.5, 0.5) * (top.lx - kMargin),
                      top.y + rng_.uniform(-0.5, 0.5) * (top.ly - kMargin)};
      const bool free = std::none_of(taken_.begin(), taken_.end(), [&](const Spot& other) {
        return std::hypot(other.x - spot.x, other.y - spot.y) <= kApart;
      });
      if (free) return spot;
    }
    return std::nullopt;
  }

  std::optional<Thing> onATop(const std::string& kind) {
    for (int i = 0; i < 50; ++i) {
      const Top& top = tops_[static_cast<std::size_t>(rng_.uniform(0.0, 7.999))];
      const std::optional<Spot> spot = spotOn(top);
      if (!spot) continue;
      taken_.push_back(*spot);
      return at(thing(kind, numbers_[kind]), spot->x, spot->y, top.height,
                rng_.uniform(0.0, 180.0));
    }
    return std::nullopt;
  }

  void putOnFurniture() {
    const std::vector<std::string> kinds{"cup", "bottle", "cereal box", "book",
                                         "PC",  "lamp",   "plant pot",  "bowl"};
    for (int i = 0; i < 23; ++i) {
      const std::string& kind = kinds[static_cast<std::size_t>(rng_.uniform(0.0, 7.999))];
      ++numbers_[kind];
      if (const std::optional<Thing> t = onATop(kind)) {
        flat_.before.push_back(*t);
      } else {
        --numbers_[kind];
      }
    }
  }

  /// On the floor, one in each room.
  void putBins() {
    for (int room = 0; room < 4; ++room) {
      const double ox = room % 2 * 5.0, oy = room / 2 * 4.0;
      ++numbers_["bin"];
      const double x = ox + (room % 2 == 0 ? rng_.uniform(4.0, 4.4) : rng_.uniform(0.6, 1.0));
      const double y = oy + rng_.uniform(0.7, 3.3);
      flat_.before.push_back(at(thing("bin", numbers_["bin"]), x, y, 0.0));
      flat_.targets.push_back({x, y});
    }
  }

  void moveSome() {
    constexpr std::size_t kMoved = 5;
    constexpr double kMinMove = 0.6;
    flat_.after = flat_.before;
    while (flat_.moved.size() < kMoved) {
      const double movable = static_cast<double>(flat_.after.size()) - 4.001;  // not the bins
      Thing& t = flat_.after[static_cast<std::size_t>(rng_.uniform(0.0, movable))];
      if (flat_.moved.count(t.name) != 0) continue;
      const std::optional<Thing> moved = onATop(t.kind);
      if (!moved) break;
      if (std::hypot(moved->pose.x - t.pose.x, moved->pose.y - t.pose.y) <= kMinMove) continue;
      t.pose = moved->pose;
      t.z = moved->z;
      flat_.moved.insert(t.name);
    }
  }

  hyselam::Rng rng_;
  Furnished flat_;
  std::vector<Top> tops_;
  std::vector<Spot> taken_;
  std::map<std::string, int> numbers_;
};

inline Furnished drawnFlat(const std::string& plan_file, std::uint64_t seed) {
  return FlatGenerator(seed).run(plan_file);
}

struct Frame {
  OrganizedCloud cloud;
  PinholeCamera camera;
  double stamp = 0.0;
  std::map<std::string, int> pixels;  ///< of each thing and piece of furniture in it
  std::vector<std::int32_t> owners;   ///< of each pixel, see Flat::ownerName()
};

class Flat {
 public:
  /// `targets`: what to look at on a tour; empty: of the flat of flat.yaml.
  Flat(const hyselam_sim::FloorPlan& plan, std::vector<Thing> all,
       std::vector<hyselam::Point2> targets = {})
      : plan_(plan), things_(std::move(all)), targets_(std::move(targets)), scene_(make()) {}

  const hyselam_sim::FloorPlan& plan() const { return plan_; }
  const std::vector<Thing>& allThings() const { return things_; }

  /// Looks around each piece of furniture and each thing on the floor.
  std::vector<hyselam::Pose2> tour() const {
    std::vector<hyselam::Pose2> way;
    const auto look = [&](double x, double y, double tx, double ty) {
      way.push_back({x, y, std::atan2(ty - y, tx - x)});
    };
    // Around each target, from within its room.
    for (const hyselam::Point2& target : targets_) {
      const double side = target.x > 5.0 ? 5.0 : 0.0, half = target.y > 4.0 ? 4.0 : 0.0;
      for (int i = 0; i < 24; ++i) {
        // The camera is level: what stands on the floor is seen whole from 2.3 m on.
        const double angle = 2.0 * hyselam::kPi * i / 8.0, away = i < 8 ? 1.3 : i < 16 ? 1.9 : 2.7;
        const double x = target.x + away * std::cos(angle), y = target.y + away * std::sin(angle);
        const bool within = x > side + 0.4 && x < side + 4.6 && y > half + 0.4 && y < half + 3.6;
        if (within) look(x, y, target.x, target.y);
      }
    }
    for (int side = 0; side < 2 && targets_.empty(); ++side) {  // west, east
      for (int half = 0; half < 2; ++half) {                    // south, north
        const double ox = side * 5.0, oy = half * 4.0;
        for (const auto& [x, y] : {std::pair<double, double>{1.3, 0.8},
                                   {1.3, 3.3},
                                   {3.9, 3.3},
                                   {4.2, 1.6},
                                   {2.5, 0.7},
                                   {2.5, 3.4},
                                   {1.0, 2.4}}) {
          for (const auto& [tx, ty] : {std::pair<double, double>{2.5, 2.0},
                                       {0.5, 1.3},
                                       {0.5, 2.6},
                                       {4.4, 1.2},
                                       {4.4, 3.0},
                                       {3.9, 0.9}}) {
            if (std::hypot(tx - x, ty - y) < 1.0) continue;
            look(ox + x, oy + y, ox + tx, oy + ty);
          }
        }
      }
    }
    std::vector<hyselam::Pose2> free;
    for (const hyselam::Pose2& pose : way) {
      bool inside = false;
      for (const auto& body : scene_.bodies()) {
        inside = inside || hyselam_sim::contains(body.outline, {pose.x, pose.y});
      }
      if (!inside) free.push_back(pose);
    }
    return free;
  }

  Frame take(const hyselam::Pose2& base, double stamp, std::uint64_t seed) const {
    hyselam_sim::CameraParams camera;
    camera.noise = 0.01;
    hyselam_sim::LightParams light;
    light.lamps = hyselam_sim::LightParams::Lamps::kOn;
    hyselam::Rng rng(seed);
    const auto picture = hyselam_sim::takePicture(camera, scene_, light, {}, base, stamp, rng);
    Frame frame;
    frame.stamp = stamp;
    frame.camera.focal_length = camera.focalLength();
    frame.camera.cx = 0.5 * camera.width - 0.5;
    frame.camera.cy = 0.5 * camera.height - 0.5;
    const hyselam::Pose2 at = base * camera.camera_in_base;
    frame.camera.in_map.translation() = Eigen::Vector3d(at.x, at.y, camera.above_floor);
    Eigen::Matrix3d optical;
    optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    frame.camera.in_map.linear() =
        Eigen::AngleAxisd(at.theta, Eigen::Vector3d::UnitZ()).toRotationMatrix() * optical;
    OrganizedCloud& cloud = frame.cloud;
    cloud.width = camera.width;
    cloud.height = camera.height;
    std::map<std::int32_t, int> owners;
    for (int i = 0; i < picture.owner.rows; ++i) {
      for (int j = 0; j < picture.owner.cols; ++j) {
        frame.owners.push_back(picture.owner.at<std::int32_t>(i, j));
        ++owners[frame.owners.back()];
      }
    }
    for (const auto& [owner, pixels] : owners) {
      frame.pixels[scene_.ownerName(static_cast<std::uint32_t>(owner))] = pixels;
    }
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const float z = 0.001f * picture.depth.at<std::uint16_t>(v, u);
        const auto& bgr = picture.color.at<cv::Vec3b>(v, u);
        cloud.colors.push_back(static_cast<std::uint32_t>(bgr[2] << 16 | bgr[1] << 8 | bgr[0]));
        if (z <= 0.0f) {
          cloud.points.emplace_back(NAN, NAN, NAN);
          continue;
        }
        const auto f = static_cast<float>(frame.camera.focal_length);
        cloud.points.emplace_back(
            (static_cast<float>(u) - static_cast<float>(frame.camera.cx)) * z / f,
            (static_cast<float>(v) - static_cast<float>(frame.camera.cy)) * z / f, z);
      }
    }
    return frame;
  }

  /// Of the thing or piece of furniture that a pixel shows.
  std::string ownerName(std::int32_t owner) const {
    return scene_.ownerName(static_cast<std::uint32_t>(owner));
  }

  std::optional<std::pair<std::string, Point3>> placeAt(double x, double y) const {
    for (const auto& place : plan_.places) {
      if (!hyselam_sim::contains(place.outline, {x, y})) continue;
      Point3 middle;
      for (const auto& p : place.outline) {
        middle.x += p.x / static_cast<double>(place.outline.size());
        middle.y += p.y / static_cast<double>(place.outline.size());
      }
      return std::make_pair(place.name, middle);
    }
    return std::nullopt;
  }

  /// The map that a perfect detector would make.
  ObjectMap truth(std::vector<std::string>* names) const {
    ObjectMap map;
    const auto add = [&](const std::string& name, const std::string& kind, double x, double y,
                         double z, double lx, double ly, double lz, double yaw = 0.0) {
      const Id id = map.addObject(kind);
      ObjectInstance& object = *map.find(id);
      object.existence = 1.0;
      object.detections = 100;
      object.pose = ObjectPose{{x, y, z + 0.5 * lz}, {lx, ly, lz}, yaw, {}};
      names->push_back(name);
      const auto here = placeAt(x, y);
      if (!here) return;
      ObjectRelation relation;
      relation.object = id;
      for (const ObjectPlace& place : map.places) {
        if (place.name == here->first) relation.place = place.id;
      }
      if (relation.place == 0) relation.place = map.addPlace(here->first);
      relation.vector = Point3{x - here->second.x, y - here->second.y, z + 0.5 * lz};
      map.relate(relation);
    };
    for (const auto& piece : plan_.furniture) {
      double lx = 1e9, hx = -1e9, ly = 1e9, hy = -1e9;
      for (const auto& p : piece.outline) {
        lx = std::min(lx, p.x), hx = std::max(hx, p.x);
        ly = std::min(ly, p.y), hy = std::max(hy, p.y);
      }
      add(piece.name, "furniture", 0.5 * (lx + hx), 0.5 * (ly + hy), 0.0, hx - lx, hy - ly,
          piece.height);
    }
    for (const Thing& t : things_) {
      const bool round = t.shape == Thing::Shape::kCylinder;
      add(t.name, t.kind, t.pose.x, t.pose.y, t.z, t.size[0], t.size[round ? 0 : 1], t.size[2],
          round ? 0.0 : t.pose.theta);
    }
    updateRelations(map);
    return map;
  }

 private:
  hyselam_sim::Scene make() const {
    hyselam_sim::SceneParams params;
    params.things = things_;
    return hyselam_sim::Scene(plan_, params);
  }

  hyselam_sim::FloorPlan plan_;
  std::vector<Thing> things_;
  std::vector<hyselam::Point2> targets_;
  hyselam_sim::Scene scene_;
};

}  // namespace simulated
}  // namespace hyselam_objects
