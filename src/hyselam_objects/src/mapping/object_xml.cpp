// Dictionary and map as XML.
#include <tinyxml2.h>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/xml_document.hpp"
#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/recognition/object_dictionary.hpp"

namespace hyselam_objects {
namespace {

using hyselam::XmlElement;

constexpr int kVersion = 1;
// Of maps; since 2 objects have an outline. Those of version 1 are read, too.
constexpr int kMapVersion = 2;
constexpr char kDictionaryNamespace[] = "urn:hyselam:object_dictionary:1";
constexpr char kMapNamespace[] = "urn:hyselam:object_map:1";
constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

hyselam::XmlLimits limits() {
  hyselam::XmlLimits out;
  out.max_bytes = kMaxBytes;
  return out;
}

class Writer {
 public:
  std::string write(const ObjectDictionary& dictionary) {
    begin("object_dictionary", kDictionaryNamespace, kVersion);
    for (const GenericObject& object : dictionary.objects) write(object);
    out_.CloseElement();
    return out_.CStr();
  }

  std::string write(const ObjectMap& map) {
    begin("object_map", kMapNamespace, kMapVersion);
    attribute("frame_id", map.frame_id);
    attribute("stamp", map.stamp);
    attribute("next_place_id", map.next_place_id);
    attribute("next_object_id", map.next_object_id);
    for (const ObjectPlace& place : map.places) {
      out_.OpenElement("place");
      attribute("id", place.id);
      attribute("name", place.name);
      if (place.topological != 0) attribute("topological", place.topological);
      out_.CloseElement();
    }
    for (const ObjectInstance& object : map.objects) write(object);
    for (const ObjectRelation& relation : map.relations) write(relation);
    out_.CloseElement();
    return out_.CStr();
  }

 private:
  void begin(const char* name, const char* xml_namespace, int version) {
    out_.PushHeader(false, true);
    out_.OpenElement(name);
    attribute("xmlns", std::string(xml_namespace));
    attribute("version", std::to_string(version));
  }
  void attribute(const char* name, const std::string& value) {
    out_.PushAttribute(name, value.c_str());
  }
  void attribute(const char* name, Id value) { attribute(name, std::to_string(value)); }
  void attribute(const char* name, int value) { attribute(name, std::to_string(value)); }
  void attribute(const char* name, double value) { attribute(name, hyselam::formatNumber(value)); }
  void attribute(const char* name, bool value) {
    attribute(name, std::string(value ? "true" : "false"));
  }
  void point(const Point3& p) {
    attribute("x", p.x);
    attribute("y", p.y);
    attribute("z", p.z);
  }
  template <typename Values>
  void numbers(const char* name, const Values& values) {
    std::string text;
    for (const auto value : values) {
      text += (text.empty() ? "" : " ") + hyselam::formatNumber(static_cast<double>(value));
    }
    out_.OpenElement(name);
    out_.PushText(text.c_str());
    out_.CloseElement();
  }

  void write(const GenericObject& object) {
    out_.OpenElement("object");
    attribute("name", object.name);
    for (const std::string& word : object.synonyms) {
      out_.OpenElement("also");
      attribute("name", word);
      out_.CloseElement();
    }
    numbers("size", object.shape.size);
    numbers("spread", object.shape.spread);
    if (!object.texture.empty()) numbers("texture", object.texture);
    for (const auto& [name, value] : object.features) {
      out_.OpenElement("feature");
      attribute("name", name);
      attribute("value", value);
      out_.CloseElement();
    }
    const GenericClassifier& classifier = object.classifier;
    if (!classifier.views.empty()) {
      out_.OpenElement("classifier");
      attribute("type", classifier.type);
      attribute("accept", classifier.max_distance);
      for (const auto& view : classifier.views) numbers("view", view);
      out_.CloseElement();
    }
    out_.CloseElement();
  }

