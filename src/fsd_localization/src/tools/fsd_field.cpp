// fsd_field: the free-space density of a whole map as a picture (thesis Fig. 3.2).
#include <chrono>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "fsd_localization/density/density_field.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"

namespace {

/// Free cells coloured by density (blue: narrow, red: open), walls black, unknown grey, north up.
cv::Mat draw(const fsd_localization::FreeSpaceGrid& space,
             const fsd_localization::DensityField& field) {
  cv::Mat grey(field.height, field.width, CV_8U), colour;
  for (int y = 0; y < field.height; ++y) {
    for (int x = 0; x < field.width; ++x) {
      grey.at<std::uint8_t>(field.height - 1 - y, x) =
          cv::saturate_cast<std::uint8_t>(255.0F * field.at(x, y));
    }
  }
  cv::applyColorMap(grey, colour, cv::COLORMAP_JET);
  for (int y = 0; y < field.height; ++y) {
    for (int x = 0; x < field.width; ++x) {
      if (!space.free.get(x, y)) {
        colour.at<cv::Vec3b>(field.height - 1 - y, x) =
            space.unknown.get(x, y) ? cv::Vec3b(190, 190, 190) : cv::Vec3b(0, 0, 0);
      }
    }
  }
  return colour;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Computes and draws the free-space density of every cell of a map.", "fsd_field");
  std::string map_file, kernel = "uniform", out;
  double bandwidth = 3.0;
  int threads = 0;
  app.option_defaults()->always_capture_default();
  app.add_option("MAP", map_file, "map (map_server YAML)")->required();
  app.add_option("--kernel", kernel, "uniform, gaussian or inverted");
  app.add_option("--bandwidth", bandwidth, "radius of the kernel [m]");
  app.add_option("--out", out, "picture to write (PNG)")->required();
  app.add_option("--threads", threads, "0: as many as there are cores")
      ->check(CLI::NonNegativeNumber);
  return hyselam::runTool(argc, argv, app, [&] {
    const hyselam::OccupancyGrid map = hyselam::loadMap(map_file);
    const fsd_localization::Kernel k({fsd_localization::kernelProfileFromString(kernel), bandwidth},
                                     map.geometry.resolution);
    hyselam::Progress progress("density", 100);
    const auto t0 = std::chrono::steady_clock::now();
    const fsd_localization::FreeSpaceGrid space = fsd_localization::freeSpaceOf(map);
    const fsd_localization::DensityField field = fsd_localization::densityField(
        space, k, threads,
        [&](double share) { progress.update(static_cast<std::size_t>(100 * share)); });
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
    const cv::Mat picture = draw(space, field);
    hyselam::replaceFileAtomically(out, [&](const std::string& temporary) {
      bool done = false;
      try {
        done = cv::imwrite(temporary, picture);
      } catch (const cv::Exception&) {
        throw hyselam::InputError(out, "", "no picture format has this extension");
      }
      if (!done) throw hyselam::InputError(out, "", "the picture cannot be written");
    });
    std::size_t free_cells = 0;
    for (int y = 0; y < field.height; ++y) {
      for (int x = 0; x < field.width; ++x) free_cells += space.free.get(x, y) ? 1 : 0;
    }
    return nlohmann::json{{"cells", map.geometry.cellCount()},
                          {"free_cells", free_cells},
                          {"radius_cells", k.radius()},
                          {"seconds", seconds},
                          {"bytes", field.values.size() * sizeof(float)}};
  });
}
