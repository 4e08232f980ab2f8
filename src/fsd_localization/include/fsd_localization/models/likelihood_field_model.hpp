// The likelihood field (Thrun, Burgard, Fox 2005, 6.4), with which the hybrid localisation tracks.
#pragma once

#include <optional>
#include <vector>

#include "fsd_localization/models/beam_sample.hpp"
#include "fsd_localization/models/distance_field.hpp"
#include "fsd_localization/models/observation_model.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

struct LikelihoodFieldParams {
  int max_beams = 90;
  double max_range = 30.0;          ///< [m]
  double z_hit = 0.9;               ///< share of returns from mapped obstacles
  double z_rand = 0.1;              ///< share of returns from anywhere
  double sigma_hit = 0.1;           ///< [m]
  double max_distance = 1.0;        ///< beyond it the hit term is 0 [m]
  double independent_beams = 60.0;  ///< the beams of a scan count as this many independent ones
  double occupied_penalty = 0.05;   ///< factor for a pose on an obstacle or off the map
  double surface_offset = 0.5;  ///< from the centre of a wall's outermost cell out to its surface
                                ///< [cells]: 0.5 on drawn plans, 0 where cells mark laser returns

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// The likelihood of a return by its distance from the surface of the nearest obstacle, outside or
/// inside of it: a wall's inside is no better than the air before it, so thick walls do not draw
/// the robot towards them. One byte per cell; coarse maps are refined, so that a cell does not
/// limit the accuracy.
class LikelihoodFieldModel final : public ObservationModel {
 public:
  explicit LikelihoodFieldModel(const hyselam::OccupancyGrid& map,
                                const LikelihoodFieldParams& params = {},
                                const OccupancyThresholds& thresholds = {});
  const char* name() const override { return "likelihood"; }
  std::optional<double> weigh(const Observation& observation, Particles& particles) const override;
  /// Another LikelihoodFieldParams::independent_beams: smaller is softer.
  void setIndependentBeams(double beams) { params_.independent_beams = beams; }

  /// Share of the returns that end within `inlier_distance` [m] of an obstacle of the map, for a
  /// pose of the grid's frame, 0..1; empty if the scan has no return.
  std::optional<double> inlierRatio(const hyselam::LaserScan& scan,
                                    const hyselam::Pose2& base_in_grid,
                                    double inlier_distance) const;
  /// Whether each point lies within `inlier_distance` [m] of an obstacle of the map.
  std::vector<bool> areInliers(const std::vector<hyselam::Point2>& in_grid,
                               double inlier_distance) const;

 private:
  double largestCost(double inlier_distance) const;
  /// Ends of the beams in the base frame [fine cells], and the cells they fall on for one pose.
  struct Ends {
    std::vector<float> x, y;
    std::vector<std::int32_t> cell;
  };
  Ends endsOf(const BeamSample& beams) const;
  void lookUp(float px, float py, BinaryAngle heading, Ends& ends) const;
  /// From the surface of the nearest obstacle [m]; position in cells, (0, 0) the first cell's
  /// centre.
  double surfaceDistance(const DistanceField& distance, double x, double y) const;

  LikelihoodFieldParams params_;
  hyselam::GridGeometry geometry_;
  double fine_resolution_ = 0.0;  // [m]
  int fine_width_ = 0;            // the frame of one far cell included
  int fine_height_ = 0;
  std::vector<std::uint8_t> cost_;  // -log likelihood in steps of step_
  std::vector<bool> occupied_;
  double step_ = 0.0;
  double best_ = 0.0;  // log likelihood at distance 0
};

}  // namespace fsd_localization
