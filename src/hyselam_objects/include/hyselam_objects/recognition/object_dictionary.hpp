// The object dictionary (dos Santos, section 3.2.3): learned models of kinds of objects,
// GO = {shape, texture, features, classifier, name} (Eq. 3.9). Robots exchange it as a file.
//
// Plain values. Lengths [m].
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

namespace hyselam_objects {

/// O_S: the box around such objects as a whole (single views may show a part), and its variation.
struct GenericShape {
  std::array<double, 3> size{0.0, 0.0, 0.0};    ///< length >= width, height; 0: not known
  std::array<double, 3> spread{0.0, 0.0, 0.0};  ///< standard deviations
};

/// O_C: how a view is recognized: by the nearest of the learned views.
struct GenericClassifier {
  std::string type;                       ///< of the descriptors: kDescriptorType
  std::vector<std::vector<float>> views;  ///< descriptors, all of one length, finite
  double max_distance = 0.0;              ///< views farther away than this are something else
};

/// GO of Eq. 3.9.
struct GenericObject {
  std::string name;                        ///< O_W: what people call it: "cup"
  std::vector<std::string> synonyms;       ///< other words for it: "mug"
  GenericShape shape;                      ///< O_S
  std::vector<float> texture;              ///< O_T: mean color histogram; empty: not known
  std::map<std::string, double> features;  ///< O_F: further numbers, by name
  GenericClassifier classifier;            ///< O_C; no views: it can be described, not recognized
};

struct ObjectDictionary {
  std::vector<GenericObject> objects;  ///< sorted by name, each name once

  /// By name or synonym; nullptr if there is none.
  const GenericObject* find(const std::string& word) const;
  /// Inserts it, or replaces the one of the same name.
  void put(GenericObject object);
};

bool operator==(const GenericObject& a, const GenericObject& b);
bool operator==(const ObjectDictionary& a, const ObjectDictionary& b);

/// Union of the dictionaries of two robots: views of both, at most `max_views` of one object, those
/// of the other one only if the type of descriptor is the same. Shapes are those with more views.
ObjectDictionary merged(const ObjectDictionary& a, const ObjectDictionary& b,
                        std::size_t max_views = 64);

/// @throws hyselam::InputError with `source` and the object that is wrong unless names are words
/// and
///         unique, numbers finite, lengths >= 0 and the views of a classifier equally long.
void checkDictionary(const ObjectDictionary& dictionary, const std::string& source);

/// XML; the schema is share/hyselam_objects/xsd/object_dictionary.xsd. Equal dictionaries give
/// equal bytes, numbers read back exactly.
/// @throws hyselam::InputError as the topological map's functions of the same names.
std::string toXml(const ObjectDictionary& dictionary, const std::string& source = "dictionary");
ObjectDictionary dictionaryFromXml(const std::string& text,
                                   const std::string& source = "dictionary");
void saveXml(const std::string& path, const ObjectDictionary& dictionary);
ObjectDictionary loadDictionary(const std::string& path);

}  // namespace hyselam_objects
