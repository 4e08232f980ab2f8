// What SLAM made of a log as one page that needs nothing beside it.
#pragma once

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "ngram_slam/slam/region_graph.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {
namespace report {

inline std::string base64(const std::vector<unsigned char>& bytes) {
  static const char* const kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned v = static_cast<unsigned>(bytes[i]) << 16;
    if (i + 1 < bytes.size()) v |= static_cast<unsigned>(bytes[i + 1]) << 8;
    if (i + 2 < bytes.size()) v |= bytes[i + 2];
    out += kDigits[v >> 18 & 63];
    out += kDigits[v >> 12 & 63];
    out += i + 1 < bytes.size() ? kDigits[v >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? kDigits[v & 63] : '=';
  }
  return out;
}

inline std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

inline std::string fixed(double value, int digits) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(digits) << value;
  return out.str();
}

inline const char* colourOf(SemanticClass c) {
  constexpr const char* kColours[kSemanticClasses] = {"#d62728", "#ff7f0e", "#1f77b4", "#9467bd",
                                                      "#2ca02c"};
  return kColours[indexOf(c)];
}

constexpr int kMapPixels = 1600;  // a larger map is drawn smaller

}  // namespace report

/// One way through a building: what a figure shows.
struct SlamPicture {
  std::string title;
  hyselam::OccupancyGrid grid;
  std::vector<hyselam::StampedPose2> trajectory;
  std::vector<std::pair<hyselam::Pose2, hyselam::Pose2>> word_loops, near_loops;
  RegionGraph regions;  ///< may be empty
};

inline SlamPicture pictureOf(const std::string& title, const SlamEngine& engine,
                             const hyselam::OccupancyGrid& grid) {
  SlamPicture p;
  p.title = title;
  p.grid = grid;
  p.trajectory = engine.trajectory();
  p.regions = regionGraph(engine);
  for (const SlamLoop& l : engine.loops())
    (l.source == LoopSource::kNgram ? p.word_loops : p.near_loops)
        .emplace_back(engine.keyframes()[static_cast<std::size_t>(l.older)].pose,
                      engine.keyframes()[static_cast<std::size_t>(l.newer)].pose);
  return p;
}

/// The map with the way, the regions and the loops over it, as SVG.
inline std::string mapFigure(const SlamPicture& p) {
  using namespace report;  // NOLINT: one function
  const hyselam::GridGeometry& g = p.grid.geometry;
  cv::Mat image(g.height, g.width, CV_8U);
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) {
      const std::int8_t v = p.grid.at({x, y});
      image.at<unsigned char>(g.height - 1 - y, x) =
          v == hyselam::OccupancyGrid::kUnknown ? 205 : (v > 50 ? 0 : 254);
    }
  const double scale = std::min(1.0, static_cast<double>(kMapPixels) / std::max(g.width, g.height));
  cv::Mat small = image;
  if (scale < 1.0) {
    // Walls of one cell must not vanish: the darkest of the cells that a pixel covers.
    const int reach = static_cast<int>(std::ceil(0.5 / scale));
    cv::erode(image, image,
              cv::getStructuringElement(cv::MORPH_RECT, {2 * reach - 1, 2 * reach - 1}));
    cv::resize(image, small, {}, scale, scale, cv::INTER_NEAREST);
  }
  std::vector<unsigned char> png;
  cv::imencode(".png", small, png);
  const auto point = [&](const hyselam::Pose2& pose) {
    const double x = (pose.x - g.origin.x) / g.resolution * scale;
    const double y = (g.height - (pose.y - g.origin.y) / g.resolution) * scale;
    return fixed(x, 1) + "," + fixed(y, 1);
  };
  const auto lines = [&](const std::vector<std::pair<hyselam::Pose2, hyselam::Pose2>>& pairs,
                         const char* style) {
    std::string path;
    for (const auto& [a, b] : pairs) path += "M" + point(a) + "L" + point(b);
    return "<path d=\"" + path + "\" fill=\"none\" " + style + "/>\n";
  };
  std::ostringstream out;
  out << "<figure><svg viewBox=\"0 0 " << small.cols << ' ' << small.rows
      << "\" xmlns=\"http://www.w3.org/2000/svg\">\n<image width=\"" << small.cols << "\" height=\""
      << small.rows << "\" href=\"data:image/png;base64," << base64(png) << "\"/>\n";
  std::string way;
  for (std::size_t i = 0; i < p.trajectory.size(); ++i) {
    if (i > 0 && i + 1 < p.trajectory.size() && i % 4 != 0) continue;
    way += (way.empty() ? "M" : "L") + point(p.trajectory[i].pose);
  }
  out << "<path d=\"" << way << "\" fill=\"none\" stroke=\"#1f77b4\" stroke-width=\"1.5\"/>\n"
      << lines(p.near_loops, "stroke=\"#2ca02c\" stroke-width=\"1\"")
      << lines(p.word_loops, "stroke=\"#ff7f0e\" stroke-width=\"4\" stroke-linecap=\"round\"");
  for (const RegionNode& n : p.regions.nodes) {
    const std::string at = point(n.pose);
    const std::size_t comma = at.find(',');
    out << "<circle cx=\"" << at.substr(0, comma) << "\" cy=\"" << at.substr(comma + 1)
        << "\" r=\"3\" fill=\"" << colourOf(n.semantic_class) << "\"><title>"
        << nameOf(n.semantic_class) << "</title></circle>\n";
  }
  out << "</svg><figcaption>" << escaped(p.title) << "</figcaption></figure>\n";
  return out.str();
}

