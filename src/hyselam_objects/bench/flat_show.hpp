// The show: learn the kinds of things, map the flat in two tours, compare with the truth.
#pragma once

#include <algorithm>
#include <ctime>
#include <map>

#include "hyselam_objects/mapping/landmark_check.hpp"
#include "simulated_flat.hpp"

namespace hyselam_objects {
namespace simulated {

struct FlatScores {
  double precision = 0.0, recall = 0.0;  ///< of objects, within 15 cm (furniture 25 cm)
  double kinds = 0.0;                    ///< share of the found things with the right name
  double relation_precision = 0.0, relation_recall = 0.0;
  int objects = 0;              ///< true ones
  int hidden = 0;               ///< ... of less than 400 pixels in every frame of the 2nd tour
  double recall_of_seen = 0.0;  ///< of the others
  int refound = 0;  ///< moved ones that kept their id, or have that of one just like them
  double movability_auc = 0.0;         ///< moved against unmoved small things
  int noticed = 0, displaced = 0;      ///< looks of a robot that is a metre off; all of them
  int false_alarms = 0, in_place = 0;  ///< looks of one that is where it believes to be (5 cm)
  double milliseconds = 0.0;           ///< of detection and mapping, of one frame
  std::vector<std::string> faults;
};

/// Things shown one by one in the middle of an empty room, on a table and on the floor, from all
/// around: ten frames each.
inline void showKinds(const std::function<void(const std::string& kind, const Flat& room,
                                               const Frame& frame)>& look) {
  const char* plan = R"(
plan: show
description: an empty room with a table
origin: [-0.5, -0.5]
size: [7.0, 7.0]
wall_thickness: 0.15
walls:
  - {name: outer, closed: true, points: [[0, 0], [6, 0], [6, 6], [0, 6]]}
furniture:
  - {name: table, box: [3.0, 3.0, 0.9, 0.9, 0], height: 0.7}
places:
  - {name: room, at: [1.0, 1.0], polygon: [[0.1, 0.1], [5.9, 0.1], [5.9, 5.9], [0.1, 5.9]]}
)";
  std::uint64_t seed = 100;
  for (const char* kind :
       {"cup", "bottle", "cereal box", "book", "PC", "lamp", "plant pot", "bin", "bowl"}) {
    for (const bool low : {false, true}) {
      hyselam_sim::FloorPlan room = hyselam_sim::parseFloorPlan(plan, "show");
      if (low) room.furniture.clear();
      const Flat flat(room, {at(thing(kind, 1), 3.0, 3.0, low ? 0.0 : 0.7, 15.0)});
      for (int i = 0; i < 10; ++i) {
        const double angle = 0.3 + i * hyselam::kPi / 5.0, away = (low ? 2.5 : 1.5) + 0.2 * (i % 4);
        const hyselam::Pose2 base{3.0 - away * std::cos(angle), 3.0 - away * std::sin(angle),
                                  angle};
        look(kind, flat, flat.take(base, 0.0, ++seed));
      }
    }
  }
}

inline ObjectDictionary learnKinds() {
  struct Shown {
    std::vector<std::vector<float>> views;
    std::vector<Eigen::Vector3d> sizes;
  };
  std::map<std::string, Shown> kinds;
  showKinds([&](const std::string& kind, const Flat&, const Frame& frame) {
    for (const DetectedObject& seen : detectObjects(frame.cloud, frame.camera.in_map)) {
      const Point3 c = seen.center();
      if (seen.furniture || seen.partial || std::hypot(c.x - 3.0, c.y - 3.0) > 0.25) continue;
      kinds[kind].views.push_back(seen.descriptor);
      kinds[kind].sizes.push_back(seen.size());
    }
  });
  ObjectDictionary dictionary;
  for (const auto& [kind, shown] : kinds) {
    dictionary.put(learnObject(kind, shown.views, shown.sizes));
  }
  return dictionary;
}

class FlatShow {
 public:
  FlatShow(Furnished furnished, const ObjectDictionary& dictionary, int every = 1)
      : furnished_(std::move(furnished)),
        before_(furnished_.plan, furnished_.before, furnished_.targets),
        after_(furnished_.plan, furnished_.after, furnished_.targets),
        every_(every),
        mapper_(map_, dictionary) {
    mapper_.setPlaceLookup([this](double x, double y) { return before_.placeAt(x, y); });
  }

