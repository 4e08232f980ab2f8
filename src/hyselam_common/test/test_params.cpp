// The parameter loader, with a map in place of the parameter server.
#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/file_param_source.hpp"
#include "hyselam_common/ros/params.hpp"
#include "hyselam_common/testing/files.hpp"

namespace hyselam {
namespace {

using testing::messageOf;
using XmlRpc::XmlRpcValue;

ParamLoader loader(std::map<std::string, XmlRpcValue> values) {
  return ParamLoader(std::make_shared<MapParamSource>(std::move(values)));
}

XmlRpcValue list(std::initializer_list<double> numbers) {
  XmlRpcValue value;
  value.setSize(static_cast<int>(numbers.size()));
  int i = 0;
  for (const double n : numbers) value[i++] = n;
  return value;
}

enum class Model { kBeam, kField };

TEST(ParamLoader, GivenValuesReplaceDefaults) {
  auto p = loader({{"a", 0.5},
                   {"b", 3},
                   {"c", true},
                   {"d", "text"},
                   {"e", "field"},
                   {"w", 2},
                   {"l", list({1, 2.5})}});
  double a = 1, w = 1;
  int b = 1;
  bool c = false;
  std::string d = "x";
  Model e = Model::kBeam;
  std::vector<double> l;
  p.get("a", a, Range::between(0, 1));
  p.get("w", w);  // a whole number is a number
  p.get("b", b, Range::atLeast(1));
  p.get("c", c);
  p.get("d", d);
  p.getEnum<Model>("e", e, {{"beam", Model::kBeam}, {"field", Model::kField}});
  p.get("l", l, Range::above(0), 1);
  EXPECT_EQ(a, 0.5);
  EXPECT_EQ(w, 2.0);
  EXPECT_EQ(b, 3);
  EXPECT_TRUE(c);
  EXPECT_EQ(d, "text");
  EXPECT_EQ(e, Model::kField);
  EXPECT_EQ(l, (std::vector<double>{1, 2.5}));
  EXPECT_TRUE(p.reportUnknown().empty());
}

TEST(ParamLoader, MissingValuesKeepDefaults) {
  auto p = loader({});
  double a = 1.5;
  Model e = Model::kField;
  p.get("a", a, Range::above(0));
  p.getEnum<Model>("e", e, {{"beam", Model::kBeam}, {"field", Model::kField}});
  EXPECT_EQ(a, 1.5);
  EXPECT_EQ(e, Model::kField);
}

TEST(ParamLoader, OutOfRangeNamesParameterValueAndRange) {
  auto p = loader({{"a", 1.5}, {"n", std::nan("")}, {"b", -2}, {"l", list({1, -1})}});
  double a = 0.5;
  EXPECT_EQ(messageOf<ParameterError>([&] {
              p.get("a", a, {0, 1, true, false});
            }),
            "parameter 'map/a' is 1.5, but must be in (0, 1]");
  EXPECT_EQ(a, 0.5);
  EXPECT_NE(messageOf<ParameterError>([&] { p.get("n", a); }), "");
  int b = 3;
  EXPECT_EQ(messageOf<ParameterError>([&] { p.get("b", b, Range::atLeast(0)); }),
            "parameter 'map/b' is -2, but must be a whole number >= 0");
  std::vector<double> l{1};
  EXPECT_EQ(messageOf<ParameterError>([&] { p.get("l", l, Range::above(0)); }),
            "parameter 'map/l' is [1, -1], but must be a list of numbers, each > 0");
  EXPECT_THROW(p.get("l", l, Range::any(), 3), ParameterError);
}

TEST(ParamLoader, WrongTypeNamesParameterAndWhatIsMeant) {
  auto p = loader({{"a", "fast"}, {"b", 2.5}, {"c", 1}, {"d", 7}, {"l", 3.0}});
  double a = 0;
  int b = 0;
  bool c = false;
  std::string d;
  std::vector<double> l;
  EXPECT_EQ(messageOf<ParameterError>([&] { p.get("a", a); }),
            "parameter 'map/a' is 'fast', but must be a number");
  EXPECT_NE(messageOf<ParameterError>([&] { p.get("b", b); }).find("a whole number"),
            std::string::npos);
  EXPECT_NE(messageOf<ParameterError>([&] { p.get("c", c); }).find("true or false"),
            std::string::npos);
  EXPECT_NE(messageOf<ParameterError>([&] { p.get("d", d); }).find("a text"), std::string::npos);
  EXPECT_NE(messageOf<ParameterError>([&] { p.get("l", l, Range::any()); }).find("a list"),
            std::string::npos);
}

TEST(ParamLoader, WordOutsideOfTheChoicesIsRefused) {
  auto p = loader({{"e", "feild"}});
  Model e = Model::kBeam;
  EXPECT_EQ(messageOf<ParameterError>([&] {
              p.getEnum<Model>("e", e, {{"beam", Model::kBeam}, {"field", Model::kField}});
            }),
            "parameter 'map/e' is 'feild', but must be one of beam, field");
  EXPECT_EQ(e, Model::kBeam);
}

TEST(ParamLoader, MisspeltNamesAreReportedWithTheNearestKnown) {
  auto p =
      loader({{"laser_min_rnage", 1.0}, {"zzz", 1}, {"group/x", 1}, {"num_worker_threads", 2}});
  double value = 0.1;
  p.get("laser_min_range", value);
  p.get("laser_max_range", value);
  p.know("group");
  p.know("num_worker_threads");
  EXPECT_EQ(p.reportUnknown(),
            (std::vector<std::string>{"unknown parameter 'map/laser_min_rnage' (did you mean "
                                      "'laser_min_range'?)",
                                      "unknown parameter 'map/zzz'"}));
}

TEST(ParamLoader, TableShowsWhatWasResolved) {
  auto p = loader({{"sigma", 0.5}});
  double sigma = 0.2;
  p.get("sigma", sigma, Range::above(0), "[m] spread of a hit");
  EXPECT_EQ(p.table(), "map:\n  sigma = 0.5  (> 0; default 0.2) [m] spread of a hit\n");
  ASSERT_EQ(p.rows().size(), 1U);
  EXPECT_EQ(p.rows()[0].unit, "m");
  EXPECT_EQ(p.rows()[0].meaning, "spread of a hit");
}

struct Engine {
  double step = 5.0;
  std::size_t count = 20;
  std::optional<double> height;
  std::vector<int> levels{7, 10};

