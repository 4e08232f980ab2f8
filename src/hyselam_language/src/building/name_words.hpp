#pragma once

#include <string>
#include <vector>

namespace hyselam_topo {

/// Words of letters and digits, folded, without the s of possessives.
std::vector<std::string> wordsOfName(const std::string& name);

}  // namespace hyselam_topo
