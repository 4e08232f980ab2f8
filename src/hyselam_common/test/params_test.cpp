// The parameter loader, with a map in place of the parameter server.
#include "hyselam_common/ros/params.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
}

}  // namespace
}  // namespace hyselam
