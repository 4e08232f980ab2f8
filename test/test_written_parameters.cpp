// What is written about parameters is what the code does: docs/parameters.md, config/*.yaml of the
// packages and the parameters of dynamic_reconfigure are printed from the code (scripts/docs), and
// the READMEs of the packages name no parameter that does not exist and no wrong default.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iomanip>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

#include "fsd_localization/ros/parameters.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/parameter_documents.hpp"
#include "hyselam_common/ros/params.hpp"
#include "hyselam_objects/ros/object_engine_server.hpp"
#include "hyselam_topo/ros/gr2to_parameters.hpp"
#include "hyselam_topo/ros/topo_engine_parameters.hpp"
#include "ngram_slam/ros/parameters.hpp"
#include "ngram_slam/ros/shared_map_parameters.hpp"
#include "ngram_slam/ros/slam_parameters.hpp"
#include "selovis/ros/parameters.hpp"

namespace {

const std::string kRoot = HYSELAM_ROOT;

using hyselam::ParameterRow;

using Values = std::map<std::string, XmlRpc::XmlRpcValue>;

/// Parameters that a nodelet has only with another value of a first one ("model: beam").
struct Variant {
  std::string name, value;
  std::vector<ParameterRow> rows;  ///< that it does not have by default
};

using Load = std::function<void(hyselam::ParamLoader&)>;

struct Nodelet {
  std::string package, name;
  std::string file;    ///< config/FILE.yaml of the package
  std::string launch;  ///< launch file that sets some by its arguments
  std::vector<ParameterRow> rows;
  std::vector<Variant> variants;
  std::set<std::string> known;  ///< names that it does not warn of
  Load load;

