// Running talk about a floor becomes rows of rooms with certainties, and names of doors with odds;
// the sampling is compared with all answers there are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/xml_testing.hpp"
#include "hyselam_language/reader/tour_match.hpp"
#include "hyselam_language/reader/tour_reader.hpp"
#include "reader/tour_layout.hpp"
#include "reader/tour_model.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header

namespace {

const TourReader& english() {
  static const TourReader reader = TourReader::shipped(Grammar::shipped("en"));
  return reader;
}

std::vector<std::string> namesOf(const std::vector<TourRoom>& row) {
  std::vector<std::string> names;
  for (const TourRoom& room : row) names.push_back(room.name);
  return names;
}

using Names = std::vector<std::string>;

/// Anything goes.
TourEvidence randomEvidence(std::size_t rooms, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto real = [&] { return static_cast<double>(random() >> 11) * 0x1.0p-53; };
  TourEvidence evidence(rooms);
  for (std::size_t a = 0; a < rooms; ++a) {
    const double left = real();
    evidence.addSide(a, 1.0, left, 1.0 - left);
    const double first = 0.8 * real(), last = (1.0 - first) * real();
    evidence.addPosition(a, 0.5, first, last, 1.0 - first - last);
    for (std::size_t b = 0; b < a; ++b) {
      const double before = real(), behind = (1.0 - before) * real();
      const double facing = (1.0 - before - behind) * real();
      evidence.addPair(a, b, 0.7, {before, behind, facing, 1.0 - before - behind - facing});
    }
  }
  return evidence;
}

}  // namespace

TEST(TourReader, TellsRowsOfTalkThatTheGrammarRefuses) {
  const ToldTour tour = english().read(
      "Right, off we go then. On your left that's the staff room, mind the coats, and then the "
      "archive, and after the archive it's Doctor Silva. On your right there's the kitchen first, "
      "then the laboratory, and last on the right comes the library, which I never go to.");
  EXPECT_EQ(namesOf(tour.left), (Names{"staff room", "archive", "Doctor Silva"}));
  EXPECT_EQ(namesOf(tour.right), (Names{"kitchen", "laboratory", "library"}));
  for (const auto* row : {&tour.left, &tour.right}) {
    for (const TourRoom& room : *row) {
      EXPECT_GT(room.side_certainty, 0.7) << room.name;
      EXPECT_LE(room.side_certainty, 1.0);
      EXPECT_GE(room.order_certainty, 0.5) << room.name;
      ASSERT_FALSE(room.said.empty());
    }
  }
}

TEST(TourReader, LeftAndRightSaidForEachOtherGiveTheMirroredTour) {
  const auto read = [](const std::string& one, const std::string& other) {
    return english().read(
        "So on the " + one + " you've got the kitchen and then the archive. On the " + other +
        " it's the library, and opposite the archive, on the " + other + ", the workshop.");
  };
  const ToldTour tour = read("left", "right"), mirrored = read("right", "left");
  EXPECT_EQ(namesOf(tour.left), namesOf(mirrored.right));
  EXPECT_EQ(namesOf(tour.right), namesOf(mirrored.left));
}

TEST(TourReader, OneRoomUnderSeveralNamesIsOneRoom) {
  const ToldTour tour = english().read(
      "On the left there's Doctor Silva, then the archive. The doctor is next to the archive. "
      "The ward 4 is on the right, after ward four comes the laundry.");
  const auto times = [&](const std::string& part) {
    return std::count_if(tour.names.begin(), tour.names.end(), [&](const TourName& name) {
      return name.name.find(part) != std::string::npos;
    });
  };
  EXPECT_EQ(1, times("octor"));
  EXPECT_EQ(1, times("ward"));
  EXPECT_EQ(1, times("archive"));
  const auto found = english().find(tour, "the doctor");
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ("Doctor Silva", tour.names[*found].name);
  EXPECT_FALSE(english().find(tour, "chapel").has_value());
}

