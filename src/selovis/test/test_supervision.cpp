// The topological map, learning while driving, and the test of the pose by the place seen.
#include <gtest/gtest.h>

#include <cmath>
#include <condition_variable>
#include <mutex>
#include <set>
#include <tuple>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "selovis/learner.hpp"
#include "selovis/recogniser.hpp"
#include "selovis/supervisor.hpp"
#include "selovis/topology.hpp"

namespace selovis {
namespace {

using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

/// Four rooms of 2 m x 2 m in a row; the first and the last are both called "store".
hyselam_topo::AugmentedTopologicalMap row() {
  hyselam_topo::AugmentedTopologicalMap map;
  hyselam_topo::PlaceGrid grid;
  grid.geometry = {40, 10, 0.2, {1.0, -1.0, 0.0}};
  const char* const names[] = {"store", "kitchen", "", "store"};
  for (hyselam_topo::Id id = 1; id <= 4; ++id) {
    hyselam_topo::Place place;
    place.id = id;
    if (*names[id - 1] != '\0') place.words.push_back({names[id - 1], id == 1});
    place.centre = hyselam::Point3{2.0 * id, 0.0, 0.0};
    grid.places.push_back(id);
    map.places.push_back(place);
    if (id > 1) {
      hyselam_topo::Edge edge;
      edge.a = id - 1;
      edge.b = id;
      map.edges.push_back(edge);
    }
  }
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 40; ++x) grid.labels.push_back(static_cast<std::uint16_t>(1 + x / 10));
  }
  map.grid = grid;
  hyselam_topo::normalise(&map);
  return map;
}

TEST(Topology, PlacesOfOneNameAreOneVertex) {
  const PlaceGraph g = graphOf(row());
  EXPECT_EQ(g.places, (std::vector<std::string>{"store", "kitchen", "room 3"}));
  EXPECT_TRUE(g.connected(0, 1));
  EXPECT_TRUE(g.connected(1, 2));
  EXPECT_TRUE(g.connected(2, 0));
}

TEST(Topology, IsReadFromXmlJsonAndCsv) {
  TemporaryDirectory folder;
  hyselam_topo::saveXml(folder / "topo.xml", row());
  EXPECT_EQ(readTopology(folder / "topo.xml").places, graphOf(row()).places);
  EXPECT_EQ(readTopology(folder / "topo.xml").transitions, graphOf(row()).transitions);
  writeFile(folder / "g.csv", "store,kitchen\n");
  EXPECT_EQ(readTopology(folder / "g.csv").places.size(), 2u);
  writeFile(folder / "bad.xml", "<topological_map><place></topological_map>");
  EXPECT_NE(
      messageOf<hyselam::InputError>([&] { readTopology(folder / "bad.xml"); }).find("bad.xml"),
      std::string::npos);
}

TEST(Topology, PlacesNearAPointTheOwnOneFirst) {
  const auto map = row();
  EXPECT_EQ(placesNear(map, {2.0, 0.0}, 0.5), std::vector<std::string>{"store"});
  EXPECT_EQ(placesNear(map, {3.3, 0.0}, 0.5), (std::vector<std::string>{"kitchen", "store"}));
  EXPECT_EQ(placesNear(map, {6.9, 0.0}, 0.3), (std::vector<std::string>{"room 3", "store"}));
  EXPECT_TRUE(placesNear(map, {100.0, 0.0}, 0.5).empty());
  EXPECT_TRUE(placesNear(map, {std::nan(""), 0.0}, 0.5).empty());
  EXPECT_TRUE(placesNear({}, {0.0, 0.0}, 0.5).empty());
}