  bool has(const std::string& parameter) const {
    return std::any_of(rows.begin(), rows.end(),
                       [&](const ParameterRow& r) { return r.name == parameter; });
  }
};

Nodelet nodelet(const std::string& package, const std::string& name, const std::string& file,
                const std::string& launch, const Load& load,
                const std::vector<std::pair<std::string, std::string>>& variants = {}) {
  hyselam::ParamLoader loader(std::make_shared<hyselam::MapParamSource>(Values{}));
  load(loader);
  Nodelet n{package, name, file, launch, loader.rows(), {}, loader.known(), load};
  for (const auto& [parameter, value] : variants) {
    hyselam::ParamLoader other(
        std::make_shared<hyselam::MapParamSource>(Values{{parameter, value}}));
    load(other);
    Variant variant{parameter, value, {}};
    for (const ParameterRow& r : other.rows()) {
      if (!n.has(r.name)) variant.rows.push_back(r);
    }
    n.variants.push_back(variant);
  }
  return n;
}

std::vector<Nodelet> nodelets() {
  return {
      nodelet("fsd_localization", "Localization", "localization", "localization.launch",
              fsd_localization::loadLocalizationParams, {{"model", "beam"}, {"model", "cosine"}}),
      nodelet("fsd_localization", "Fsd", "fsd", "fsd.launch", fsd_localization::loadFsdParams),
      nodelet("ngram_slam", "NgramSlam", "slam", "slam.launch", ngram_slam::loadSlamParams),
      nodelet("ngram_slam", "SharedMap", "shared_map", "shared_map.launch",
              ngram_slam::loadSharedMapParams),
      nodelet("ngram_slam", "Words", "words", "words.launch", ngram_slam::loadWordsParams),
      nodelet("hyselam_topo", "Gr2To", "gr2to", "gr2to.launch", hyselam_topo::loadGr2ToParams),
      nodelet("hyselam_topo", "TopoEngine", "topo_engine", "topo_engine.launch",
              hyselam_topo::loadTopoEngineParams),
      nodelet("selovis", "SemanticLocalization", "selovis", "selovis.launch", selovis::loadParams),
      nodelet("hyselam_objects", "ObjectEngine", "object_engine", "object_engine.launch",
              hyselam_objects::loadObjectEngineParams),
  };
}

/// Parameters of a nodelet that may change while it runs, by dynamic_reconfigure.
struct Reconfigurable {
  std::string package, node, name;
  std::vector<std::string> parameters;
  std::vector<ParameterRow> unused;  ///< offered for others' tools, beside those of the nodelet
};

std::vector<Reconfigurable> reconfigurable() {
  fsd_localization::UnusedAmclParams of_amcl;
  hyselam::ParameterTable table;
  table.group("", of_amcl);
  return {{"hyselam_topo",
           "gr2to",
           "Gr2To",
           {"mode", "free_max", "working_resolution", "max_clutter_size", "min_place_area",
            "thesis_door_min", "thesis_door_max", "thesis_critical_radius", "thesis_wall_share",
            "max_free_height", "min_occupied_height", "marker_alpha"},
           {}},
          {"fsd_localization", "localization", "Localization", fsd_localization::dynamicParams(),
           table.rows()}};
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
         "Printed from the code by `scripts/docs`; a test compares. How they belong together is in "
         "the README\nof each package; `config/*.yaml` of a package holds them all with their "
         "defaults, to be copied. A value\nof the wrong type or outside of what is allowed ends "
         "the node with a message; an unknown name is\nreported with the nearest known one. "
         "`map_server` has two, `yaml_filename` and `frame_id`\n"
         "([hyselam_map_server](../src/hyselam_map_server)).\n\n"
         "Topics are no parameters: the launch files take them as arguments (`scan:=base_scan`, "
         "see "
         "`roslaunch --ros-args hyselam_bringup\nhyselam.launch`), nodelets by remapping. Files of "
         "parameters go in as `slam_params:=FILE.yaml` and the like.\n";
  for (const Nodelet& n : nodelets()) {
    const std::string folder = "../src/" + n.package;
    out << "\n## " << n.package << "/" << n.name << "\n\nMore in [" << n.package << "](" << folder
        << "/README.md); as a file: [config/" << n.file << ".yaml](" << folder << "/config/"
        << n.file << ".yaml).\n\n"
        << hyselam::parameterMarkdown(n.rows);
    for (const Variant& v : n.variants) {
      out << "\nWith `" << v.name << ": " << v.value << "` also:\n\n"
          << hyselam::parameterMarkdown(v.rows);
    }
  }
  return out.str();
}

/// The parameters that a launch file sets.
std::set<std::string> setByLaunch(const std::string& launch) {
  const std::string text = hyselam::readTextFile(kRoot + "/launch/" + launch);
  static const std::regex form(R"re(<(?:param name|rosparam param)="([^"]+)")re");
  std::set<std::string> names;
  for (std::sregex_iterator m(text.begin(), text.end(), form), end; m != end; ++m) {
    names.insert((*m)[1]);
  }
  return names;
}

std::string configFile(const Nodelet& n) {
  std::ostringstream out;
  out << "# Parameters of " << n.package << "/" << n.name
      << " with their defaults; written by scripts/docs.\n"
         "# Copy this file, keep what you change, and load it:\n"
         "#   roslaunch hyselam_bringup "
      << n.launch << " params:=/absolute/path/" << n.file
      << ".yaml\n"
         "# Lines that are commented out are set by arguments of the launch file, over which a "
         "line "
         "here wins,\n# or have no default.\n"
      << hyselam::parameterYaml(n.rows, setByLaunch(n.launch));
  for (const Variant& v : n.variants) {
    std::set<std::string> all;
    for (const ParameterRow& r : v.rows) all.insert(r.name);
    out << "\n# ---- With " << v.name << ": " << v.value << " ----\n"
        << hyselam::parameterYaml(v.rows, all);
  }
  return out.str();
}

std::string reconfigureFile(const Reconfigurable& r) {
  for (const Nodelet& n : nodelets()) {
    if (n.package != r.package || n.name != r.name) continue;
    std::vector<ParameterRow> rows = n.rows;
    rows.insert(rows.end(), r.unused.begin(), r.unused.end());
    return hyselam::reconfigureCfg(rows, r.parameters, r.package, r.node, r.name);
  }
  return "";
}

/// Compares a file with what the code prints, or writes it.
void expectPrinted(const std::string& file, const std::string& text) {
  const std::string path = kRoot + "/" + file;
  if (std::getenv("HYSELAM_WRITE_DOCS") != nullptr) std::ofstream(path) << text;
  EXPECT_EQ(hyselam::readTextFile(path), text) << "run scripts/docs and commit " << file;
}

/// A value as rosparam reads it.
XmlRpc::XmlRpcValue valueOf(const YAML::Node& node) {
  XmlRpc::XmlRpcValue value;
  if (node.IsSequence()) {
    value.setSize(static_cast<int>(node.size()));
    for (std::size_t i = 0; i < node.size(); ++i) value[static_cast<int>(i)] = valueOf(node[i]);
    return value;
  }
  const auto text = node.as<std::string>();
  if (node.Tag() == "!") return {text};  // in quotation marks
  if (text == "true" || text == "false") return {text == "true"};
  if (text.find_first_of(".e") == std::string::npos) return {node.as<int>()};
  return {node.as<double>()};
}

/// The cells of a row of a table in Markdown, without the spaces around them.
std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  if (line.empty() || line[0] != '|') return cells;
  std::string cell;
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line[i] == '|' && line[i - 1] != '\\') {
      const auto from = cell.find_first_not_of(' '), to = cell.find_last_not_of(' ');
      cells.push_back(from == std::string::npos ? "" : cell.substr(from, to - from + 1));
      cell.clear();
    } else {
      cell += line[i];
    }
  }
  return cells;
}

/// Words between backquotes.
std::vector<std::string> quotedIn(const std::string& text) {
  static const std::regex form("`([^`]+)`");
  std::vector<std::string> words;
  for (std::sregex_iterator m(text.begin(), text.end(), form), end; m != end; ++m) {
    words.push_back((*m)[1]);
  }
  return words;
}

