#include "hyselam_language/building/describe_building.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "grammar/compiled_grammar.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_language/building/place_names.hpp"

namespace hyselam_topo {
namespace {

class Teller {
 public:
  Teller(const DescribedBuilding& building, const Grammar& grammar)
      : building_(building), grammar_(grammar), names_({grammar}) {}

  std::string tell() {
    if (building_.place_count) {
      say("building", {{"count", std::to_string(*building_.place_count)}});
    }
    tellConnections();
    for (const DescribedPlace& place : building_.places) tellOf(place);
    for (const DescribedRelation& relation : building_.relations) tell(relation);
    for (const DescribedPlace& place : building_.places) {
      if (told_.count(place.id) == 0) say("exists", {{"place", plain(place.name)}});
    }
    if (building_.robot_place && robot_ != *building_.robot_place) {
      say("robot_in", {{"place", named(*building_.robot_place)}});
    }
    return std::move(text_);
  }

 private:
  using Values = std::vector<std::pair<std::string, std::string>>;

  /// The template of a key with its values; prepositions and articles grow together.
  void say(const std::string& key, const Values& values) {
    std::string sentence = grammar_.say(key);
    for (const auto& [name, value] : values) {
      const std::size_t at = sentence.find("{" + name + "}");
      if (at == std::string::npos) continue;
      std::size_t from = at;
      std::string put = value;
      const std::size_t word = at >= 2 ? sentence.rfind(' ', at - 2) : std::string::npos;
      const std::size_t begin = word == std::string::npos ? 0 : word + 1;
      const std::size_t space = value.find(' ');
      if (at > begin && space != std::string::npos) {
        const std::string both = sentence.substr(begin, at - begin) + value.substr(0, space);
        if (grammar_.has(both)) {
          from = begin;
          put = grammar_.say(both) + value.substr(space + 1);
        }
      }
      sentence.replace(from, at + name.size() + 2 - from, put);
    }
    // Only articles may begin with a capital: names stay as they are.
    for (const char* key_of_article : {"article", "feminine_article"}) {
      const std::string& article = grammar_.say(key_of_article);
      if (sentence.compare(0, article.size(), article) == 0 && article[0] >= 'a' &&
          article[0] <= 'z') {
        sentence[0] = static_cast<char>(sentence[0] - 'a' + 'A');
        break;
      }
    }
    text_ += (text_.empty() ? "" : " ") + sentence;
  }

  /// The name, between quotation marks if it needs them.
  std::string plain(const std::string& name) const {
    if (grammar_.isPlainName(name)) return name;
    static const std::array<std::pair<const char*, const char*>, 3> kQuotes{
        {{"\"", "\""}, {"\xe2\x80\x9c", "\xe2\x80\x9d"}, {"\xc2\xab", "\xc2\xbb"}}};
    for (const auto& [open, close] : kQuotes) {
      const bool inside =
          name.find(open) != std::string::npos || name.find(close) != std::string::npos;
      if (!inside) return open + name + close;
    }
    throw hyselam::InputError("description", "place '" + name + "'",
                              "its name holds all kinds of quotation marks");
  }

  /// With an article, if it is a common noun: "the living room", but "room A", "I-109".
  std::string named(Id id) {
    told_.insert(id);
    const std::string& name = building_.findPlace(id)->name;
    std::string quoted = plain(name);
    if (quoted != name) return quoted;
    const auto* type = grammar_.compiled().nameType("place");
    const std::string folded = hyselam::utf8Fold(name);
    const bool common = type != nullptr && std::all_of(name.begin(), name.end(), [](char c) {
                          return !(c >= 'A' && c <= 'Z') && !(c >= '0' && c <= '9') && c != '\'';
                        });
    if (!common || type->nouns.count(folded) == 0) return name;
    const std::string first = folded.substr(0, folded.find(' '));
    return grammar_.say(type->feminine.count(first) != 0 ? "feminine_article" : "article") + name;
  }

  std::string list(const std::vector<Id>& ids) {
    std::string text;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (i > 0) text += grammar_.say(i + 1 == ids.size() ? "and" : "comma");
      text += named(ids[i]);
    }
    return text;
  }

  void tellConnections() {
    // From which places, on which sides, in the order told.
    std::vector<std::pair<Id, Side>> rows;
    for (const DescribedConnection& connection : building_.connections) {
      const std::pair<Id, Side> row{connection.from, connection.side};
      if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
    }
    std::stable_sort(rows.begin(), rows.end(),
                     [&](const auto& a, const auto& b) { return place(a.first) < place(b.first); });
    for (const auto& [from, side] : rows) {
      std::vector<std::pair<std::size_t, Id>> row;
      for (const DescribedConnection& connection : building_.connections) {
        if (connection.from == from && connection.side == side) {
          row.emplace_back(connection.order, connection.to);
        }
      }
      std::sort(row.begin(), row.end());
      std::vector<Id> ids;
      ids.reserve(row.size());
      for (const auto& [order, to] : row) ids.push_back(to);
      if (side == Side::kUnknown) {
        const std::string where = named(from);
        say("unknown", {{"place", where}, {"places", list(ids)}});
        continue;
      }
      if (robot_ != from) say("robot_in", {{"place", named(from)}});
      robot_ = from;
      say(toString(side), {{"places", list(ids)}});
    }
  }

  std::size_t place(Id id) const {
    return static_cast<std::size_t>(building_.findPlace(id) - building_.places.data());
  }

  void tellOf(const DescribedPlace& place) {
    const auto number = [](double value) { return hyselam::formatNumber(value); };
    const auto sayOf = [&](const char* key, Values values) {
      values.insert(values.begin(), {"place", named(place.id)});
      say(key, values);
    };
    if (place.length && place.width) {
      sayOf("size", {{"length", number(*place.length)}, {"width", number(*place.width)}});
    } else if (place.length) {
      sayOf("length", {{"length", number(*place.length)}});
    } else if (place.width) {
      sayOf("width", {{"width", number(*place.width)}});
    }
    if (place.area && !(place.length && place.width)) {
      sayOf("area", {{"area", number(*place.area)}});
    }
    if (place.parts) sayOf("parts", {{"count", std::to_string(*place.parts)}});
    const auto guessed = names_.kindOf(place.name);
    if (place.kind && place.kind != guessed) sayOf(toString(*place.kind), {});
    for (const std::string& alias : place.aliases) sayOf("alias", {{"name", plain(alias)}});
  }

  void tell(const DescribedRelation& relation) {
    const std::string a = named(relation.a), b = named(relation.b);
    const std::string c = relation.c != 0 ? named(relation.c) : "";
    say(toString(relation.kind), {{"a", a}, {"b", b}, {"c", c}});
  }

  const DescribedBuilding& building_;
  const Grammar& grammar_;
  PlaceNames names_;
  std::set<Id> told_;
  Id robot_ = 0;
  std::string text_;
};

}  // namespace

std::string describeBuilding(const DescribedBuilding& building, const Grammar& grammar) {
  checkDescription(building, "description");
  return Teller(building, grammar).tell();
}

}  // namespace hyselam_topo
