// segment_cloud IN.pcd --labels OUT.pcd: which points of a cloud belong to one object.
#include "hyselam_objects/segmentation/segment_cloud.hpp"

#include <ctime>
#include <iostream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/pcl/segment_unorganized.hpp"

int main(int argc, char** argv) {
  CLI::App app(
      "Segments a point cloud into support and objects, without models of them. Organized clouds "
      "(with the rows and columns of an image) are split where surfaces meet concavely; others "
      "where there is a gap.",
      "segment_cloud");
  std::string in, out;
  hyselam_objects::SegmentParams params;
  hyselam_objects::UnorganizedParams loose;
  app.option_defaults()->always_capture_default();
  app.add_option("CLOUD", in, "PCD file; z forward, x right, y down as cameras have it [m]")
      ->required();
  app.add_option("--labels", out,
                 "PCD file to write, with a label per point: 0 invalid, 1 support, 2 ... objects")
      ->required();
  app.add_option("--downsampling,--reduce", params.downsampling, "use every n-th row and column");
  app.add_option("--max-height,--tallest", params.max_object_height,
                 "highest object above the support [m]");
  app.add_option("--min-pixels,--smallest", params.min_object_pixels,
                 "least number of reduced pixels of an object");
  app.add_option("--gap", loose.cluster_gap, "between objects, for unorganized clouds [m]");

  return hyselam::runTool(argc, argv, app, [&] {
    const hyselam_objects::CloudFile file = hyselam_objects::readPcd(in);
    const bool organized = file.cloud.height > 1;
    loose.max_object_height = params.max_object_height;
    const std::clock_t begin = std::clock();
    const hyselam_objects::CloudSegmentation found =
        organized ? hyselam_objects::segmentCloud(file.cloud, params)
                  : hyselam_objects::segmentUnorganized(file.cloud, {0.0f, 0.0f, 0.0f}, loose);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    hyselam_objects::writePcd(out, file.cloud, found.labels);
    std::cout << found.objects << " objects"
              << (found.support ? "" : " (no supporting plane found)") << " in " << 1e3 * seconds
              << " ms -> " << out << "\n";
    return nlohmann::json{{"objects", found.objects},
                          {"seconds", seconds},
                          {"organised", organized},
                          {"support", found.support.has_value()},
                          {"points", file.cloud.size()}};
  });
}
