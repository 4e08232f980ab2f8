// Piles of household articles: they lie on each other and not within each other, and a camera's
// depth is that of what it sees.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/pile.hpp"

using namespace hyselam_sim;  // NOLINT: a test, not a header

namespace {

std::vector<PlacedArticle> somePile(std::uint64_t seed) {
  hyselam::Rng rng(seed);
  return dropPile({&householdThing("mug"), &householdThing("drill"), &householdThing("tin"),
                   &householdThing("stapler")},
                  rng);
}

std::vector<PlacedArticle> without(std::vector<PlacedArticle> pile, std::size_t i) {
  pile.erase(pile.begin() + static_cast<std::ptrdiff_t>(i));
  return pile;
}

TEST(Pile, ThingsHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const Article& article : household()) {
    EXPECT_TRUE(names.insert(article.name).second) << article.name;
    for (const cv::Vec3d& p : article.surface) EXPECT_LT(std::abs(article.distance(p)), 1e-3);
  }
  EXPECT_THROW(householdThing("elephant"), hyselam::InputError);
}

TEST(Pile, ThingsTouchAndAreNotWithinEachOther) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const std::vector<PlacedArticle> pile = somePile(seed);
    ASSERT_EQ(pile.size(), 4u);
    for (std::size_t i = 0; i < pile.size(); ++i) {
      const double free = clearance(pile[i], without(pile, i));
      EXPECT_GT(free, -2e-3) << pile[i].article->name << ", seed " << seed;
      EXPECT_LT(free, 2e-3) << pile[i].article->name << ", seed " << seed;
    }
  }
}

TEST(Pile, EqualSeedsGiveEqualPilesAndOthersOthers) {
  EXPECT_EQ(somePile(1)[1].pose.at, somePile(1)[1].pose.at);
  EXPECT_NE(somePile(1)[1].pose.at, somePile(2)[1].pose.at);
}

TEST(Pile, DepthIsThatOfTheThingsSeen) {
  const std::vector<PlacedArticle> pile = somePile(1);
  CameraParams params;
  params.width = 160;
  params.height = 120;
  const Pose3 camera = cameraAround(0.4, 0.9, 0.8);
  hyselam::Rng rng(5);
  const CameraFrame frame = viewOfPile(params, pile, camera, rng);
  int measured = 0;
  for (int v = 0; v < params.height; ++v) {
    for (int u = 0; u < params.width; ++u) {
      const std::int32_t owner = frame.owner.at<std::int32_t>(v, u);
      const double z = 1e-3 * frame.depth.at<std::uint16_t>(v, u);
      if (owner == 0 || z == 0.0) continue;
      ++measured;
      const double f = params.focalLength();
      const cv::Vec3d p{(u - 79.5) * z / f, (v - 59.5) * z / f, z};
      const PlacedArticle& thing = pile[static_cast<std::size_t>(owner) - 1];
      EXPECT_LT(std::abs(thing.article->distance(thing.pose.inverse() * (camera * p))), 6e-3);
    }
  }
  EXPECT_GT(measured, 500);
}

}  // namespace
