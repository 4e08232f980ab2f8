// Folders for results.
#pragma once

#include <string>

namespace hyselam {

/// Makes a folder, with those above it, unless it is there. Called before the work whose results go
/// into it.
/// @throws InputError if it is not there and cannot be made, or is a file.
void makeFolder(const std::string& path);

}  // namespace hyselam
