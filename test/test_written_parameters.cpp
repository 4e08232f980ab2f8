// What is written about parameters is what the code does: docs/parameters.md is printed from the
// code (scripts/docs), and the tables of the packages' READMEs name every parameter with its
// default.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <regex>
#include <sstream>

#include "fsd_localization/ros/parameters.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/ros/params.hpp"
#include "hyselam_objects/ros/object_engine_server.hpp"
#include "hyselam_topo/ros/parameters.hpp"
#include "hyselam_topo/ros/topo_engine_parameters.hpp"
#include "ngram_slam/ros/parameters.hpp"
#include "ngram_slam/ros/slam_parameters.hpp"
#include "selovis/ros/parameters.hpp"

namespace {

const std::string kRoot = HYSELAM_ROOT;

struct Row {
  std::string name, fallback, allowed, meaning;
};

struct Nodelet {
  std::string package, name;
  std::vector<Row> rows;
};

/// The rows of the table that a server logs at its start.
std::vector<Row> rowsOf(const std::string& table) {
  // Name, value, what is allowed (may hold brackets), default, meaning.
  static const std::regex form(R"(  (\S+) = .*  \((.*); default (.*?)\)(?: (.*))?)");
  std::vector<Row> rows;
  std::istringstream lines(table);
  std::string line;
  std::getline(lines, line);  // where
  while (std::getline(lines, line)) {
    std::smatch m;
    if (!std::regex_match(line, m, form)) {
      ADD_FAILURE() << "a row of another form: " << line;
      continue;
    }
    rows.push_back({m[1], std::regex_replace(m[3].str(), std::regex("'"), ""), m[2], m[4]});
  }
  return rows;
}

template <typename Load>
Nodelet nodelet(const std::string& package, const std::string& name, Load load) {
  hyselam::ParamLoader loader(
      std::make_shared<hyselam::MapParamSource>(std::map<std::string, XmlRpc::XmlRpcValue>{}));
  load(loader);
  return {package, name, rowsOf(loader.table())};
}

std::vector<Nodelet> nodelets() {
  return {
      nodelet("fsd_localization", "Localization", fsd_localization::loadLocalizationParams),
      nodelet("fsd_localization", "Fsd", fsd_localization::loadFsdParams),
      nodelet("ngram_slam", "NgramSlam", ngram_slam::loadSlamParams),
      nodelet("ngram_slam", "Words", ngram_slam::loadWordsParams),
      nodelet("hyselam_topo", "Gr2To", hyselam_topo::loadGr2ToParams),
      nodelet("hyselam_topo", "TopoEngine", hyselam_topo::loadTopoEngineParams),
      nodelet("selovis", "SemanticLocalization", selovis::loadParams),
      nodelet("hyselam_objects", "ObjectEngine", hyselam_objects::loadObjectEngineParams),
  };
}

std::string cell(const std::string& text) {
  return std::regex_replace(text, std::regex(R"(\|)"), "\\|");
}

/// A number with so many digits, as people write it; other text as it is.
std::string rounded(const std::string& value, int digits) {
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  if (value.empty() || *end != '\0') return value;
  std::ostringstream out;
  out << std::setprecision(digits) << number;
  return out.str();
}

std::string document() {
  std::ostringstream out;
  out << "# Parameters of the nodelets\n\n"
         "Printed from the code by `scripts/docs`; a test compares. What they mean in full, and "
         "how "
         "they belong\ntogether, is in the README of each package. A value of the wrong type or "
         "outside of what is allowed ends\nthe node with a sentence; a name that nobody knows is "
         "told with the nearest known one. `map_server`\nhas two, `yaml_filename` and `frame_id` "
         "([hyselam_map_server](../src/hyselam_map_server)).\n\n"
         "Topics are no parameters: the launch files take them as arguments (`scan:=base_scan`, "
         "see "
         "`roslaunch --ros-args hyselam_bringup\nhyselam.launch`), nodelets by remapping. Files of "
         "parameters go in as `slam_params:=FILE.yaml` and the like.\n";
  for (const Nodelet& n : nodelets()) {
    out << "\n## " << n.package << "/" << n.name << "\n\nMore in [" << n.package << "](../src/"
        << n.package << "/README.md).\n\n| parameter | default | allowed | |\n|---|---|---|---|\n";
    for (const Row& r : n.rows) {
      out << "| `" << r.name << "` | " << (r.fallback.empty() ? "(empty)" : cell(r.fallback))
          << " | " << cell(r.allowed) << " | " << cell(r.meaning) << " |\n";
    }
  }
  return out.str();
}

}  // namespace

TEST(WrittenParameters, DocumentIsWhatTheCodePrints) {
  const std::string file = kRoot + "/docs/parameters.md";
  const std::string text = document();
  if (std::getenv("HYSELAM_WRITE_DOCS") != nullptr) std::ofstream(file) << text;
  EXPECT_EQ(hyselam::readTextFile(file), text) << "run scripts/docs and commit docs/parameters.md";
}

TEST(WrittenParameters, ReadmesNameEachWithItsDefault) {
  // Written as a fraction, or in words.
  const std::map<std::string, std::string> symbols = {
      {"glass_aperture", "5π/6"}, {"glass_corner_angle", "8/12"}, {"z_min", ""}, {"z_max", ""}};
  for (const Nodelet& n : nodelets()) {
    const std::string readme = hyselam::readTextFile(kRoot + "/src/" + n.package + "/README.md");
    EXPECT_GT(n.rows.size(), 5U) << n.name;
    for (const Row& r : n.rows) {
      if (r.name.find('/') != std::string::npos) continue;  // groups: in docs/parameters.md
      const auto symbol = symbols.find(r.name);
      const std::string value = symbol != symbols.end() ? symbol->second
                                : r.fallback.empty()    ? "(empty)"
                                                        : r.fallback;
      // Named in a row of a table; a default is told where a first cell names the parameter, alone
      // or among others.
      bool named = false, has_row = false, right = false;
      std::istringstream lines(readme);
      for (std::string line; std::getline(lines, line);) {
        if (line.rfind("| `", 0) != 0 || line.find("`" + r.name + "`") == std::string::npos)
          continue;
        named = true;
        const std::string first = line.substr(0, line.find(" |", 2));
        if (first.find("`" + r.name + "`") == std::string::npos) continue;
        has_row = true;
        const auto told = [&](const std::string& text) {
          return line.find(text, first.size()) != std::string::npos;
        };
        right = right || told(value) || told(rounded(value, 2)) || told(rounded(value, 3)) ||
                (value == "(empty)" && told("\"\""));
      }
      EXPECT_TRUE(named) << n.package << "/README.md has no row for `" << r.name << "` of "
                         << n.name;
      if (has_row) {
        EXPECT_TRUE(right) << n.package << "/README.md: default of `" << r.name << "` is " << value;
      }
    }
  }
}

TEST(WrittenMessages, ReferenceIsWhatTheMessagesSay) {
  EXPECT_EQ(
      std::system(("/usr/bin/python3 " + kRoot + "/scripts/message_reference --check").c_str()), 0);
}