/// The words of the first level in the order of the way: length by size, colour by density.
inline std::string wordStrip(const SlamEngine& engine) {
  using namespace report;  // NOLINT: one function
  const WordLattice& text = engine.recogniser().text();
  constexpr double kLine = 1200.0, kHeight = 22.0, kPerObservation = 1.0;
  double x = 0.0, y = 0.0;
  std::ostringstream boxes;
  for (WordIndex i = 0; i < text.words(); ++i) {
    const DensityWord w = text.word(i);
    if (w.level != 0) continue;
    const double width = kPerObservation * w.syllables.size;
    if (x > 0.0 && x + width > kLine) {
      x = 0.0;
      y += kHeight + 6.0;
    }
    const int hue = 250 - std::min(250, w.syllables.density_class * 35);
    boxes << "<rect x=\"" << fixed(x, 1) << "\" y=\"" << fixed(y, 1) << "\" width=\""
          << fixed(std::max(1.0, width - 1.0), 1) << "\" height=\"" << kHeight << "\" fill=\"hsl("
          << hue << ",60%,60%)\"><title>word " << i << ": class " << w.syllables.density_class
          << ", " << fixed(0.1 * w.syllables.size, 1) << " m, "
          << fixed(hyselam::degrees(static_cast<double>(w.syllables.angle)), 0)
          << " deg</title></rect>\n";
    x += width;
  }
  std::ostringstream out;
  out << "<svg viewBox=\"0 0 " << kLine << ' ' << fixed(y + kHeight, 0)
      << "\" xmlns=\"http://www.w3.org/2000/svg\">\n"
      << boxes.str() << "</svg>\n";
  return out.str();
}