  void write(const ObjectInstance& object) {
    out_.OpenElement("object");
    attribute("id", object.id);
    attribute("kind", object.kind);
    attribute("told", object.described);
    attribute("seen", object.detections);
    attribute("missed", object.missed_detections);
    attribute("overlooked", object.overlooked);
    attribute("last_seen", object.last_seen);
    attribute("existence", object.existence);
    for (const auto& [name, value] : object.properties) {
      out_.OpenElement("property");
      attribute("name", name);
      attribute("value", value);
      out_.CloseElement();
    }
    if (object.pose) {
      out_.OpenElement("pose");
      point(object.pose->position);
      attribute("yaw", object.pose->yaw);
      numbers("size", object.pose->size);
      numbers("covariance", object.pose->covariance);
      out_.CloseElement();
    }
    if (!object.outline.empty()) numbers("outline", object.outline);
    if (!object.descriptor.empty()) numbers("descriptor", object.descriptor);
    for (const ObjectStay& stay : object.history) {
      out_.OpenElement("stay");
      attribute("from", stay.from);
      attribute("until", stay.until);
      point(stay.position);
      out_.CloseElement();
    }
    out_.CloseElement();
  }

  void write(const ObjectRelation& relation) {
    out_.OpenElement("relation");
    attribute("object", relation.object);
    attribute("word", std::string(toString(relation.word)));
    if (relation.other != 0) attribute("other", relation.other);
    if (relation.place != 0) attribute("place", relation.place);
    attribute("movability", relation.movability);
    attribute("told", relation.described);
    if (relation.vector) {
      out_.OpenElement("vector");
      point(*relation.vector);
      out_.CloseElement();
    }
    out_.CloseElement();
  }

  tinyxml2::XMLPrinter out_;
};

Point3 readPoint(XmlElement& e) {
  return {e.number("x"), e.number("y"), e.number("z")};
}

std::vector<float> readFloats(XmlElement& e) {
  std::vector<float> out;
  for (const double value : e.numbers()) out.push_back(static_cast<float>(value));
  return out;
}

template <std::size_t N>
std::array<double, N> readArray(XmlElement& e) {
  const std::vector<double> values = e.numbers();
  if (values.size() != N) e.fail("here must be " + std::to_string(N) + " numbers");
  std::array<double, N> out;
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

void checkRoot(XmlElement& e, const std::string& name, const std::string& xml_namespace,
               int newest) {
  if (e.name() != name || !e.has("xmlns") || e.text("xmlns") != xml_namespace) {
    e.fail("the first element must be <" + name + " xmlns=\"" + xml_namespace + "\">");
  }
  const std::string version = e.text("version");
  if (version != std::to_string(kVersion) && version != std::to_string(newest)) {
    e.fail(hyselam::versionRefusal(version, {kVersion, newest}));
  }
}

GenericClassifier readClassifier(XmlElement& e) {
  GenericClassifier classifier;
  classifier.type = e.text("type");
  classifier.max_distance = e.number("accept");
  e.children([&](XmlElement& child) {
    if (child.name() != "view") return false;
    classifier.views.push_back(readFloats(child));
    return true;
  });
  if (classifier.views.empty()) e.fail("it has no <view>");
  return classifier;
}

GenericObject readGeneric(XmlElement& e) {
  GenericObject object;
  object.name = e.text("name");
  e.children([&](XmlElement& child) {
    if (child.name() == "also") {
      object.synonyms.push_back(child.text("name"));
      child.finish();
    } else if (child.name() == "size") {
      object.shape.size = readArray<3>(child);
    } else if (child.name() == "spread") {
      object.shape.spread = readArray<3>(child);
    } else if (child.name() == "texture") {
      object.texture = readFloats(child);
    } else if (child.name() == "feature") {
      object.features[child.text("name")] = child.number("value");
      child.finish();
    } else if (child.name() == "classifier") {
      object.classifier = readClassifier(child);
    } else {
      return false;
    }
    return true;
  });
  return object;
}

ObjectPose readPose(XmlElement& e) {
  ObjectPose pose;
  pose.position = readPoint(e);
  pose.yaw = e.number("yaw");
  e.children([&](XmlElement& child) {
    if (child.name() == "size") {
      pose.size = readArray<3>(child);
    } else if (child.name() == "covariance") {
      pose.covariance = readArray<9>(child);
    } else {
      return false;
    }
    return true;
  });
  return pose;
}

ObjectInstance readInstance(XmlElement& e) {
  ObjectInstance object;
  object.id = e.id("id");
  object.kind = e.text("kind");
  object.described = e.truth("told");
  object.detections = e.integer("seen");
  object.missed_detections = e.integer("missed");
  if (e.has("overlooked")) object.overlooked = e.integer("overlooked");
  object.last_seen = e.number("last_seen");
  object.existence = e.number("existence");
  hyselam::Once<ObjectPose> pose;
  e.children([&](XmlElement& child) {
    if (child.name() == "property") {
      object.properties[child.text("name")] = child.text("value");
      child.finish();
    } else if (child.name() == "pose") {
      pose.set(child, readPose(child));
    } else if (child.name() == "outline") {
      object.outline = child.numbers();
    } else if (child.name() == "descriptor") {
      object.descriptor = readFloats(child);
    } else if (child.name() == "stay") {
      object.history.push_back({child.number("from"), child.number("until"), readPoint(child)});
      child.finish();
    } else {
      return false;
    }
    return true;
  });
  object.pose = pose.takeIfThere();
  return object;
}

ObjectRelation readRelation(XmlElement& e) {
  ObjectRelation relation;
  relation.object = e.id("object");
  const auto word = relationWordFromString(e.text("word"));
  if (!word) e.fail("the relation '" + e.text("word") + "' is not known");
  relation.word = *word;
  if (e.has("other")) relation.other = e.id("other");
  if (e.has("place")) relation.place = e.id("place");
  relation.movability = e.number("movability");
  relation.described = e.truth("told");
  hyselam::Once<Point3> vector;
  e.children([&](XmlElement& child) {
    if (child.name() != "vector") return false;
    vector.set(child, readPoint(child));
    child.finish();
    return true;
  });
  relation.vector = vector.takeIfThere();
  return relation;
}

ObjectMap readMap(XmlElement& e) {
  checkRoot(e, "object_map", kMapNamespace, kMapVersion);
  ObjectMap map;
  map.frame_id = e.text("frame_id");
  map.stamp = e.number("stamp");
  map.next_place_id = e.id("next_place_id");
  map.next_object_id = e.id("next_object_id");
  e.children([&](XmlElement& child) {
    if (child.name() == "place") {
      ObjectPlace place;
      place.id = child.id("id");
      place.name = child.text("name");
      if (child.has("topological")) place.topological = child.id("topological");
      child.finish();
      map.places.push_back(std::move(place));
    } else if (child.name() == "object") {
      map.objects.push_back(readInstance(child));
    } else if (child.name() == "relation") {
      map.relations.push_back(readRelation(child));
    } else {
      return false;
    }
    return true;
  });
  return map;
}

template <typename T>
void save(const std::string& path, const T& value) {
  const std::string text = toXml(value, path);
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << text; });
}

}  // namespace

