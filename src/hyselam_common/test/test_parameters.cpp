// Parameters described once: checks, tables and files made from the description.
#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/parameter_documents.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"

namespace hyselam {
namespace {

using testing::messageOf;

enum class Color { kRed, kBlue };

struct Inner {
  double radius = 0.5;
  int cells = 3;

  void describe(ParameterVisitor& visit) {
    visit("radius", radius, Range::above(0.0), "m", "of the neighbourhood");
    visit("cells", cells, Range::between(1, 9), "", "of a side");
  }
};

struct Outer {
  double rate = -1.0;
  double share = 0.25;
  std::size_t seed = 1;
  bool loud = false;
  std::string frame = "map";
  std::string mode = "fast";
  Color color = Color::kBlue;
  std::optional<double> height;
  std::vector<double> widths{1.5, 3.0};
  std::vector<int> levels{7};
  Inner inner;

  void describe(ParameterVisitor& visit) {
    visit("rate", rate, Range::aboveUpTo(0.0, 1000.0).orValue(-1.0), "Hz", "-1: no limit");
    visit("share", share, Range::inside(0.0, 1.0), "", "of | the rest");
    visit("seed", seed, Range::atLeast(1), "", "of the random numbers");
    visit("loud", loud, "more in the log");
    visit("frame", frame, "of the map");
    visit("mode", mode, {"fast", "right"}, "how");
    visit("color", color, {{"red", Color::kRed}, {"blue", Color::kBlue}}, "of the marker");
    visit("height", height, Range::between(-10.0, 10.0), "m", "of the floor");
    visit("widths", widths, Range::above(0.0), 1, "m", "of the kernels");
    visit("levels", levels, Range::between(1, 50), 1, "", "one per level");
    visit.group("inner/", inner, {{"cells", "side"}});
  }
  void validate() const { checkParameters(*this); }
};

std::string complaint(const Outer& params) {
  return messageOf<ParameterError>([&] { params.validate(); });
}

TEST(Range, SaysWhatItContains) {
  EXPECT_EQ(Range::inside(0, 1).text(), "in (0, 1)");
  EXPECT_EQ(Range::aboveUpTo(0, 1).text(), "in (0, 1]");
  EXPECT_EQ(Range::fromBelow(0, 1).text(), "in [0, 1)");
  EXPECT_EQ(Range::atLeast(2).orValue(-1).text(), "-1 or >= 2");
  EXPECT_EQ(Range::any().text(), "a number");
  const Range range = Range::aboveUpTo(0, 1).orValue(-1);
  EXPECT_TRUE(range.contains(-1) && range.contains(0.5) && range.contains(1));
  EXPECT_FALSE(range.contains(0) || range.contains(-0.5) || range.contains(1.1) ||
               range.contains(std::nan("")));
}

TEST(CheckParameters, DefaultsPass) {
  EXPECT_EQ(complaint({}), "");
}

TEST(CheckParameters, EachOneOutOfRangeIsNamedWithValueAndRange) {
  Outer p;
  p.rate = 0.0;
  EXPECT_EQ(complaint(p), "parameter 'rate' is 0, but must be -1 or in (0, 1000]");
  p = {};
  p.share = std::nan("");
  EXPECT_EQ(complaint(p), "parameter 'share' is nan, but must be in (0, 1)");
  p = {};
  p.seed = 0;
  EXPECT_EQ(complaint(p), "parameter 'seed' is 0, but must be a whole number >= 1");
  p = {};
  p.mode = "slow";
  EXPECT_EQ(complaint(p), "parameter 'mode' is 'slow', but must be one of fast, right");
  p = {};
  p.color = static_cast<Color>(7);
  EXPECT_EQ(complaint(p), "parameter 'color' is '(none of them)', but must be one of red, blue");
  p = {};
  p.height = 11.0;
  EXPECT_EQ(complaint(p), "parameter 'height' is 11, but must be in [-10, 10]");
  p = {};
  p.widths = {1.0, -2.0};
  EXPECT_EQ(complaint(p),
            "parameter 'widths' is [1, -2], but must be a list of at least 1 numbers, each > 0");
  p = {};
  p.levels.clear();
  EXPECT_EQ(complaint(p),
            "parameter 'levels' is [], but must be a list of at least 1 whole numbers, each in "
            "[1, 50]");
  p = {};
  p.inner.radius = 0.0;
  EXPECT_EQ(complaint(p), "parameter 'inner/radius' is 0, but must be > 0");
  p = {};
  p.inner.cells = 10;
  EXPECT_EQ(complaint(p), "parameter 'side' is 10, but must be a whole number in [1, 9]");
}

TEST(CheckParameters, WhatThrowsLiesOutsideAndWhatPassesInside) {
  Rng rng(7);
  for (int round = 0; round < 2000; ++round) {
    Outer p;
    p.share = rng.uniform(-0.5, 1.5);
    p.inner.cells = static_cast<int>(rng.below(14)) - 2;
    const bool inside = p.share > 0.0 && p.share < 1.0 && p.inner.cells >= 1 && p.inner.cells <= 9;
    EXPECT_EQ(complaint(p).empty(), inside) << p.share << " " << p.inner.cells;
  }
}

TEST(ParameterGroup, NotOfferedIsCheckedButNotShown) {
  struct Wrapper {
    Inner inner;
    void describe(ParameterVisitor& visit) {
      visit.group("x_", inner, {{"cells", ParameterVisitor::kNotOffered}});
    }
  };
  const auto rows = parameterRows<Wrapper>();
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].name, "x_radius");
  Wrapper bad;
  bad.inner.cells = 0;
  EXPECT_EQ(messageOf<ParameterError>([&] { checkParameters(bad); }),
            "parameter 'x_cells' is 0, but must be a whole number in [1, 9]");
}

