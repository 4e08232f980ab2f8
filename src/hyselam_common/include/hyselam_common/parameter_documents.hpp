// What is written from the description of parameters: tables, files of defaults, dynamic
// reconfigure.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"

namespace hyselam {

/// A table in Markdown: parameter, default, unit, allowed, meaning.
std::string parameterMarkdown(const std::vector<ParameterRow>& rows);

/// A file for rosparam: each parameter with its exact default under a comment with its meaning,
/// unit and range. Those named in `commented_out`, and those without a default, stand in comments.
std::string parameterYaml(const std::vector<ParameterRow>& rows,
                          const std::set<std::string>& commented_out = {});

/// A file PACKAGE/cfg/NAME.cfg for dynamic_reconfigure with the parameters `names`, for the node
/// `node`.
/// @throws InputError for a name that is not among the rows, or a list.
std::string reconfigureCfg(const std::vector<ParameterRow>& rows,
                           const std::vector<std::string>& names, const std::string& package,
                           const std::string& node, const std::string& name);

}  // namespace hyselam