TEST(TourReader, ReadsPortuguese) {
  const ToldTour tour =
      TourReader::shipped(Grammar::shipped("pt"))
          .read(
              "Olha, à tua esquerda tens a cozinha, depois vem a biblioteca. Do lado "
              "direito é a farmácia e a seguir a oficina.");
  EXPECT_EQ(namesOf(tour.left), (Names{"cozinha", "biblioteca"}));
  EXPECT_EQ(namesOf(tour.right), (Names{"farmácia", "oficina"}));
}

TEST(TourReader, AnyTextIsReadAndTheSameTextGivesTheSame) {
  for (const std::string& text :
       {std::string(), std::string(" .!?;\n"), std::string("\xff\xfe left \x80 right"),
        std::string(50000, 'a'), std::string(30000, ' ') + "the lab"}) {
    EXPECT_NO_THROW(english().read(text));
  }
  std::string many;
  for (int room = 0; room < 300; ++room)
    many += "On the left is room " + std::to_string(room) + ". ";
  EXPECT_LE(english().read(many).names.size(), 60u);
  const std::string text =
      "On the left the kitchen, the lab and the archive, across from the lab is Anna.";
  const ToldTour a = english().read(text), b = english().read(text);
  EXPECT_EQ(namesOf(a.left), namesOf(b.left));
  ASSERT_EQ(a.left.size(), b.left.size());
  for (std::size_t k = 0; k < a.left.size(); ++k)
    EXPECT_EQ(a.left[k].side_certainty, b.left[k].side_certainty);
}

TEST(TourReader, RefusesModelsThatAreNone) {
  const Grammar grammar = Grammar::shipped("en");
  hyselam::testing::expectError(hyselam::testing::messageOf<hyselam::InputError>(
                                    [] { language::TourModel::fromText("m.txt", "hello"); }),
                                {"m.txt", "hyselam_tour_reader 1"});
  hyselam::testing::expectError(hyselam::testing::messageOf<hyselam::InputError>([] {
                                  language::TourModel::fromText("m.txt", "hyselam_tour_reader 9\n");
                                }),
                                {"m.txt", "9"});
  EXPECT_FALSE(TourReader::isShipped("xx"));
}

TEST(TourDescription, SaysHowSureItIs) {
  const ToldTour tour =
      english().read("On the left the kitchen, then the archive. On the right the library.");
  const DescribedBuilding building = describeTour(tour, "corridor");
  EXPECT_NO_THROW(checkDescription(building, "tour"));
  ASSERT_EQ(3u, building.connections.size());
  EXPECT_EQ(building.robot_place, building.places.front().id);
  for (const DescribedConnection& each : building.connections) {
    EXPECT_GT(each.side_certainty, 0.0);
    EXPECT_LT(each.side_certainty, 1.0);
  }
}

/// The shares in which each room is on the left, over all layouts.
TEST(TourLayout, SamplesWhatAllLayoutsTogetherSay) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    constexpr std::size_t kRooms = 4;
    const TourEvidence e = randomEvidence(kRooms, seed);
    std::vector<double> left(kRooms, 0.0);
    double all = 0.0, best = -1e9;
    std::vector<std::size_t> order(kRooms);
    std::iota(order.begin(), order.end(), std::size_t{0});
    do {
      for (unsigned sides = 0; sides < 1u << kRooms; ++sides) {
        const auto is_left = [&](std::size_t room) { return (sides >> room & 1u) != 0; };
        double sum = 0.0;
        std::map<bool, std::vector<std::size_t>> rows;
        for (const std::size_t room : order) rows[is_left(room)].push_back(room);
        for (const auto& [side, row] : rows) {
          for (std::size_t k = 0; k < row.size(); ++k) {
            sum += side ? e.left[row[k]] : e.right[row[k]];
            sum += k == 0                ? e.first[row[k]]
                   : k + 1 == row.size() ? e.last[row[k]]
                                         : e.inner[row[k]];
            for (std::size_t j = k + 1; j < row.size(); ++j)
              sum += e.before[row[k] * kRooms + row[j]];
          }
        }
        for (std::size_t a = 0; a < kRooms; ++a)
          for (std::size_t b = a + 1; b < kRooms; ++b)
            if (is_left(a) != is_left(b))
              sum +=
                  std::log(std::exp(e.facing[a * kRooms + b]) + std::exp(e.apart[a * kRooms + b]));
        best = std::max(best, sum);
        all += std::exp(sum);
        for (std::size_t room = 0; room < kRooms; ++room)
          left[room] += is_left(room) ? std::exp(sum) : 0.0;
      }
    } while (std::next_permutation(order.begin(), order.end()));
    language::TourLayoutParams params;
    params.sweeps = 6000;
    const language::TourLayout layout = language::layOut(e, params);
    for (const auto& room : layout.left)
      EXPECT_NEAR(left[room.room] / all, room.side_certainty, 0.05) << seed;
    for (const auto& room : layout.right)
      EXPECT_NEAR(1.0 - left[room.room] / all, room.side_certainty, 0.05) << seed;
    EXPECT_EQ(kRooms, layout.left.size() + layout.right.size());
  }
}

