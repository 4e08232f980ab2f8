// Rooms told in a row come out in that row, whatever words join them and wherever sentences end.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "hyselam_language/building/description_builder.hpp"
#include "shipped_parser.hpp"

namespace hyselam_topo {
namespace {

/// How a language tells a row; {} is a room.
struct Telling {
  std::string language, start, corridor;
  std::vector<std::string> rooms;
  std::vector<std::string> first;     ///< of a row on the left, by one sentence
  std::vector<std::string> in_list;   ///< between rooms of a sentence
  std::vector<std::string> sentence;  ///< of the next room
  std::vector<std::string> beside;    ///< the first one beside the room where a row begins
};

const std::vector<Telling>& tellings() {
  static const std::vector<Telling> kAll{
      {"en",
       "You are in the corridor.",
       "corridor",
       {"the kitchen", "the library", "the archive", "the print room", "the gym", "the chapel",
        "Anna's office", "the store"},
       {"On your left you have {}", "On the left is {}", "The first door on the left is {}",
        "First on the left is {}", "On your left there's {}"},
       {", then {}", ", and then {}", ", followed by {}", ", after that {}", ", next comes {}",
        " and then {}", ", then comes {}"},
       {"Then comes {}.", "After that there is {}.", "Next is {}.", "The next door is {}.",
        "And then {}.", "Then you have {}.", "After that you get to {}.", "Finally {}.",
        "After it comes {}.", "One further along is {}.", "The one after that is {}.",
        "{} comes right after that.", "{} after that."},
       {"Next to {x} is {}", "Beside {x} there is {}", "{} is next to {x}"}},
      {"pt",
       "Estás no corredor.",
       "corredor",
       {"a cozinha", "a biblioteca", "o arquivo", "a reprografia", "o ginásio", "a capela",
        "o gabinete da Ana", "a despensa"},
       {"À tua esquerda tens {}", "À esquerda fica {}", "A primeira porta à esquerda é {}",
        "Do lado esquerdo há {}", "À esquerda temos {}"},
       {", depois {}", " e depois {}", ", a seguir {}", " e a seguir {}", ", logo depois {}"},
       {"Depois vem {}.", "A seguir fica {}.", "Logo depois há {}.", "E a seguir é {}.",
        "Logo a seguir tens {}.", "E por fim {}.", "Em seguida vem {}.", "Depois disso há {}.",
        "E depois {}."},
       {"Ao lado d{x} fica {}", "Mesmo ao lado d{x} há {}"}}};
  return kAll;
}

std::string put(std::string text, const std::string& key, const std::string& value) {
  const std::size_t at = text.find(key);
  return at == std::string::npos ? text : text.replace(at, key.size(), value);
}

std::string capital(std::string text) {
  if (text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string bare(const std::string& room) {
  const std::size_t space = room.find(' ');
  const std::string word = room.substr(0, space);
  return word == "the" || word == "a" || word == "o" ? room.substr(space + 1) : room;
}

struct Heard {
  DescribedBuilding building;
  std::string problems;
  std::string nameOf(Id id) const { return building.findPlace(id)->name; }
};

Heard hear(const std::string& text, const std::string& language) {
  ParseOptions options;
  options.language = language;
  const ParsedText parsed = testing::shippedParser().parse(text, options);
  DescriptionBuilder builder(testing::shippedParser());
  Heard heard;
  for (const DescriptionIssue& issue : builder.add(parsed)) heard.problems += issue.reason + "; ";
  for (const Utterance& each : parsed.utterances) {
    if (!each.understood()) heard.problems += each.text + ": " + each.reason + "; ";
    if (!each.to_confirm.empty()) heard.problems += "asks " + each.to_confirm + "; ";
  }
  heard.building = builder.building();
  return heard;
}

/// The rooms on the left of where the robot is, in their order.
std::vector<std::string> rowOnTheLeft(const Heard& heard) {
  std::vector<std::pair<std::size_t, std::string>> row;
  for (const DescribedConnection& each : heard.building.connections) {
    if (each.side == Side::kLeft) row.emplace_back(each.order, heard.nameOf(each.to));
  }
  std::sort(row.begin(), row.end());
  std::vector<std::string> names;
  for (auto& [order, name] : row) names.push_back(name);
  return names;
}

class ToldRows : public ::testing::TestWithParam<int> {
 protected:
  template <typename T>
  const T& any(const std::vector<T>& all) {
    return all[std::uniform_int_distribution<std::size_t>(0, all.size() - 1)(rng_)];
  }
  std::vector<std::string> rooms(const Telling& telling, std::size_t count) {
    std::vector<std::string> all = telling.rooms;
    std::shuffle(all.begin(), all.end(), rng_);
    all.resize(count);
    return all;
  }
  /// The rooms from the second on, some in the sentence, some in sentences of their own.
  std::string rest(const Telling& telling, const std::vector<std::string>& row, std::size_t begin) {
    std::string text;
    bool open = true;
    for (std::size_t i = begin; i < row.size(); ++i) {
      open = open && std::bernoulli_distribution(0.5)(rng_);
      if (!open && text.find('.') == std::string::npos) text += ".";
      text += open ? put(any(telling.in_list), "{}", row[i])
                   : " " + capital(put(any(telling.sentence), "{}", row[i]));
    }
    return text + (open ? "." : "");
  }

  std::mt19937 rng_{static_cast<std::mt19937::result_type>(GetParam())};
};

TEST_P(ToldRows, OnASideAreThatRow) {
  for (const Telling& telling : tellings()) {
    const std::size_t count = 2 + static_cast<std::size_t>(GetParam()) % 4;
    const std::vector<std::string> row = rooms(telling, count);
    const std::string text =
        telling.start + " " + put(any(telling.first), "{}", row[0]) + rest(telling, row, 1);
    const Heard heard = hear(text, telling.language);
    std::vector<std::string> wanted;
    for (const std::string& room : row) wanted.push_back(bare(room));
    EXPECT_EQ(rowOnTheLeft(heard), wanted) << text << "\n" << heard.problems;
    EXPECT_EQ(heard.problems, "") << text;
    for (const DescribedRelation& each : heard.building.relations) {
      EXPECT_EQ(each.kind, RelationKind::kAfter) << text;
      const auto last = std::find(wanted.begin(), wanted.end(), heard.nameOf(each.b));
      ASSERT_TRUE(last != wanted.end() && last + 1 != wanted.end()) << text;
      EXPECT_EQ(*(last + 1), heard.nameOf(each.a)) << text;
    }
  }
}

/// "Next to the bar is the lab, then the store": nothing but the lab is next to the bar.
TEST_P(ToldRows, BesideARoomGoOnFromTheLastOne) {
  for (const Telling& telling : tellings()) {
    const std::size_t count = 3 + static_cast<std::size_t>(GetParam()) % 3;
    std::vector<std::string> row = rooms(telling, count);
    std::string first = put(any(telling.beside), "{}", row[1]);
    const bool turned = first.find(row[1]) == 0;  // "{} is next to {x}", then sentences follow
    first = put(first, "{x}", row[0]);
    std::string more;
    for (std::size_t i = 2; i < row.size(); ++i) {
      more += turned ? " " + capital(put(any(telling.sentence), "{}", row[i]))
                     : put(any(telling.in_list), "{}", row[i]);
    }
    const std::string text =
        telling.start + " " + capital(first) + (turned ? "." : "") + more + (turned ? "" : ".");
    const Heard heard = hear(text, telling.language);
    EXPECT_EQ(heard.problems, "") << text;
    ASSERT_EQ(heard.building.relations.size(), count - 1) << text;
    for (std::size_t i = 1; i < count; ++i) {
      const DescribedRelation& each = heard.building.relations[i - 1];
      EXPECT_EQ(each.kind, i == 1 ? RelationKind::kNextTo : RelationKind::kAfter) << text;
      EXPECT_EQ(heard.nameOf(each.a), bare(row[i])) << text;
      EXPECT_EQ(heard.nameOf(each.b), bare(row[i - 1])) << text;
    }
    EXPECT_TRUE(heard.building.connections.empty()) << text << ": no side was told";
  }
}

/// The connection of the last place told, with the robot at (3, 0).
DescribedConnection toldFrom(const std::string& text, const std::string& language,
                             const std::optional<hyselam::Pose2>& view) {
  ParseOptions options;
  options.language = language;
  DescriptionBuilder builder(testing::shippedParser());
  builder.setRobotPlace(language == "pt" ? "corredor" : "corridor", PlaceKind::kCorridor);
  builder.setViewpoint(view);
  builder.add(testing::shippedParser().parse(text, options));
  return builder.building().connections.empty() ? DescribedConnection{}
                                                : builder.building().connections.front();
}

TEST(ToldHere, IsTheNearestDoorOfThatSide) {
  const hyselam::Pose2 view{3.0, 0.0, 0.0};
  const std::vector<std::pair<std::string, std::string>> said{
      {"en", "Here on your left is the kitchen."},
      {"en", "Right here on the left there's the kitchen."},
      {"en", "The kitchen is here on your left."},
      {"en", "The kitchen is on your left here."},
      {"en", "This first door here on your left, that's the kitchen."},
      {"en", "This big door on your left is the kitchen."},
      {"en", "Here on the left you have the kitchen, then the library."},
      {"pt", "Aqui à esquerda fica a cozinha."},
      {"pt", "Esta porta à esquerda é a cozinha."},
      {"pt", "A primeira porta aqui à esquerda é a cozinha."},
      {"pt", "Aqui do lado esquerdo é a cozinha, depois a biblioteca."}};
  for (const auto& [language, text] : said) {
    const DescribedConnection told = toldFrom(text, language, view);
    EXPECT_EQ(told.side, Side::kLeft) << text;
    EXPECT_EQ(told.distance, std::optional<double>(0.0)) << text;
    EXPECT_FALSE(told.rank) << text;
    // Where nobody knows where that is, it says no more than the side.
    EXPECT_FALSE(toldFrom(text, language, std::nullopt).distance) << text;
  }
  const std::vector<std::pair<std::string, std::string>> others{
      {"en", "On your left is the kitchen."},
      {"en", "The second door here on your left is the kitchen."},
      {"en", "Here on your left are the kitchen and the library."},
      {"en", "This is a hall, and on your left is the kitchen."},
      {"pt", "À esquerda fica a cozinha."},
      {"pt", "Aqui à esquerda ficam a cozinha e a biblioteca."}};
  for (const auto& [language, text] : others) {
    EXPECT_FALSE(toldFrom(text, language, view).distance) << text;
  }
}

/// From farther on, the same side is no news, and the number stays.
TEST(ToldHere, TheSameSideSaidAgainKeepsTheNumber) {
  DescriptionBuilder builder(testing::shippedParser());
  builder.setRobotPlace("corridor", PlaceKind::kCorridor);
  builder.setViewpoint(hyselam::Pose2{0.0, 0.0, 0.0});
  builder.add(testing::shippedParser().parse("The third door on the right is the store."));
  builder.setViewpoint(hyselam::Pose2{6.0, 0.0, 0.0});
  builder.add(testing::shippedParser().parse("The store is on the right."));
  ASSERT_EQ(builder.building().connections.size(), 1u);
  EXPECT_EQ(builder.building().connections[0].rank, 3);
  builder.setViewpoint(hyselam::Pose2{6.0, 0.0, 3.14});
  builder.add(testing::shippedParser().parse("The store is on the left."));
  EXPECT_EQ(builder.building().connections[0].side, Side::kLeft);
}

/// What may be meant otherwise is no row and no side.
TEST(ToldRow, NothingIsTakenFromAnotherPlace) {
  const Heard after =
      hear("Estás no corredor. A segunda porta à direita é a copa, logo a seguir à receção.", "pt");
  ASSERT_EQ(after.building.relations.size(), 1u);
  EXPECT_EQ(after.nameOf(after.building.relations[0].a), "copa");
  EXPECT_EQ(after.nameOf(after.building.relations[0].b), "receção");
  const Heard side = hear(
      "You are in the corridor. The bar is on the left. The gym is opposite the bar. Then comes "
      "the "
      "lab.",
      "en");
  for (const DescribedConnection& each : side.building.connections) {
    EXPECT_NE(side.nameOf(each.to), "lab") << "on no side";
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ToldRows, ::testing::Range(1, 61));

}  // namespace
}  // namespace hyselam_topo
