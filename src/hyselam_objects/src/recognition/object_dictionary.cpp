#include "hyselam_objects/recognition/object_dictionary.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "check_words.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam_objects {
namespace {

bool isFinite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

}  // namespace

const GenericObject* ObjectDictionary::find(const std::string& word) const {
  const auto found = std::find_if(objects.begin(), objects.end(), [&](const GenericObject& each) {
    return each.name == word ||
           std::find(each.synonyms.begin(), each.synonyms.end(), word) != each.synonyms.end();
  });
  return found == objects.end() ? nullptr : &*found;
}

void ObjectDictionary::put(GenericObject object) {
  const auto at = std::lower_bound(
      objects.begin(), objects.end(), object,
      [](const GenericObject& a, const GenericObject& b) { return a.name < b.name; });
  if (at != objects.end() && at->name == object.name) {
    *at = std::move(object);
  } else {
    objects.insert(at, std::move(object));
  }
}

bool operator==(const GenericObject& a, const GenericObject& b) {
  const auto tied = [](const GenericObject& o) {
    return std::tie(o.name, o.synonyms, o.shape.size, o.shape.spread, o.texture, o.features,
                    o.classifier.type, o.classifier.views, o.classifier.max_distance);
  };
  return tied(a) == tied(b);
}

bool operator==(const ObjectDictionary& a, const ObjectDictionary& b) {
  return a.objects == b.objects;
}

ObjectDictionary merged(const ObjectDictionary& a, const ObjectDictionary& b,
                        std::size_t max_views) {
  ObjectDictionary out = a;
  for (const GenericObject& other : b.objects) {
    const GenericObject* mine = out.find(other.name);
    if (mine == nullptr) {
      out.put(other);
      continue;
    }
    const bool others_is_better = other.classifier.views.size() > mine->classifier.views.size();
    GenericObject both = others_is_better ? other : *mine;
    const GenericObject& second = others_is_better ? *mine : other;
    const bool alike =
        both.classifier.type == second.classifier.type && !both.classifier.views.empty() &&
        !second.classifier.views.empty() &&
        both.classifier.views.front().size() == second.classifier.views.front().size();
    if (alike) {
      for (const auto& view : second.classifier.views) {
        auto& views = both.classifier.views;
        if (views.size() >= max_views) break;
        if (std::find(views.begin(), views.end(), view) == views.end()) views.push_back(view);
      }
      both.classifier.max_distance =
          std::max(both.classifier.max_distance, second.classifier.max_distance);
    }
    both.name = mine->name;
    for (const std::string& word : second.synonyms) {
      if (out.find(word) == nullptr) both.synonyms.push_back(word);
    }
    both.features.insert(second.features.begin(), second.features.end());
    out.put(std::move(both));
  }
  return out;
}

void checkDictionary(const ObjectDictionary& dictionary, const std::string& source) {
  std::set<std::string> words;
  std::string before;
  for (const GenericObject& object : dictionary.objects) {
    const auto require = [&](bool good, const char* reason) {
      if (!good) throw hyselam::InputError(source, "object '" + object.name + "'", reason);
    };
    require(isWord(object.name), "its name is no word");
    require(before < object.name, "it stands twice or is out of order");
    before = object.name;
    require(words.insert(object.name).second, "another object has this name, too");
    for (const std::string& word : object.synonyms) {
      require(isWord(word), "another word for it is none");
      require(words.insert(word).second, "another object has one of its words, too");
    }
    for (const auto& lengths : {object.shape.size, object.shape.spread}) {
      for (const double length : lengths) {
        require(length >= 0.0 && std::isfinite(length), "a length is negative or not finite");
      }
    }
    for (const auto& [name, value] : object.features) {
      require(isWord(name) && std::isfinite(value), "a feature is none");
    }
    require(isFinite(object.texture), "its texture is not finite");
    const GenericClassifier& classifier = object.classifier;
    require(classifier.views.empty() || isWord(classifier.type),
            "the type of its classifier is no word");
    require(classifier.max_distance >= 0.0 && std::isfinite(classifier.max_distance),
            "the distance accepted is negative or not finite");
    for (const auto& view : classifier.views) {
      require(!view.empty() && view.size() == classifier.views.front().size() && isFinite(view),
              "a view is empty, not finite or has another length than the first");
    }
  }
}

}  // namespace hyselam_objects