TEST(TourMatch, NamesDoorsAsTold) {
  // Names 0, 1 on the left in this order, 2 across from 1.
  TourEvidence e(3);
  e.addSide(0, 1.0, 0.95, 0.05);
  e.addSide(1, 1.0, 0.95, 0.05);
  e.addPair(0, 1, 1.0, {0.95, 0.02, 0.02, 0.01});
  e.addPair(1, 2, 1.0, {0.02, 0.02, 0.94, 0.02});
  const std::vector<TourSlot> slots{{true, 2.0}, {true, 8.0}, {false, 2.5}, {false, 8.5}};
  const TourMatch match = matchTour(e, slots);
  EXPECT_EQ(0u, match.best[0]);
  EXPECT_EQ(1u, match.best[1]);
  EXPECT_EQ(2u, match.best[3]);
  EXPECT_FALSE(match.best[2].has_value());
  EXPECT_GT(match.of(3, 2), match.of(2, 2));
}

TEST(TourMatch, AnswersCountAndMayNotContradict) {
  const TourEvidence e = randomEvidence(5, 7);
  const std::vector<TourSlot> slots{{true, 1.0}, {true, 5.0}, {false, 1.0}, {false, 5.0}};
  TourConstraints known;
  known.confirmed = {{1, 4}};
  known.excluded = {{0, 0}};
  known.unnamed = {3};
  const TourMatch match = matchTour(e, slots, {}, known);
  EXPECT_EQ(4u, match.best[1]);
  EXPECT_EQ(1.0, match.of(1, 4));
  EXPECT_EQ(0.0, match.of(0, 0));
  EXPECT_FALSE(match.best[3].has_value());
  EXPECT_NE(match.question(), std::optional<std::size_t>(1));
  for (std::size_t slot = 0; slot < slots.size(); ++slot) {
    double sum = 0.0;
    for (std::size_t name = 0; name < 5; ++name) sum += match.of(slot, name);
    EXPECT_LE(sum, 1.0 + 1e-9);
  }
  known.excluded.emplace_back(1, 4);
  EXPECT_THROW(matchTour(e, slots, {}, known), hyselam::InputError);
  EXPECT_THROW(matchTour(e, slots, {}, {{{9, 0}}, {}, {}}), hyselam::InputError);
  EXPECT_TRUE(matchTour(TourEvidence(0), slots).probability.empty());
  EXPECT_TRUE(matchTour(e, {}).best.empty());
}

TEST(TourMatch, WhatNobodySaysAnythingOfIsOpen) {
  TourEvidence e(2);
  const TourMatch match = matchTour(e, {{true, 1.0}, {false, 1.0}});
  EXPECT_NEAR(match.of(0, 0), match.of(1, 0), 0.1);
  EXPECT_TRUE(match.question().has_value());
  EXPECT_GT(match.entropy(0), 0.9);
}
