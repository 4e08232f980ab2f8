// Learning places while driving: frames, signatures in the map, training in the background.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "four_rooms.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "selovis/learning/background_training.hpp"
#include "selovis/learning/learner.hpp"
#include "selovis/recognition/image_recognizer.hpp"

namespace selovis {
namespace {

using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using testing::fourRooms;

cv::Mat imageOf(int place, int i) {
  cv::Mat image(60, 80, CV_8UC3, cv::Scalar(40 + 60 * place, 160, 90));
  for (int x = i % 3; x < 80; x += 4 + 5 * place) image.col(x).setTo(cv::Scalar::all(10));
  return image;
}

std::shared_ptr<const PlaceModel> untrained() {
  TrainingOptions options;
  options.descriptor = "LGOP";
  options.classifier.kernel = SvmKernel::kExemplar;
  options.views = {0.0, 0.1};
  return std::make_shared<PlaceModel>(untrainedPlaceModel(options));
}

/// A drive through "store" and "kitchen".
std::unique_ptr<Learner> drive(const std::shared_ptr<const PlaceModel>& model) {
  auto learner = std::make_unique<Learner>(model, LearnerParams());
  for (int i = 0; i < 40; ++i) {
    learner->add(imageOf(i / 20, i), {}, i / 20 ? "kitchen" : "store", {2.0 + 0.1 * i, 0.0, 0.5},
                 1.2, 10.0 + 0.2 * i);
  }
  return learner;
}

TEST(Learner, KeepsAFramePerDistanceTurnAndPlace) {
  const auto model = untrained();
  const auto learner = drive(model);
  EXPECT_NEAR(static_cast<double>(learner->frames().size()), 17.0, 4.0) << "every 0.2 m of 4 m";
  EXPECT_EQ(learner->frames().front().signatures.size(), 2u);
  const std::size_t before = learner->frames().size();
  hyselam::Pose2 near = learner->frames().back().camera;
  near.x += 0.05;
  EXPECT_FALSE(learner->add(imageOf(1, 1), {}, "kitchen", near, 1.2, 20.0));
  near.theta += 0.5;
  EXPECT_TRUE(learner->add(imageOf(1, 1), {}, "kitchen", near, 1.2, 20.2)) << "turned";
  EXPECT_EQ(learner->frames().size(), before + 1);
  EXPECT_THROW(learner->add(cv::Mat(), {}, "hall", {0.0, 0.0, 0.0}, 1.2, 21.0),
               hyselam::InputError);
  EXPECT_EQ(learner->frames().size(), before + 1);
}

TEST(Learner, FramesFollowTheNewNameOfTheirPlace) {
  const auto learner = drive(untrained());
  const auto count = [&](const std::string& name) {
    const auto& frames = learner->frames();
    return std::count_if(frames.begin(), frames.end(),
                         [&](const LearnedFrame& f) { return f.place == name; });
  };
  const auto kitchen = count("kitchen");
  learner->rename({{"kitchen", "lab"}, {"attic", "roof"}});
  EXPECT_EQ(count("kitchen"), 0);
  EXPECT_EQ(count("lab"), kitchen);
  EXPECT_GT(kitchen, 0);
}

TEST(Learner, RecognizesWhatWasLearnedWhileDriving) {
  const auto model = untrained();
  const auto learner = drive(model);
  PlaceModel trained = learnFrames(*model, learner->frames());
  EXPECT_EQ(trained.transitions.places, (std::vector<std::string>{"store", "kitchen"}));
  EXPECT_TRUE(trained.transitions.connected(0, 1));
  ImageRecognizer recognizer(trained, trained.transitions, {});
  int right = 0;
  for (int i = 0; i < 40; ++i) {
    right += recognizer.update(imageOf(i / 20, i + 3)).frame_place == i / 20;
  }
  EXPECT_GE(right, 38);
  // More on a later drive: no door between the last place of one drive and the first of the next.
  LearnedFrame more = learner->frames().front();
  more.place = "hall";
  more.stamp = 5000.0;
  trained = learnFrames(trained, {more});
  EXPECT_EQ(trained.transitions.indexOf("hall"), 2);
  EXPECT_FALSE(trained.transitions.connected(1, 2));
}

/// The number of frames of each tour, as a fusion tells tours apart.
std::vector<std::size_t> sizesOfTours(const Samples& samples) {
  std::vector<std::size_t> sizes{0};
  int last = samples.frames.front();
  for (const int frame : samples.frames) {
    if (frame - last >= kTourGap) sizes.push_back(0);
    sizes.back() += frame != last || sizes.back() == 0;
    last = frame;
  }
  return sizes;
}

TEST(Learner, PausesAndTrainingsOnTheWayAreNoNewTours) {
  const auto model = untrained();
  const auto learner = drive(model);
  const std::vector<LearnedFrame>& all = learner->frames();
  const auto half = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2 + 2);
  PlaceModel trained = learnFrames(*model, {all.begin(), half});
  trained = learnFrames(trained, {half, all.end()});
  EXPECT_EQ(sizesOfTours(trained.samples), std::vector<std::size_t>{all.size()}) << "trained twice";
  EXPECT_EQ(trained.samples.frames.back(), static_cast<int>(all.size()) - 1);
  // It stands for a minute, then drives on: not consecutive, but the same tour.
  const auto later = [&](double seconds) {
    std::vector<LearnedFrame> frames = all;
    for (LearnedFrame& f : frames) f.stamp += seconds;
    return frames;
  };
  trained = learnFrames(trained, later(60.0));
  EXPECT_EQ(sizesOfTours(trained.samples), std::vector<std::size_t>{2 * all.size()});
  EXPECT_GE(trained.samples.frames.back(), static_cast<int>(2 * all.size()) + kPauseGap - 2);
  // In the afternoon, and after the clock was set back.
  trained = learnFrames(trained, later(20000.0));
  trained = learnFrames(trained, later(0.0));
  EXPECT_EQ(sizesOfTours(trained.samples),
            (std::vector<std::size_t>{2 * all.size(), all.size(), all.size()}));
  // A model that was loaded does not know when it was learned.
  TemporaryDirectory folder;
  savePlaceModel(trained, folder / "m");
  trained = learnFrames(loadPlaceModel(folder / "m"), later(10.0));
  EXPECT_EQ(sizesOfTours(trained.samples).size(), 4u);
}

TEST(Learner, SignaturesSurviveTheTopologicalMap) {
  const auto model = untrained();
  const auto learner = drive(model);
  auto map = fourRooms();
  std::vector<LearnedFrame> frames = learner->frames();
  frames.back().place = "nowhere";
  EXPECT_EQ(storeSignatures(frames, *model, {}, map), 1u);
  TemporaryDirectory folder;
  hyselam_topo::saveXml(folder / "topo.xml", map);
  const auto back = framesFromMap(hyselam_topo::loadXml(folder / "topo.xml"), *model);
  ASSERT_EQ(back.size(), frames.size() - 1);
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].place, frames[i].place);
    EXPECT_EQ(back[i].stamp, frames[i].stamp);
    EXPECT_EQ(back[i].signatures, frames[i].signatures);
    EXPECT_NEAR(back[i].camera.x, frames[i].camera.x, 1e-12);
    EXPECT_NEAR(back[i].camera.theta, frames[i].camera.theta, 1e-12);
    EXPECT_EQ(back[i].height, 1.2);
  }
  const auto& signature = map.places.front().signatures.at(1);
  EXPECT_NEAR(*signature.heading, 0.5 + 0.1 * LearnerParams().horizontal_fov, 1e-9)
      << "a view shifted to the right is that of a camera turned to the left";
  // A signature without a heading has no pose that a filter over poses may use.
  map.places.front().signatures.front().heading.reset();
  const double stamp = map.places.front().signatures.front().stamp;
  for (const auto& frame : framesFromMap(map, *model)) {
    EXPECT_EQ(frame.camera.isFinite(), frame.stamp != stamp);
  }
  PlaceModel other = *model;
  other.descriptor = "GLANCE";
  EXPECT_TRUE(framesFromMap(map, other).empty()) << "signatures of another descriptor";
}