std::string toXml(const ObjectDictionary& dictionary, const std::string& source) {
  checkDictionary(dictionary, source);
  return Writer().write(dictionary);
}

std::string toXml(const ObjectMap& map, const std::string& source) {
  checkMap(map, source);
  return Writer().write(map);
}

ObjectDictionary dictionaryFromXml(const std::string& text, const std::string& source) {
  ObjectDictionary dictionary;
  hyselam::readXmlDocument(text, source, limits(), [&](XmlElement& root) {
    checkRoot(root, "object_dictionary", kDictionaryNamespace, kVersion);
    root.children([&](XmlElement& child) {
      if (child.name() != "object") return false;
      dictionary.objects.push_back(readGeneric(child));
      return true;
    });
  });
  checkDictionary(dictionary, source);
  return dictionary;
}

ObjectMap objectMapFromXml(const std::string& text, const std::string& source) {
  ObjectMap map;
  hyselam::readXmlDocument(text, source, limits(), [&](XmlElement& root) { map = readMap(root); });
  checkMap(map, source);
  return map;
}

void saveXml(const std::string& path, const ObjectDictionary& dictionary) {
  save(path, dictionary);
}
void saveXml(const std::string& path, const ObjectMap& map) {
  save(path, map);
}

ObjectDictionary loadDictionary(const std::string& path) {
  return dictionaryFromXml(hyselam::readTextFile(path, kMaxBytes), path);
}
ObjectMap loadObjectMap(const std::string& path) {
  return objectMapFromXml(hyselam::readTextFile(path, kMaxBytes), path);
}

}  // namespace hyselam_objects
