#include "ngram_slam/ros/word_markers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "hyselam_common/ros/conversions.hpp"
#include "marker_parts.hpp"

namespace ngram_slam {

using visualization_msgs::Marker;

namespace {

/// From blue (narrow) over green to red (wide), for densities 0..1.
std_msgs::ColorRGBA colorOf(double density) {
  const double x = std::clamp(density, 0.0, 1.0);
  return color(std::clamp(2.0 * x - 0.6, 0.0, 1.0), 1.0 - std::abs(2.0 * x - 1.0),
               std::clamp(1.2 - 2.4 * x, 0.0, 1.0));
}

/// Beside the path at an observation, `aside` meters to its left.
geometry_msgs::Point beside(const ObservationStore& observations, std::uint32_t i, double aside) {
  return at(observations.pose(i) * hyselam::Pose2{0.0, aside, 0.0}, 0.3);
}

void addText(visualization_msgs::MarkerArray& array, Marker m, int id,
             const geometry_msgs::Point& place, const std::string& text) {
  m.id = id;
  m.pose.position = place;
  m.text = text;
  array.markers.push_back(m);
}

std::string textOf(const Syllables& s) {
  std::ostringstream text;
  text << s.density_class << '.' << s.size;
  const long degrees = std::lround(hyselam::degrees(s.angle));
  if (std::abs(degrees) >= 10) text << ' ' << std::showpos << degrees << "°";
  return text.str();
}

/// The path from observation `begin` on: regions as a broad line, density classes as a narrow one.
void addPathLines(const NgramRecognizer& recognizer, const ShownRun& shown, Position first,
                  std::uint32_t begin, const std_msgs::Header& header,
                  visualization_msgs::MarkerArray* array) {
  const ObservationStore& observations = recognizer.observations();
  const WordLattice& text = recognizer.text();
  Marker regions = marker(header, "regions", Marker::LINE_STRIP, 0.45);
  Marker classes = marker(header, "classes", Marker::LINE_STRIP, 0.12);
  Position p = first;
  auto region = shown.regions.begin();
  for (std::uint32_t i = begin; i < observations.size(); ++i) {
    const hyselam::Pose2 pose = observations.pose(i);
    while (region != shown.regions.end() && region->last < i) ++region;
    regions.points.push_back(at(pose, -0.02));
    const bool known = region != shown.regions.end() && region->first <= i;
    regions.colors.push_back(known ? colorOf(region->semantic_class) : color(0.7, 0.7, 0.7));
    if (p < text.positions() && i >= text.observationEnd(text.realWord(p))) ++p;
    std_msgs::ColorRGBA c = color(0.7, 0.7, 0.7);
    if (p < text.positions()) {
      const int id = text.syllables(text.realWord(p)).density_class;
      for (const DensityClass& density : recognizer.classes().list()) {
        if (density.id == id) c = colorOf(density.mode);
      }
    }
    classes.points.push_back(at(pose, 0.05));
    classes.colors.push_back(c);
  }
  if (regions.points.size() < 2) return;
  if (!shown.regions.empty()) array->markers.push_back(regions);
  array->markers.push_back(classes);
}

/// The names of the regions and the syllables of the words.
void addNames(const NgramRecognizer& recognizer, const ShownRun& shown, Position first,
              std::uint32_t begin, const std_msgs::Header& header,
              visualization_msgs::MarkerArray* array) {
  const ObservationStore& observations = recognizer.observations();
  const WordLattice& text = recognizer.text();
  Marker kinds = marker(header, "kinds", Marker::TEXT_VIEW_FACING, 0.0);
  kinds.scale.z = 0.4;
  kinds.color = color(0.25, 0.25, 0.25, 0.9);
  Marker label = marker(header, "words", Marker::TEXT_VIEW_FACING, 0.0);
  label.scale.z = 0.45;
  int id = 0;
  for (const SemanticRegion& r : shown.regions) {
    if (r.first < begin) continue;
    addText(*array, kinds, id++, beside(observations, (r.first + r.last) / 2, -0.9),
            toString(r.semantic_class));
  }
  for (Position w = first; w < text.positions(); ++w) {
    const WordIndex word = text.realWord(w);
    const std::uint32_t middle = (text.observationBegin(word) + text.observationEnd(word) - 1) / 2;
    addText(*array, label, static_cast<int>(w - first), beside(observations, middle, 0.8),
            textOf(text.syllables(word)));
  }
}

void addMatchLines(const ObservationStore& observations, const ShownRun& shown, std::uint32_t begin,
                   const std_msgs::Header& header, visualization_msgs::MarkerArray* array) {
  Marker lines = marker(header, "matches", Marker::LINE_LIST, 0.06);
  for (const MatchLine& m : shown.matches) {
    if (m.pair.older < begin || m.pair.newer >= observations.size()) continue;
    const auto c = m.direction == Direction::kReverse ? color(0.85, 0.1, 0.75, 0.8)
                                                      : color(0.05, 0.55, 0.1, 0.8);
    for (std::uint32_t i : {m.pair.newer, m.pair.older}) {
      lines.points.push_back(at(observations.pose(i), 0.2));
      lines.colors.push_back(c);
    }
  }
  if (!lines.points.empty()) array->markers.push_back(lines);
}

}  // namespace

visualization_msgs::MarkerArray wordMarkers(const NgramRecognizer& recognizer,
                                            const ShownRun& shown, int words,
                                            const std_msgs::Header& header) {
  const ObservationStore& observations = recognizer.observations();
  const WordLattice& text = recognizer.text();
  visualization_msgs::MarkerArray array;
  Marker clear;
  clear.header = header;
  clear.action = Marker::DELETEALL;
  array.markers.push_back(clear);
  if (observations.size() == 0) return array;

  const std::uint32_t run_begin = observations.runBegin(observations.runs() - 1);
  Position first = text.positions();
  for (int n = 0; n < words && first > 0; ++n) {
    if (text.observationBegin(text.realWord(first - 1)) < run_begin) break;
    --first;
  }
  const std::uint32_t begin =
      first < text.positions() ? text.observationBegin(text.realWord(first)) : run_begin;
  addPathLines(recognizer, shown, first, begin, header, &array);
  addNames(recognizer, shown, first, begin, header, &array);
  addMatchLines(observations, shown, begin, header, &array);
  return array;
}

}  // namespace ngram_slam