  void describe(ParameterVisitor& visit) {
    visit.renamed("leap", "step");
    visit("step", step, Range::above(0.0), "m", "longest step");
    visit("count", count, Range::between(1, 100), "", "particles");
    visit("height", height, Range::between(-10, 10), "m", "of the floor");
    visit("levels", levels, Range::between(1, 50), 1, "", "one per level");
  }
};

TEST(ParamLoader, LoadsWhatAStructDescribes) {
  XmlRpcValue levels = list({3, 4});
  auto p = loader({{"step", 2}, {"count", 7}, {"height", -1.5}, {"levels", levels}});
  Engine engine;
  engine.describe(p);
  EXPECT_EQ(engine.step, 2.0);
  EXPECT_EQ(engine.count, 7U);
  EXPECT_EQ(engine.height, -1.5);
  EXPECT_EQ(engine.levels, (std::vector<int>{3, 4}));
  EXPECT_EQ(p.rows().size(), 4U);
  EXPECT_TRUE(p.reportUnknown().empty());
}

TEST(ParamLoader, WrongTypesOfADescriptionAreRefused) {
  for (const auto& wrong : std::map<std::string, XmlRpcValue>{
           {"count", -1}, {"count", 2.0}, {"height", "low"}, {"levels", list({1.5})}}) {
    auto p = loader({wrong});
    Engine engine;
    EXPECT_NE(messageOf<ParameterError>([&] { engine.describe(p); }).find("map/" + wrong.first),
              std::string::npos);
  }
}

TEST(ParamLoader, FormerNameGivesTheValueAndIsReported) {
  auto p = loader({{"loop/leap", 3.0}});
  Engine engine;
  p.group("loop/", engine);
  EXPECT_EQ(engine.step, 3.0);
  EXPECT_TRUE(p.isSet("loop/step"));
  EXPECT_TRUE(p.reportUnknown().empty());
  EXPECT_EQ(p.reportRenamed(),
            (std::vector<std::string>{"parameter 'map/loop/leap' is now called 'loop/step'"}));
}

TEST(ParamLoader, FormerAndPresentNameTogetherAreRefused) {
  auto p = loader({{"leap", 3.0}, {"step", 4.0}});
  Engine engine;
  EXPECT_EQ(messageOf<ParameterError>([&] { engine.describe(p); }),
            "parameter 'map/leap' is 3, but must be left out: it is the former name of 'step', "
            "which is set too");
}

struct FileParams : ::testing::Test {
  FileParamSource source(const std::string& text) {
    testing::writeFile(d / "p.yaml", text);
    return FileParamSource(d / "p.yaml");
  }
  void expectRefused(const std::string& text, const std::string& part) {
    try {
      source(text);
      ADD_FAILURE() << "taken: " << text.substr(0, 60);
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
      EXPECT_LT(std::string(e.what()).size(), 400U);
    }
  }
  testing::TemporaryDirectory d;
};

TEST_F(FileParams, GroupsAndListsHaveNames) {
  const auto p = source("a: &x {b: 1, c: [1, 2.5]}\nd: *x\ne/f: '2'\n");
  EXPECT_EQ(p.names(), (std::vector<std::string>{"a/b", "a/c", "d/b", "d/c", "e/f"}));
  EXPECT_EQ(p.get("d/c")->size(), 2);
  EXPECT_EQ(p.get("e/f")->getType(), XmlRpcValue::TypeString);
}

TEST_F(FileParams, AliasesWithoutEndAreRefused) {
  expectRefused("a: &x {b: *x}\n", "nested too deep");
  expectRefused("a: &x [*x]\n", "a list of more than values");
  // Ten of ten of ten ...: a file of a few lines with a hundred million values.
  std::string text = "a0: &a0 {x0: 1, x1: 1, x2: 1, x3: 1, x4: 1, x5: 1, x6: 1, x7: 1, x8: 1}\n";
  for (int i = 1; i < 8; ++i) {
    const std::string before = "*a" + std::to_string(i - 1), name = "a" + std::to_string(i);
    text += name + ": &" + name + " {";
    for (int k = 0; k < 10; ++k) {
      text += (k > 0 ? ", y" : "y") + std::to_string(k) + ": " + before + " ";
    }
    text += "}\n";
  }
  expectRefused(text, "too many values");
  // The same with groups that hold nothing, and in one list.
  expectRefused(text.replace(text.find('{'), text.find('}') - text.find('{'), "{"),
                "too many values");
  std::string list = "a: [0";
  for (int i = 0; i < 10001; ++i) list += ", 0";
  expectRefused(list + "]\n", "too many values");
}

TEST_F(FileParams, ANameStandsOnce) {
  expectRefused("a/b: 1\na: {b: 2}\n", "stands twice");
  expectRefused("a/b: [1]\na: {b: [2]}\n", "stands twice");
  expectRefused("a/b: [1]\na: {b: 2}\n", "stands twice");
}

}  // namespace
}  // namespace hyselam
