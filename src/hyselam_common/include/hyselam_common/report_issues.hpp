// The issues of a CARMEN log as people and programs want to see them.
#pragma once

#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hyselam_common/carmen_log.hpp"

namespace hyselam {

/// The first ones as warnings on stderr, all of them as JSON.
inline nlohmann::json reportIssues(const std::string& path,
                                   const std::vector<CarmenIssue>& issues) {
  constexpr std::size_t kShown = 20;
  nlohmann::json list = nlohmann::json::array();
  for (const CarmenIssue& issue : issues) {
    if (list.size() < kShown) std::cerr << "warning: " << path << ": " << toString(issue) << '\n';
    const char* kind = issue.kind == CarmenIssue::Kind::kSkipped   ? "skipped"
                       : issue.kind == CarmenIssue::Kind::kRetimed ? "retimed"
                                                                   : "log";
    list.push_back({{"line", issue.line}, {"kind", kind}, {"reason", issue.reason}});
  }
  if (issues.size() > kShown) {
    std::cerr << "warning: " << path << ": " << issues.size() - kShown
              << " more (all of them with --json)\n";
  }
  return list;
}

}  // namespace hyselam
