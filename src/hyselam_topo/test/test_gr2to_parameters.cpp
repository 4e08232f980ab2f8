#include <gtest/gtest.h>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/temporary_directory.hpp"
#include "hyselam_gr2to/segmentation/border_model.hpp"
#include "hyselam_topo/ros/gr2to_parameters.hpp"

namespace hyselam_topo {
namespace {

using hyselam::testing::messageOf;

Gr2ToServerParams load(const std::map<std::string, XmlRpc::XmlRpcValue>& values) {
  hyselam::ParamLoader loader(std::make_shared<hyselam::MapParamSource>(values));
  const Gr2ToServerParams params = loadGr2ToParams(loader);
  EXPECT_TRUE(loader.reportUnknown().empty());
  return params;
}

TEST(Parameters, DefaultsAreThoseOfTheCore) {
  const Gr2ToServerParams params = load({});
  EXPECT_EQ(params.gr2to.mode, Gr2ToParams().mode);
  EXPECT_EQ(params.gr2to.segmentation.working_resolution, SegmentationParams().working_resolution);
  EXPECT_FALSE(params.octomap.z_min);
  EXPECT_EQ(-1, params.octomap.storey);
  EXPECT_EQ(params.gr2to.thesis.door_max, ThesisParams().door_max);
  EXPECT_EQ(nullptr, params.gr2to.segmentation.border_model);
  EXPECT_EQ(load({{"mode", "thesis"}}).gr2to.mode, Gr2ToParams::Mode::kThesis);
  EXPECT_EQ(load({{"z_min", 0.5}}).octomap.z_min, 0.5);
  EXPECT_EQ(load({{"storey", 1}}).octomap.storey, 1);
}

TEST(Parameters, OutOfRangeIsRefusedByName) {
  const std::map<std::string, XmlRpc::XmlRpcValue> bad = {{"mode", "magic"},
                                                          {"free_max", 100},
                                                          {"free_max", -1},
                                                          {"max_clutter_size", -0.1},
                                                          {"working_resolution", 0.0},
                                                          {"min_place_area", -1.0},
                                                          {"thesis_door_min", 0.0},
                                                          {"thesis_door_max", -1.0},
                                                          {"thesis_critical_radius", 0.0},
                                                          {"thesis_wall_share", 1.1},
                                                          {"storey", -2},
                                                          {"max_free_height", -1.0},
                                                          {"min_occupied_height", -1.0},
                                                          {"floor_margin", -1.0},
                                                          {"ceiling_margin", -1.0},
                                                          {"max_map_cells", 0},
                                                          {"marker_alpha", 1.5},
                                                          {"diagnostic_period", 0.0},
                                                          {"z_min", 1e9},
                                                          {"use_octomap", "perhaps"}};
  for (const auto& [name, value] : bad) {
    const std::string message = messageOf<hyselam::ParameterError>([&, n = name, v = value] {
      load({{n, v}});
    });
    EXPECT_NE(message.find(name), std::string::npos) << name << ": " << message;
  }
  EXPECT_THROW(load({{"z_min", 1.0}, {"z_max", 0.5}}), hyselam::ParameterError);
  EXPECT_THROW(load({{"mode", "thesis"}, {"thesis_door_max", 0.5}}), hyselam::ParameterError);
}

TEST(Parameters, ThesisModeHasItsOwn) {
  const ThesisParams thesis =
      load({{"mode", "thesis"}, {"thesis_door_min", 0.7}, {"thesis_door_max", 0.9}}).gr2to.thesis;
  EXPECT_EQ(0.7, thesis.door_min);
  EXPECT_EQ(0.9, thesis.door_max);
}

TEST(Parameters, FormerNamesStillWork) {
  const SegmentationParams params =
      load({{"clutter", 0.4}, {"smallest_place", 2.0}}).gr2to.segmentation;
  EXPECT_EQ(0.4, params.max_clutter_size);
  EXPECT_EQ(2.0, params.min_place_area);
}

TEST(Parameters, BorderModelOfAFile) {
  hyselam::testing::TemporaryDirectory folder;
  const std::string path = folder / "border_trees.txt";
  hyselam::testing::writeFile(path, BorderModel::shipped().toText());
  const auto model = load({{"border_model", path}}).gr2to.segmentation.border_model;
  ASSERT_NE(nullptr, model);
  EXPECT_EQ(BorderModel::shipped().toText(), model->toText());
  hyselam::testing::writeFile(path, "no trees");
  EXPECT_THROW(load({{"border_model", path}}), hyselam::InputError);
}

}  // namespace
}  // namespace hyselam_topo