/// Whether a table's cell with defaults shows this one, in full or as people round it.
bool showsDefault(const std::string& cell, const ParameterRow& row) {
  // Written as a fraction of pi, or unset.
  static const std::map<std::string, std::string> symbols = {{"glass_aperture", "5π/6"},
                                                             {"glass_corner_angle", "8/12"}};
  const auto shows = [&](const std::string& text) { return cell.find(text) != std::string::npos; };
  const auto symbol = symbols.find(row.name);
  if (symbol != symbols.end()) return shows(symbol->second);
  const std::string value = std::regex_replace(row.default_value, std::regex("'"), "");
  if (value.empty()) return shows("(empty)") || shows("\"\"");
  if (row.default_yaml.empty()) return true;
  return shows(value) || shows(rounded(value, 2)) || shows(rounded(value, 3));
}

/// The parameters of a package's nodelets; several nodelets may have one of a name.
struct PackageParameters {
  std::map<std::string, std::vector<ParameterRow>> rows;
  std::set<std::string> known;  ///< names that they do not warn of
};

/// What a table of parameters in a README says: names in the first column, defaults in the second.
void expectTrueRow(const std::string& readme, const std::vector<std::string>& cells,
                   bool has_defaults, const PackageParameters& parameters) {
  for (const std::string& name : quotedIn(cells[0])) {
    const auto rows = parameters.rows.find(name);
    if (rows == parameters.rows.end()) {
      EXPECT_TRUE(parameters.known.count(name) > 0)
          << readme << " names a parameter `" << name << "` that does not exist";
    } else if (has_defaults) {
      EXPECT_TRUE(std::any_of(rows->second.begin(), rows->second.end(),
                              [&](const ParameterRow& row) { return showsDefault(cells[1], row); }))
          << readme << ": default of `" << name << "` is " << rows->second.front().default_value;
    }
  }
}

void expectTrueTables(const std::string& package, const PackageParameters& parameters) {
  const std::string readme = "src/" + package + "/README.md";
  std::istringstream lines(hyselam::readTextFile(kRoot + "/" + readme));
  std::vector<std::string> header;
  for (std::string line; std::getline(lines, line);) {
    const auto cells = cellsOf(line);
    if (cells.size() < 2 || (header.empty() && cells[0] != "parameter")) {
      header.clear();
    } else if (header.empty()) {
      header = cells;
    } else {
      expectTrueRow(readme, cells, header[1] == "default", parameters);
    }
  }
}

}  // namespace

TEST(WrittenParameters, DocumentIsWhatTheCodePrints) {
  expectPrinted("docs/parameters.md", document());
}

TEST(WrittenParameters, ConfigFilesAreWhatTheCodePrints) {
  for (const Nodelet& n : nodelets()) {
    EXPECT_GT(n.rows.size(), 5U) << n.name;
    expectPrinted("src/" + n.package + "/config/" + n.file + ".yaml", configFile(n));
  }
}

TEST(WrittenParameters, ConfigFilesLoadAndChangeNothing) {
  for (const Nodelet& n : nodelets()) {
    Values values;
    const auto file = YAML::LoadFile(kRoot + "/src/" + n.package + "/config/" + n.file + ".yaml");
    for (const auto& entry : file) {
      values[entry.first.as<std::string>()] = valueOf(entry.second);
    }
    EXPECT_GT(values.size() + setByLaunch(n.launch).size(), 5U) << n.name;
    hyselam::ParamLoader loader(std::make_shared<hyselam::MapParamSource>(values));
    n.load(loader);
    EXPECT_EQ(loader.reportUnknown(), std::vector<std::string>{}) << n.name;
    for (const ParameterRow& r : loader.rows()) EXPECT_EQ(r.value, r.default_value) << r.name;
  }
}

TEST(WrittenParameters, DynamicReconfigureIsWhatTheCodePrints) {
  for (const Reconfigurable& r : reconfigurable()) {
    expectPrinted("src/" + r.package + "/cfg/" + r.name + ".cfg", reconfigureFile(r));
  }
}

TEST(WrittenParameters, ReadmesNameNoOthersAndNoWrongDefaults) {
  std::map<std::string, PackageParameters> packages;
  for (const Nodelet& n : nodelets()) {
    PackageParameters& package = packages[n.package];
    for (const ParameterRow& r : n.rows) package.rows[r.name].push_back(r);
    for (const Variant& v : n.variants) {
      for (const ParameterRow& r : v.rows) package.rows[r.name].push_back(r);
    }
    package.known.insert(n.known.begin(), n.known.end());
  }
  for (const auto& [package, parameters] : packages) expectTrueTables(package, parameters);
}

TEST(WrittenMessages, ReferenceIsWhatTheMessagesSay) {
  EXPECT_EQ(
      std::system(("/usr/bin/python3 " + kRoot + "/scripts/message_reference --check").c_str()), 0);
}