/// row() with virtual places that were told: in the kitchen "desk", on it "drawer", beside it
/// "sink"; in the first store "sofa"; in room 3 "corner". Two columns of cells belong to each.
hyselam_topo::AugmentedTopologicalMap furnished() {
  auto map = row();
  for (const auto& [id, around, name, x] :
       {std::tuple(5, 2, "desk", 12), std::tuple(6, 5, "drawer", 14), std::tuple(7, 2, "sink", 16),
        std::tuple(8, 1, "sofa", 5), std::tuple(9, 3, "corner", 25)}) {
    hyselam_topo::Place place;
    place.id = static_cast<hyselam_topo::Id>(id);
    place.kind = hyselam_topo::PlaceKind::kVirtual;
    place.words.push_back({name, true});
    map.places.push_back(place);
    map.grid->places.push_back(place.id);
    for (int y = 0; y < 10; ++y) {
      map.grid->labels[static_cast<std::size_t>(40 * y + x)] = static_cast<std::uint16_t>(id);
      map.grid->labels[static_cast<std::size_t>(40 * y + x + 1)] = static_cast<std::uint16_t>(id);
    }
    hyselam_topo::Edge edge;
    edge.a = static_cast<hyselam_topo::Id>(around);
    edge.b = place.id;
    map.edges.push_back(edge);
  }
  return map;
}

TEST(Topology, WhatTheCameraIsExpectedToSee) {
  using Names = std::set<std::string>;
  const auto map = furnished();
  PlaceGraph learnt;
  learnt.places = {"store", "kitchen", "desk", "drawer", "sink", "sofa", "attic"};
  const auto named = [&](const std::vector<int>& places) {
    Names names;
    for (const int i : places) names.insert(learnt.places[static_cast<std::size_t>(i)]);
    return names;
  };
  const auto at = [&](double x, double reach = 0.05) {
    const ExpectedPlaces e = expectedPlaces(map, learnt, {x, 0.0}, reach);
    EXPECT_EQ(named(e.unmapped), e.agree.empty() ? Names() : Names{"attic"});
    return std::pair(e.own, named(e.agree));
  };
  const Names kitchen{"kitchen", "desk", "drawer", "sink"};
  EXPECT_EQ(at(4.7), std::pair(std::string("kitchen"), kitchen));
  EXPECT_EQ(at(3.7), std::pair(std::string("desk"), kitchen));
  EXPECT_EQ(at(4.1), std::pair(std::string("drawer"), kitchen)) << "told inside the desk";
  EXPECT_EQ(at(1.5), std::pair(std::string("store"), Names({"store", "sofa"})));
  EXPECT_EQ(at(8.5), std::pair(std::string("store"), Names({"store"}))) << "the other one";
  // Within reach, what was told there is as good as what has walls.
  Names both = kitchen;
  both.insert({"store", "sofa"});
  EXPECT_EQ(at(3.1, 0.5).second, both);
  // Never learnt, or nowhere: nothing is expected.
  EXPECT_EQ(at(6.5), std::pair(std::string("room 3"), Names()));
  EXPECT_EQ(at(6.1), std::pair(std::string("corner"), Names()));
  EXPECT_EQ(at(50.0), std::pair(std::string(), Names()));
  // A virtual place that was told after learning is in a room that was learnt.
  learnt.places = {"store", "kitchen", "attic"};
  EXPECT_EQ(at(4.1), std::pair(std::string("drawer"), Names({"kitchen"})));
}

TEST(Topology, WhoIsCalledOtherwiseThanBefore) {
  const auto before = row();
  const auto renamings = [&](hyselam_topo::AugmentedTopologicalMap after) {
    std::vector<std::pair<std::string, std::string>> found;
    for (const auto& r : renamedPlaces(before, after)) found.emplace_back(r.from, r.to);
    return found;
  };
  using Found = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(renamings(before), Found());
  auto after = before;
  after.places[2].words.push_back({"library", false});
  after.places[2].centre->x += 0.3;
  EXPECT_EQ(renamings(after), (Found{{"room 3", "library"}}));
  after.places[3].words = {{"lab", true}};  // the first one is a store still
  EXPECT_EQ(renamings(after), (Found{{"room 3", "library"}}));
  // The same number in another building.
  after.places[2].centre->x += 0.3;
  EXPECT_EQ(renamings(after), Found());
  after.places[2].centre.reset();
  EXPECT_EQ(renamings(after), Found());
  after.places.resize(2);
  EXPECT_EQ(renamings(after), Found());

  PlaceGraph learnt;
  learnt.places = {"store", "room 3", "room 4", "lab"};
  EXPECT_EQ(rename({{"room 3", "library"}, {"room 4", "lab"}, {"attic", "roof"}}, &learnt), 1u);
  EXPECT_EQ(learnt.places, (std::vector<std::string>{"store", "library", "room 4", "lab"}));
}

