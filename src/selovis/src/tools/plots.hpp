// Pictures of an evaluation: confusion matrix (Fig. 6.15) and places over time (Fig. 6.11).
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace selovis {

/// counts[truth * n + answer]; n places. The last column may be "unknown".
cv::Mat drawConfusion(const std::vector<std::string>& truths,
                      const std::vector<std::string>& answers,
                      const std::vector<std::vector<int>>& counts, const std::string& title);

/// Truth in blue, answers in red, one row per place, one column per frame.
cv::Mat drawTimeline(const std::vector<std::string>& places, const std::vector<int>& truth,
                     const std::vector<int>& answers, const std::string& title);

}  // namespace selovis