/// Which metre of the way is the same place as which earlier one.
inline std::string matchFigure(const SlamEngine& engine) {
  using namespace report;  // NOLINT: one function
  const auto& keyframes = engine.keyframes();
  const double end = keyframes.empty() ? 1.0 : std::max(1.0, keyframes.back().way);
  constexpr double kSide = 600.0;
  std::ostringstream out;
  out << "<svg class=\"square\" viewBox=\"-4 -4 608 640\" xmlns=\"http://www.w3.org/2000/svg\">\n"
      << "<rect width=\"600\" height=\"600\" fill=\"#fff\" stroke=\"#888\"/>\n";
  const auto dot = [&](int newer, int older, const char* colour, double r) {
    out << "<circle cx=\"" << fixed(keyframes[static_cast<std::size_t>(newer)].way / end * kSide, 1)
        << "\" cy=\""
        << fixed(kSide - keyframes[static_cast<std::size_t>(older)].way / end * kSide, 1)
        << "\" r=\"" << r << "\" fill=\"" << colour << "\"/>\n";
  };
  for (const SlamLoop& l : engine.loops()) dot(l.newer, l.older, "#2ca02c", 1.5);
  for (const SlamMatch& m : engine.matches())
    dot(m.keyframe_newer, m.keyframe_older, m.accepted ? "#ff7f0e" : "#d62728", 3.0);
  out << "<text x=\"300\" y=\"622\" text-anchor=\"middle\" font-size=\"16\">way 0 .. "
      << fixed(end, 0) << " m; upwards: the earlier way</text></svg>\n";
  return out.str();
}

inline std::string tableOf(const nlohmann::json& values) {
  std::string out = "<table>\n";
  for (const auto& [name, value] : values.items()) {
    if (value.is_structured()) {
      out += "<tr><th colspan=\"2\">" + report::escaped(name) + "</th></tr>\n";
      for (const auto& [inner, v] : value.items())
        out += "<tr><td>&nbsp;&nbsp;" + report::escaped(inner) + "</td><td>" +
               report::escaped(v.is_string() ? v.get<std::string>() : v.dump()) + "</td></tr>\n";
      continue;
    }
    out += "<tr><td>" + report::escaped(name) + "</td><td>" +
           report::escaped(value.is_string() ? value.get<std::string>() : value.dump()) +
           "</td></tr>\n";
  }
  return out + "</table>\n";
}

/// @throws hyselam::InputError if the file cannot be written.
inline void writeReport(const std::string& path, const std::string& log, const SlamEngine& engine,
                        const std::vector<SlamPicture>& pictures, const nlohmann::json& summary) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>SLAM: "
        << report::escaped(log)
        << "</title>\n<style>body{font:15px/1.5 sans-serif;max-width:1300px;margin:2em auto;"
           "padding:0 1em;color:#222}h2{margin-top:2em}svg{width:100%;height:auto}"
           "svg.square{max-width:640px}figure{margin:1em 0}.side{display:grid;"
           "grid-template-columns:repeat(auto-fit,minmax(500px,1fr));gap:1em}"
           "table{border-collapse:collapse}td,th{padding:.15em .8em;border-bottom:1px solid #ddd;"
           "text-align:left;font-variant-numeric:tabular-nums}i{font-style:normal;"
           "display:inline-block;width:.8em;height:.8em;margin:0 .3em 0 1em}</style></head><body>\n"
        << "<h1>" << report::escaped(log) << "</h1>\n<h2>Map and way</h2>\n<p>"
        << "<i style=\"background:#1f77b4\"></i>way"
        << "<i style=\"background:#2ca02c\"></i>loops by nearness"
        << "<i style=\"background:#ff7f0e\"></i>loops by words; dots:";
    for (const SemanticClass c : kAllSemanticClasses)
      out << "<i style=\"background:" << report::colourOf(c) << "\"></i>" << nameOf(c);
    out << "</p>\n<div class=\"side\">\n";
    for (const SlamPicture& p : pictures) out << mapFigure(p);
    out << "</div>\n<h2>Figures</h2>\n"
        << tableOf(summary) << "<h2>Words</h2>\n<p>The first level, in the order of the way: one "
        << "box for each region, as long as the region (0.1 m a unit), blue: narrow, red: "
           "wide.</p>\n"
        << wordStrip(engine) << "<h2>The same places</h2>\n<p>"
        << "<i style=\"background:#2ca02c\"></i>loops of the graph"
        << "<i style=\"background:#ff7f0e\"></i>verified matches of words"
        << "<i style=\"background:#d62728\"></i>other matches of words</p>\n"
        << matchFigure(engine) << "</body></html>\n";
  });
}

}  // namespace ngram_slam