TEST(ParameterDocuments, TableHasARowForEach) {
  const std::string table = parameterMarkdown(parameterRows<Outer>());
  for (const char* line :
       {"| `rate` | -1 | Hz | -1 or in (0, 1000] | -1: no limit |\n",
        "| `share` | 0.25 |  | in (0, 1) | of \\| the rest |\n",
        "| `frame` | map |  | a text | of the map |\n",
        "| `height` | unset | m | in [-10, 10] | of the floor |\n",
        "| `color` | blue |  | one of red, blue | of the marker |\n",
        "| `widths` | [1.5, 3] | m | a list of at least 1 numbers, each > 0 | of the kernels |\n",
        "| `side` | 3 |  | a whole number in [1, 9] | of a side |\n"}) {
    EXPECT_NE(table.find(line), std::string::npos) << line << table;
  }
}

TEST(ParameterDocuments, FileHoldsExactDefaultsUnderTheirMeaning) {
  Outer p;
  p.share = 1.0 / 3.0;
  p.inner.radius = 1e-5;
  const std::string file = parameterYaml(parameterRows(p), {"frame"});
  for (const char* lines :
       {"\n# [Hz] -1: no limit; -1 or in (0, 1000]\nrate: -1.0\n", "\nshare: 0.3333333333333333\n",
        "\nseed: 1\n", "\nloud: false\n", "\n# frame: \"map\"\n", "\ncolor: \"blue\"\n",
        "\n# height:\n", "\nwidths: [1.5, 3.0]\n", "\nlevels: [7]\n", "\ninner/radius: 1.0e-05\n",
        "\nside: 3\n"}) {
    EXPECT_NE(file.find(lines), std::string::npos) << lines << file;
  }
}

TEST(ParameterDocuments, DynamicReconfigureTakesSomeOfThem) {
  const auto rows = parameterRows<Outer>();
  const std::string cfg =
      reconfigureCfg(rows, {"color", "share", "side", "loud"}, "p", "n", "Name");
  for (const char* line :
       {"gen.const('red_color', str_t, 'red', 'red')", "'blue', edit_method=color)",
        "gen.add('share', double_t, 0, 'of | the rest',\n        0.25, min=0.0, max=1.0)",
        "gen.add('side', int_t, 0, 'of a side',\n        3, min=1, max=9)",
        "gen.add('loud', bool_t, 0, 'more in the log',\n        False)",
        "exit(gen.generate('p', 'n', 'Name'))"}) {
    EXPECT_NE(cfg.find(line), std::string::npos) << line << "\n" << cfg;
  }
  EXPECT_THROW(reconfigureCfg(rows, {"nothing"}, "p", "n", "Name"), InputError);
  EXPECT_THROW(reconfigureCfg(rows, {"widths"}, "p", "n", "Name"), InputError);
}

}  // namespace
}  // namespace hyselam