TEST(Topology, SpreadOfAPlaceIsThatOfItsCells) {
  const auto spread = spreadOf(row(), "kitchen");
  ASSERT_TRUE(spread);
  EXPECT_NEAR(spread->mean.x, 4.0, 1e-9);
  EXPECT_NEAR(spread->mean.y, 0.0, 1e-9);
  EXPECT_NEAR(spread->stddev.x, 2.0 / std::sqrt(12.0), 0.01);
  EXPECT_NEAR(spreadOf(row(), "store")->mean.x, 5.0, 1e-9) << "both of that name";
  EXPECT_FALSE(spreadOf(row(), "cellar"));
}

/// A row of places; frames that see `seen` with that probability.
PlaceGraph chain(int n) {
  PlaceGraph g;
  for (int i = 0; i < n; ++i) {
    g.places.push_back("place " + std::to_string(i));
    if (i > 0) g.transitions.emplace_back(i - 1, i);
  }
  return g;
}
std::vector<double> sees(int n, int seen, double probability = 0.9) {
  std::vector<double> p(static_cast<std::size_t>(n), (1.0 - probability) / (n - 1));
  p[static_cast<std::size_t>(seen)] = probability;
  return p;
}

TEST(Supervisor, APoseThatAgreesIsNeverDoubted) {
  Supervisor s(chain(8), {});
  for (int i = 0; i < 1000; ++i) {
    const Supervision r = s.update(sees(8, 3), {3});
    EXPECT_TRUE(r.judged);
    EXPECT_FALSE(r.kidnapped);
    EXPECT_EQ(r.evidence, 0.0);
  }
}

TEST(Supervisor, AKidnappedRobotIsNoticedInAFewFramesAndItsPlaceTold) {
  Supervisor s(chain(8), {});
  for (int i = 0; i < 50; ++i) s.update(sees(8, 3), {3});
  int frames = 0;
  Supervision r;
  do {
    r = s.update(sees(8, 6, 0.97), {3});
    ASSERT_LT(++frames, 8);
  } while (!r.alarm);
  EXPECT_GT(frames, 2) << "no single frame is believed";
  EXPECT_TRUE(r.kidnapped);
  EXPECT_EQ(r.place, 6);
  // It stays so, and one alarm is enough; then the pose is set right.
  EXPECT_FALSE(s.update(sees(8, 6), {3}).alarm);
  for (int i = 0; i < 40; ++i) r = s.update(sees(8, 6), {6});
  EXPECT_FALSE(r.kidnapped);
  EXPECT_EQ(r.evidence, 0.0);
}

TEST(Supervisor, FramesThatContradictEachOtherRaiseNoAlarm) {
  // One of four frames sees some other place: a classifier at 75 %, whose mistakes are scattered.
  hyselam::Rng rng(3);
  Supervisor s(chain(12), {});
  for (int i = 0; i < 4000; ++i) {
    const int seen = i % 4 == 0 ? static_cast<int>(rng.below(12)) : 5;
    EXPECT_FALSE(s.update(sees(12, seen), {5}).kidnapped) << i;
  }
}

TEST(Supervisor, PlacesNextToThePoseCountAsItsOwn) {
  Supervisor s(chain(5), {});
  for (int i = 0; i < 200; ++i) EXPECT_FALSE(s.update(sees(5, 2), {1, 2}).kidnapped);
}

