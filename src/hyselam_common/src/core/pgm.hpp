// Grey images in the PGM format (P2 and P5), the image format of map_server.
#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <string>

namespace hyselam {

bool isPgm(const std::string& bytes);

/// Decodes a PGM file to 8 bit; other depths are scaled. Throws std::runtime_error saying why not;
/// an image of more than `max_pixels` is refused before memory is taken for it.
cv::Mat decodePgm(const std::string& bytes, std::size_t max_pixels);

}  // namespace hyselam
