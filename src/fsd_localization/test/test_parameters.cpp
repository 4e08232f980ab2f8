// README.md holds every parameter with its default. (config/ is printed from the code, see
// hyselam_bringup's test_written_parameters.)
#include <gtest/gtest.h>

#include <regex>

#include "fsd_localization/ros/parameters.hpp"
#include "hyselam_common/atomic_file.hpp"

using namespace fsd_localization;  // NOLINT: a test, not a header
using hyselam::MapParamSource;
using hyselam::ParamLoader;

namespace {

std::string written(const std::string& file) {
  return hyselam::readTextFile(std::string(HYSELAM_PACKAGE_DIR) + "/" + file);
}

struct Entry {
  std::string name, value;
};

/// Names and defaults, out of the table that the servers log.
std::vector<Entry> entries(const std::string& table) {
  static const std::regex row(R"(\n  (\w+) = (\[[^\]]*\]|'[^']*'|\S+)  \()");
  std::vector<Entry> all;
  for (std::sregex_iterator i(table.begin(), table.end(), row), end; i != end; ++i) {
    all.push_back({(*i)[1], std::regex_replace((*i)[2].str(), std::regex("'"), "")});
  }
  return all;
}

ParamLoader loaderFor(const std::string& model) {
  return ParamLoader(std::make_shared<MapParamSource>(
      std::map<std::string, XmlRpc::XmlRpcValue>{{"model", model}}));
}

std::vector<Entry> localizationEntries(const std::string& model) {
  ParamLoader loader = loaderFor(model);
  loadLocalizationParams(loader);
  return entries(loader.table());
}

std::string escaped(const std::string& text) {
  return std::regex_replace(text, std::regex(R"([.\[\]+*()^$|?\\])"), R"(\$&)");
}

bool readmeHas(const Entry& e, const std::string& cells_before) {
  static const std::string readme = written("README.md");
  const std::string value = e.value.empty() ? "\\(empty\\)" : escaped(e.value);
  return std::regex_search(
      readme, std::regex("\\| `" + e.name + "` \\|" + cells_before + " " + value + "[ |]"));
}

}  // namespace

TEST(Written, readmeHasEveryParameterOfLocalization) {
  const auto all = localizationEntries("hybrid");
  EXPECT_GT(all.size(), 60U);
  for (const Entry& e : all) EXPECT_TRUE(readmeHas(e, "")) << e.name << " = " << e.value;
  // The beams of the other models stand in columns of their own.
  for (const Entry& e : localizationEntries("beam")) {
    if (e.name.rfind("laser_", 0) == 0) {
      EXPECT_TRUE(readmeHas(e, "[^|\n]*\\|")) << e.name << " = " << e.value;
    }
  }
  for (const Entry& e : localizationEntries("cosine")) {
    if (e.name.rfind("laser_", 0) == 0 || e.name.rfind("cosine_", 0) == 0) {
      EXPECT_TRUE(readmeHas(e, "[^|\n]*\\|[^|\n]*\\|")) << e.name << " = " << e.value;
    }
  }
}

TEST(Written, readmeHasEveryParameterOfFsd) {
  ParamLoader loader(
      std::make_shared<MapParamSource>(std::map<std::string, XmlRpc::XmlRpcValue>{}));
  loadFsdParams(loader);
  const auto all = entries(loader.table());
  EXPECT_GT(all.size(), 15U);
  for (const Entry& e : all) EXPECT_TRUE(readmeHas(e, "")) << e.name << " = " << e.value;
}

TEST(OfAmcl, everyDynamicParameterIsOneOfOursOrKnownAsUnused) {
  ParamLoader loader = loaderFor("hybrid");
  loadLocalizationParams(loader);
  for (const std::string& name : dynamicParams()) EXPECT_EQ(loader.known().count(name), 1U) << name;
}