TEST(Supervisor, APlaceThatNobodyPutOnTheMapSpeaksNeitherForNorAgainst) {
  Supervisor s(chain(8), {});
  for (int i = 0; i < 200; ++i) {
    const Supervision r = s.update(sees(8, 6), {3}, {6});
    EXPECT_FALSE(r.kidnapped);
    EXPECT_LT(r.evidence, 0.5);
  }
  // An alarm stands meanwhile, until places of the map tell more.
  int frames = 0;
  while (!s.update(sees(8, 0, 0.97), {3}, {6}).kidnapped) ASSERT_LT(++frames, 8);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(s.update(sees(8, 6), {3}, {6}).kidnapped) << i;
  for (int i = 0; i < 20; ++i) s.update(sees(8, 3), {3}, {6});
  EXPECT_FALSE(s.update(sees(8, 3), {3}, {6}).kidnapped);
  // Where all that is left is such a place, there is nothing to compare.
  EXPECT_FALSE(Supervisor(chain(2), {}).update({0.5, 0.5}, {0}, {1}).judged);
}

TEST(Supervisor, WithoutAPoseNothingIsJudged) {
  Supervisor s(chain(5), {});
  for (int i = 0; i < 200; ++i) {
    const Supervision r = s.update(sees(5, 2), {});
    EXPECT_FALSE(r.judged || r.kidnapped);
  }
  EXPECT_FALSE(Supervisor(chain(1), {}).update({1.0}, {0}).judged) << "there is no elsewhere";
  EXPECT_FALSE(s.update(std::vector<double>(5, 0.0), {1}).kidnapped)
      << "a frame that tells nothing";
}

TEST(Supervisor, ResetForgets) {
  Supervisor s(chain(6), {});
  for (int i = 0; i < 30; ++i) s.update(sees(6, 5), {0});
  s.reset();
  const Supervision r = s.update(sees(6, 0), {0});
  EXPECT_FALSE(r.kidnapped);
  EXPECT_EQ(r.evidence, 0.0);
}

TEST(Supervisor, ALocalisationThatIsLostIsToldThePlace) {
  Supervisor s(chain(8), {});
  for (int i = 0; i < 50; ++i) s.update(sees(8, 3), {});
  EXPECT_EQ(s.update(sees(8, 3), {}).place, -1) << "nobody asked";
  s.doubt();
  int frames = 0;
  Supervision r;
  do {
    r = s.update(sees(8, 6, 0.97), {});
    EXPECT_TRUE(r.kidnapped);
    EXPECT_FALSE(r.alarm) << "it has told so itself";
    ASSERT_LT(++frames, 8);
  } while (r.place < 0);
  EXPECT_EQ(r.place, 6);
  EXPECT_GT(frames, 1) << "no single frame is believed";
  // It has found itself, and the camera agrees.
  for (int i = 0; i < 40; ++i) r = s.update(sees(8, 6), {6});
  EXPECT_FALSE(r.kidnapped);
}

TEST(Supervisor, WrongNumbersAreRefused) {
  Supervisor s(chain(4), {});
  EXPECT_THROW(s.update({0.5, 0.5}, {0}), std::invalid_argument);
  EXPECT_THROW(s.update({0.5, -0.5, 0.0, 1.0}, {0}), std::invalid_argument);
  EXPECT_THROW(s.update({0.5, std::nan(""), 0.0, 1.0}, {0}), std::invalid_argument);
  EXPECT_THROW(s.update(sees(4, 1), {4}), std::invalid_argument);
  EXPECT_THROW(s.update(sees(4, 1), {1}, {-1}), std::invalid_argument);
  SupervisorParams p;
  p.threshold = 0.0;
  EXPECT_THROW(Supervisor(chain(4), p), hyselam::ParameterError);
}

// Learning

