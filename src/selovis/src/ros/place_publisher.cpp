#include "selovis/ros/place_publisher.hpp"

#include <hyselam_msgs/VisualPlace.h>

#include "selovis/ros/place_markers.hpp"

namespace selovis {
namespace {

std::uint32_t idOf(const std::string& name, const hyselam_topo::AugmentedTopologicalMap* map) {
  if (map == nullptr || name.empty()) return 0;
  for (const auto& place : map->places) {
    if (hyselam_topo::nameOf(place) == name) return place.id;
  }
  return 0;
}

}  // namespace

PlacePublisher::PlacePublisher(ros::NodeHandle nh, double marker_height)
    : marker_height_(marker_height),
      places_(nh.advertise<hyselam_msgs::VisualPlace>("visual_place", 100)),
      markers_(nh.advertise<visualization_msgs::MarkerArray>("place_markers", 1, true)) {}

void PlacePublisher::publish(const Recognition& recognition, const ImageRecognizer& recognizer,
                             const std_msgs::Header& header,
                             const hyselam_topo::AugmentedTopologicalMap* map, bool kidnapped) {
  const auto nameAt = [&](int i) {
    return i < 0 ? std::string() : recognizer.places()[static_cast<std::size_t>(i)];
  };
  const PlaceEstimate& estimate = recognition.estimate;
  hyselam_msgs::VisualPlace msg;
  msg.header = header;
  msg.name = nameAt(estimate.place);
  msg.place = idOf(msg.name, map);
  msg.probability = estimate.probability;
  msg.transition = estimate.second >= 0;
  msg.second_name = nameAt(estimate.second);
  msg.second_place = idOf(msg.second_name, map);
  msg.frame_name = nameAt(recognition.frame_place);
  msg.descriptive = recognition.descriptive;
  msg.novelty = recognition.novelty;
  msg.names = recognizer.places();
  msg.probabilities = recognizer.probabilities();
  if (const auto* opinions = recognizer.opinions();
      opinions != nullptr && recognition.descriptive) {
    for (const PartOpinion& opinion : *opinions) {
      msg.parts.push_back(opinion.part);
      msg.part_names.push_back(nameAt(opinion.place));
      msg.part_weights.push_back(opinion.weight);
    }
    msg.unlearned_light = recognizer.lightIsUnlearned();
  }
  places_.publish(msg);
  last_place_ = msg.name;
  if (map != nullptr && markers_.getNumSubscribers() > 0) {
    markers_.publish(placeMarkers(*map, recognizer.places(), recognizer.probabilities(),
                                  estimate.place, kidnapped, marker_height_));
  }
}

}  // namespace selovis