TEST(BackgroundTraining, TrainsWithoutTouchingTheModelInUse) {
  const auto model = untrained();
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
  const auto trainOn = [&](std::vector<LearnedFrame> frames) {
    outcome.reset();
    while (!training.start(model, frames, done)) std::this_thread::yield();
    std::unique_lock<std::mutex> lock(mutex);
    changed.wait(lock, [&] { return outcome.has_value(); });
  };
  trainOn(learner->frames());
  ASSERT_TRUE(outcome->model) << outcome->error;
  EXPECT_EQ(outcome->model->transitions.places.size(), 2u);
  EXPECT_EQ(outcome->frames, learner->frames().size());
  EXPECT_EQ(model->samples.count(), 0u) << "the model in use is not touched";
  // One place only; signatures of another length.
  trainOn({learner->frames().begin(), learner->frames().begin() + 3});
  EXPECT_FALSE(outcome->model);
  EXPECT_FALSE(outcome->error.empty());
  LearnedFrame bad = learner->frames().front();
  bad.signatures.front().pop_back();
  trainOn({bad});
  EXPECT_NE(outcome->error.find("values"), std::string::npos);
}

TEST(BackgroundTraining, EndsWhenItsHandlerThrows) {
  const auto model = untrained();
  BackgroundTraining training;
  ASSERT_TRUE(training.start(
      model, {}, [](const BackgroundTraining::Outcome&) { throw std::runtime_error("gone"); }));
  while (training.busy()) std::this_thread::yield();
  EXPECT_TRUE(training.start(model, {}, [](const BackgroundTraining::Outcome&) {}));
}

TEST(Learner, RefusesDescriptorsWithADictionaryAndBadParameters) {
  TrainingOptions options;
  options.descriptor = "BOF-ORB500";
  EXPECT_NE(
      messageOf<hyselam::InputError>([&] { untrainedPlaceModel(options); }).find("dictionary"),
      std::string::npos);
  LearnerParams p;
  p.horizontal_fov = 0.0;
  EXPECT_THROW(Learner(untrained(), p), hyselam::ParameterError);
}

}  // namespace
}  // namespace selovis