cv::Mat pictureOf(int place, int i) {
  cv::Mat image(60, 80, CV_8UC3, cv::Scalar(40 + 60 * place, 160, 90));
  for (int x = i % 3; x < 80; x += 4 + 5 * place) image.col(x).setTo(cv::Scalar::all(10));
  return image;
}

std::shared_ptr<const Model> nothingLearnt() {
  TrainingOptions options;
  options.descriptor = "LGOP";
  options.classifier.kernel = Kernel::kExemplar;
  options.views = {0.0, 0.1};
  return std::make_shared<Model>(emptyModel(options));
}

/// A drive through "store" and "kitchen".
std::unique_ptr<Learner> drive(const std::shared_ptr<const Model>& model) {
  auto learner = std::make_unique<Learner>(model, LearnerParams());
  for (int i = 0; i < 40; ++i) {
    learner->add(pictureOf(i / 20, i), {}, i / 20 ? "kitchen" : "store", {2.0 + 0.1 * i, 0.0, 0.5},
                 1.2, 10.0 + 0.2 * i);
  }
  return learner;
}

TEST(Learner, KeepsAFrameOncePerWayAndPlace) {
  const auto model = nothingLearnt();
  const auto learner = drive(model);
  EXPECT_NEAR(static_cast<double>(learner->frames().size()), 17.0, 4.0) << "every 0.2 m of 4 m";
  EXPECT_EQ(learner->frames().front().values.size(), 2u);
  const std::size_t before = learner->frames().size();
  hyselam::Pose2 near = learner->frames().back().camera;
  near.x += 0.05;
  EXPECT_FALSE(learner->add(pictureOf(1, 1), {}, "kitchen", near, 1.2, 20.0));
  near.theta += 0.5;
  EXPECT_TRUE(learner->add(pictureOf(1, 1), {}, "kitchen", near, 1.2, 20.2)) << "turned";
  EXPECT_EQ(learner->frames().size(), before + 1);
  EXPECT_THROW(learner->add(cv::Mat(), {}, "hall", {0.0, 0.0, 0.0}, 1.2, 21.0),
               std::invalid_argument);
  EXPECT_EQ(learner->frames().size(), before + 1);
}

TEST(Learner, FramesGoWithTheirPlacesName) {
  const auto learner = drive(nothingLearnt());
  const auto count = [&](const std::string& name) {
    const auto& frames = learner->frames();
    return std::count_if(frames.begin(), frames.end(),
                         [&](const LearntFrame& f) { return f.place == name; });
  };
  const auto kitchen = count("kitchen");
  learner->rename({{"kitchen", "lab"}, {"attic", "roof"}});
  EXPECT_EQ(count("kitchen"), 0);
  EXPECT_EQ(count("lab"), kitchen);
  EXPECT_GT(kitchen, 0);
}

TEST(Learner, WhatWasLearntOnTheWayIsRecognised) {
  const auto model = nothingLearnt();
  const auto learner = drive(model);
  Model trained = *model;
  learn(trained, learner->frames());
  EXPECT_EQ(trained.graph.places, (std::vector<std::string>{"store", "kitchen"}));
  EXPECT_TRUE(trained.graph.connected(0, 1));
  Recogniser recogniser(trained, trained.graph, {});
  int right = 0;
  for (int i = 0; i < 40; ++i) {
    right += recogniser.update(pictureOf(i / 20, i + 3)).frame_place == i / 20;
  }
  EXPECT_GE(right, 38);
  // More on a later drive: no door between the last place of one drive and the first of the next.
  LearntFrame more = learner->frames().front();
  more.place = "hall";
  more.stamp = 5000.0;
  learn(trained, {more});
  EXPECT_EQ(trained.graph.find("hall"), 2);
  EXPECT_FALSE(trained.graph.connected(1, 2));
}

