// Appearance of an object as a vector of numbers: its size, its shape, its colors.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_objects/recognition/object_dictionary.hpp"

namespace hyselam_objects {

/// Size (3 numbers), distances between points (D2 of Osada et al. 2002, 16 bins of 3 cm), hues and
/// gray values (12 + 4). The parts are weighted for the comparison by descriptorDistance().
constexpr char kDescriptorType[] = "size+d2+hsv:1";
constexpr std::size_t kDescriptorSize = 3 + 16 + 16;

/// Descriptor of the points of one object in a frame with z up [m], colors 0x00RRGGBB of each (or
/// none). `seed`: of the pairs of points that are drawn; the same points give the same numbers.
/// @return empty for fewer than 10 points.
std::vector<float> describeView(const std::vector<Eigen::Vector3f>& points,
                                const std::vector<std::uint32_t>& colors, std::uint64_t seed = 1);

/// L1 distance: 0 alike .. about 1 and more; infinite for descriptors of different length.
double descriptorDistance(const std::vector<float>& a, const std::vector<float>& b);

/// Name of the color of most of the points: "red", "grey", ...; "" without colors.
std::string colorName(const std::vector<std::uint32_t>& colors);

struct ObjectRecognition {
  std::string name;       ///< of the generic object
  double distance = 0.0;  ///< of the descriptor to its nearest view
  double margin = 0.0;    ///< how much farther the nearest view of another object is
};

/// The object with the nearest view; nothing if that is farther than its `max_distance`: unknown.
std::optional<ObjectRecognition> recognizeObject(const std::vector<float>& view,
                                                 const ObjectDictionary& dictionary);

struct LearnParams {
  /// A view is accepted up to this factor times the largest distance of a view of the object from
  /// its nearest other one, > 0.
  double acceptance_factor = 1.6;
  double min_acceptance = 0.2;  ///< lower limit of that distance, >= 0
  std::size_t max_views = 32;   ///< kept, those farthest from each other; > 0

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// NewObject (dos Santos, section 3.2.4): an entry of the dictionary from views of an object and
/// its sizes in them [m].
/// @throws hyselam::InputError without a usable view; hyselam::ParameterError.
GenericObject learnObject(const std::string& name, const std::vector<std::vector<float>>& views,
                          const std::vector<Eigen::Vector3d>& sizes,
                          const LearnParams& params = {});

}  // namespace hyselam_objects
