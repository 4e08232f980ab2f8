// What a thing looks like, as a row of numbers: its size, its shape, its colours.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_objects/object_dictionary.hpp"

namespace hyselam_objects {

/// Size (3 numbers), distances between points (D2 of Osada et al. 2002, 16 bins of 3 cm), hues and
/// grey values (12 + 4). Parts are weighted so that descriptors are compared by viewDistance().
constexpr char kDescriptorType[] = "size+d2+hsv:1";
constexpr std::size_t kDescriptorSize = 3 + 16 + 16;

/// Points of one thing in a frame with z up [m], colours 0x00RRGGBB of each (or none). `seed` of
/// the pairs that are drawn; the same points give the same numbers. Empty for fewer than 10 points.
std::vector<float> describeView(const std::vector<Eigen::Vector3f>& points,
                                const std::vector<std::uint32_t>& colours, std::uint64_t seed = 1);

/// 0 alike .. about 1 and more; infinite for rows of different length.
double viewDistance(const std::vector<float>& a, const std::vector<float>& b);

/// What people would call the colour of most of the points: "red", "grey", ...; "" without colours.
std::string colourName(const std::vector<std::uint32_t>& colours);

struct Recognition {
  std::string name;
  double distance = 0.0;
  double margin = 0.0;  ///< how much farther the nearest view of another object is
};

/// The object with the nearest view; nothing if that is farther than it accepts: unknown.
std::optional<Recognition> recognise(const std::vector<float>& view,
                                     const ObjectDictionary& dictionary);

struct LearnParams {
  /// A view is accepted up to this factor times the largest distance of a view of the object from
  /// its nearest other one, > 0.
  double generosity = 1.6;
  double least_accept = 0.2;   ///< but not less than this
  std::size_t max_views = 32;  ///< kept; those farthest from each other
};

/// NewObject (dos Santos, section 3.2.4): a dictionary's entry from views of an object. Throws
/// hyselam::InputError without a usable view, hyselam::ParameterError for a parameter out of range.
GenericObject learnObject(const std::string& name, const std::vector<std::vector<float>>& views,
                          const std::vector<Eigen::Vector3d>& sizes,
                          const LearnParams& params = {});

}  // namespace hyselam_objects