TEST(Learner, SignaturesGoIntoTheMapAndComeBack) {
  const auto model = nothingLearnt();
  const auto learner = drive(model);
  auto map = row();
  std::vector<LearntFrame> frames = learner->frames();
  frames.back().place = "nowhere";
  EXPECT_EQ(store(frames, *model, {}, &map), 1u);
  TemporaryDirectory folder;
  hyselam_topo::saveXml(folder / "topo.xml", map);
  const auto back = framesOf(hyselam_topo::loadXml(folder / "topo.xml"), *model);
  ASSERT_EQ(back.size(), frames.size() - 1);
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].place, frames[i].place);
    EXPECT_EQ(back[i].stamp, frames[i].stamp);
    EXPECT_EQ(back[i].values, frames[i].values);
    EXPECT_NEAR(back[i].camera.x, frames[i].camera.x, 1e-12);
    EXPECT_NEAR(back[i].camera.theta, frames[i].camera.theta, 1e-12);
    EXPECT_EQ(back[i].height, 1.2);
  }
  const auto& signature = map.places.front().signatures.at(1);
  EXPECT_NEAR(*signature.heading, 0.5 + 0.1 * LearnerParams().aperture_x, 1e-9)
      << "a view shifted to the right is that of a camera turned to the left";
  // A signature without a heading has no pose that a filter over poses may use.
  map.places.front().signatures.front().heading.reset();
  const double stamp = map.places.front().signatures.front().stamp;
  for (const auto& frame : framesOf(map, *model)) {
    EXPECT_EQ(frame.camera.isFinite(), frame.stamp != stamp);
  }
  Model other = *model;
  other.descriptor = "GLANCE";
  EXPECT_TRUE(framesOf(map, other).empty()) << "signatures of another descriptor";
}

TEST(Learner, TrainsInTheBackground) {
  const auto model = nothingLearnt();
  const auto learner = drive(model);
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<BackgroundTraining::Outcome> outcome;
  const auto done = [&](const BackgroundTraining::Outcome& o) {
    const std::lock_guard<std::mutex> lock(mutex);
    outcome = o;
    changed.notify_all();
  };
  BackgroundTraining training;
  const auto trainOn = [&](std::vector<LearntFrame> frames) {
    outcome.reset();
    while (!training.start(model, frames, done)) std::this_thread::yield();
    std::unique_lock<std::mutex> lock(mutex);
    changed.wait(lock, [&] { return outcome.has_value(); });
  };
  trainOn(learner->frames());
  ASSERT_TRUE(outcome->model) << outcome->error;
  EXPECT_EQ(outcome->model->graph.places.size(), 2u);
  EXPECT_EQ(outcome->frames, learner->frames().size());
  EXPECT_EQ(model->samples.count(), 0u) << "the model in use is not touched";
  // One place only; signatures of another length.
  trainOn({learner->frames().begin(), learner->frames().begin() + 3});
  EXPECT_FALSE(outcome->model);
  EXPECT_FALSE(outcome->error.empty());
  LearntFrame bad = learner->frames().front();
  bad.values.front().pop_back();
  trainOn({bad});
  EXPECT_NE(outcome->error.find("values"), std::string::npos);
}

TEST(Learner, ATrainingWhoseOutcomeNobodyTakesEndsLikeAnyOther) {
  const auto model = nothingLearnt();
  BackgroundTraining training;
  ASSERT_TRUE(training.start(
      model, {}, [](const BackgroundTraining::Outcome&) { throw std::runtime_error("gone"); }));
  while (training.busy()) std::this_thread::yield();
  EXPECT_TRUE(training.start(model, {}, [](const BackgroundTraining::Outcome&) {}));
}

TEST(Learner, RefusesWhatCannotBeLearntOnTheWay) {
  TrainingOptions options;
  options.descriptor = "BOF-ORB500";
  EXPECT_NE(messageOf<std::invalid_argument>([&] { emptyModel(options); }).find("dictionary"),
            std::string::npos);
  LearnerParams p;
  p.aperture_x = 0.0;
  EXPECT_THROW(Learner(nothingLearnt(), p), hyselam::ParameterError);
}

}  // namespace
}  // namespace selovis