  FlatScores run() {
    drive(before_, 0.0);
    const ObjectMap first = map_;
    std::vector<std::string> first_names;
    const ObjectMap first_truth = before_.truth(&first_names);
    const auto first_pairs = match(first, first_truth);
    most_pixels_.clear();
    drive(after_, 10000.0);
    FlatScores scores = compare();
    // The ids that the moved things had before and have now.
    std::vector<std::string> names;
    const ObjectMap truth = after_.truth(&names);
    const auto pairs = match(map_, truth);
    std::vector<double> of_moved, of_unmoved;
    for (const auto& [id, true_id] : pairs) {
      const std::string& name = names[true_id - 1];
      const bool was_moved = furnished_.moved.count(name) != 0;
      if (map_.find(id)->properties.count("furniture") == 0) {
        (was_moved ? of_moved : of_unmoved).push_back(movability(map_, id));
      }
      if (!was_moved) continue;
      const auto old = first_pairs.find(id);
      // Of two moved things that are the same in every way nobody can tell which is which.
      const bool same = old != first_pairs.end() &&
                        (first_names[old->second - 1] == name ||
                         (furnished_.moved.count(first_names[old->second - 1]) != 0 &&
                          first_truth.find(old->second)->kind == truth.find(true_id)->kind));
      scores.refound += same;
      if (same) continue;
      scores.faults.push_back("moved and not found again: " + name);
      for (const auto& [before, true_before] : first_pairs) {
        if (first_names[true_before - 1] != name) continue;
        const ObjectInstance* left = map_.find(before);
        scores.faults.push_back(left == nullptr
                                    ? "  it was dropped"
                                    : "  what was left of it: existence " +
                                          std::to_string(left->existence) + " seen " +
                                          std::to_string(left->detections) + " missed " +
                                          std::to_string(left->missed_detections));
      }
    }
    double better = 0.0;
    for (const double a : of_moved) {
      for (const double b : of_unmoved) better += a > b ? 1.0 : a == b ? 0.5 : 0.0;
    }
    const auto all = static_cast<double>(of_moved.size() * of_unmoved.size());
    scores.movability_auc = all > 0.0 ? better / all : 0.0;
    checkPose(&scores);
    scores.milliseconds = frames_ > 0 ? 1e3 * seconds_ / frames_ : 0.0;
    return scores;
  }

  const ObjectMap& map() const { return map_; }

 private:
  static constexpr int kFewPixels = 400;

  /// A third look from each place, six frames at a time, by a robot that is wrong about its pose.
  void checkPose(FlatScores* scores) const {
    const std::vector<hyselam::Pose2> way = after_.tour();
    LandmarkMonitor right, wrong;
    for (std::size_t i = 0; i < way.size(); i += static_cast<std::size_t>(2 * every_)) {
      if (i % 12 == 0) {
        right.clear();
        wrong.clear();
      }
      const double angle = static_cast<double>(i / 12) * 0.7;
      Frame frame = after_.take(way[i], 20000.0 + static_cast<double>(i), 5000 + i);
      const Eigen::Vector3d aside(std::cos(angle), std::sin(angle), 0.0);
      frame.camera.in_map.translation() += 0.05 * aside;
      const auto good = right.add(map_, detectObjects(frame.cloud, frame.camera.in_map));
      frame.camera.in_map.translation() += 0.95 * aside;
      const auto bad = wrong.add(map_, detectObjects(frame.cloud, frame.camera.in_map));
      if (i % 12 < 8) continue;  // the last of six
      if (good.verdict != LandmarkVerdict::kUnknown) {
        ++scores->in_place;
        scores->false_alarms += good.verdict == LandmarkVerdict::kDisplaced;
      }
      if (bad.verdict != LandmarkVerdict::kUnknown) {
        ++scores->displaced;
        scores->noticed += bad.verdict == LandmarkVerdict::kDisplaced;
      }
    }
  }

  void drive(const Flat& flat, double stamp) {
    const std::vector<hyselam::Pose2> way = flat.tour();
    for (std::size_t i = 0; i < way.size(); i += static_cast<std::size_t>(every_)) {
      const Frame frame = flat.take(way[i], stamp + static_cast<double>(i), i + 1);
      for (const auto& [name, pixels] : frame.pixels) {
        int& most = most_pixels_[name];
        most = std::max(most, pixels);
      }
      const std::clock_t begin = std::clock();
      const auto seen = detectObjects(frame.cloud, frame.camera.in_map);
      mapper_.update(frame.cloud, frame.camera, seen, frame.stamp);
      seconds_ += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      ++frames_;
    }
    mapper_.consolidate();
  }

  static std::map<Id, Id> match(const ObjectMap& map, const ObjectMap& truth) {
    struct Pair {
      double away;
      Id a, b;
    };
    std::vector<Pair> pairs;
    for (const ObjectInstance& a : map.objects) {
      if (!a.pose || a.existence < 0.5) continue;
      for (const ObjectInstance& b : truth.objects) {
        const bool furniture = b.kind == "furniture";
        if (furniture != (a.properties.count("furniture") != 0)) continue;
        const Point3 &p = a.pose->position, &q = b.pose->position;
        const double away = std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
        if (away < (furniture ? 0.25 : 0.15)) pairs.push_back({away, a.id, b.id});
      }
    }
    std::sort(pairs.begin(), pairs.end(),
              [](const Pair& x, const Pair& y) { return x.away < y.away; });
    std::map<Id, Id> of;
    std::set<Id> taken;
    for (const Pair& pair : pairs) {
      if (of.count(pair.a) != 0 || !taken.insert(pair.b).second) continue;
      of[pair.a] = pair.b;
    }
    return of;
  }

  FlatScores compare() const {
    FlatScores scores;
    std::vector<std::string> names;
    const ObjectMap truth = after_.truth(&names);
    const std::map<Id, Id> of = match(map_, truth);
    scores.objects = static_cast<int>(truth.objects.size());
    const std::set<Id> found = compareInstances(truth, names, of, scores);
    compareRecall(names, found, scores);
    compareRelations(truth, names, of, scores);
    return scores;
  }

  /// Precision and kinds of the objects of the map. Returns the true objects that were found.
  std::set<Id> compareInstances(const ObjectMap& truth, const std::vector<std::string>& names,
                                const std::map<Id, Id>& of, FlatScores& scores) const {
    std::set<Id> found;
    int mapped = 0, named = 0, things_found = 0;
    for (const ObjectInstance& object : map_.objects) {
      if (!object.pose || object.existence < 0.5) continue;
      ++mapped;
      const auto pair = of.find(object.id);
      if (pair == of.end()) {
        const Point3& p = object.pose->position;
        scores.faults.push_back("not there: " + object.kind + " at " + std::to_string(p.x) + " " +
                                std::to_string(p.y) + " " + std::to_string(p.z) + " seen " +
                                std::to_string(object.detections) + " missed " +
                                std::to_string(object.missed_detections));
        continue;
      }
      found.insert(pair->second);
      const std::string& kind = truth.find(pair->second)->kind;
      if (kind == "furniture") continue;
      ++things_found;
      named += object.kind == kind;
      if (object.kind != kind) {
        scores.faults.push_back("is called " + object.kind + ": " + names[pair->second - 1]);
      }
    }
    scores.precision = static_cast<double>(found.size()) / std::max(1, mapped);
    scores.kinds = static_cast<double>(named) / std::max(1, things_found);
    return found;
  }

  void compareRecall(const std::vector<std::string>& names, const std::set<Id>& found,
                     FlatScores& scores) const {
    int seen_and_found = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool is_found = found.count(static_cast<Id>(i + 1)) != 0;
      const auto pixels = most_pixels_.find(names[i]);
      const int most = pixels == most_pixels_.end() ? 0 : pixels->second;
      scores.hidden += most < kFewPixels;
      seen_and_found += is_found && most >= kFewPixels;
      if (is_found) continue;
      scores.faults.push_back("not found: " + names[i] + ", at most " + std::to_string(most) +
                              " pixels in a frame");
    }
    scores.recall_of_seen =
        static_cast<double>(seen_and_found) / std::max(1, scores.objects - scores.hidden);
    scores.recall = static_cast<double>(found.size()) / std::max(1, scores.objects);
  }

  void compareRelations(const ObjectMap& truth, const std::vector<std::string>& names,
                        const std::map<Id, Id>& of, FlatScores& scores) const {
    std::set<std::string> wanted, made;
    const auto sentence = [](const std::string& a, const char* word, const std::string& b) {
      return a + " " + word + " " + b;
    };
    for (const ObjectRelation& r : truth.relations) {
      wanted.insert(sentence(names[r.object - 1], toString(r.word),
                             r.place != 0 ? truth.findPlace(r.place)->name : names[r.other - 1]));
    }
    const auto name = [&](Id id) {
      const auto pair = of.find(id);
      return pair == of.end() ? "?" + std::to_string(id) : names[pair->second - 1];
    };
    for (const ObjectRelation& r : map_.relations) {
      if (map_.find(r.object)->existence < 0.5) continue;
      made.insert(sentence(name(r.object), toString(r.word),
                           r.place != 0 ? map_.findPlace(r.place)->name : name(r.other)));
    }
    int right = 0;
    for (const std::string& each : made) {
      right += static_cast<int>(wanted.count(each));
      if (wanted.count(each) == 0) scores.faults.push_back("not so: " + each);
    }
    for (const std::string& each : wanted) {
      if (made.count(each) == 0) scores.faults.push_back("not told: " + each);
    }
    scores.relation_precision = right / std::max(1.0, static_cast<double>(made.size()));
    scores.relation_recall = right / std::max(1.0, static_cast<double>(wanted.size()));
  }

  Furnished furnished_;
  Flat before_, after_;
  int every_;
  ObjectMap map_;
  ObjectMapper mapper_;
  std::map<std::string, int> most_pixels_;  // in one frame of the present tour
  double seconds_ = 0.0;
  int frames_ = 0;
};

}  // namespace simulated
}  // namespace hyselam_objects
