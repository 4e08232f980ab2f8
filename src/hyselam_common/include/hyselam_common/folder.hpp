// Folders for results.
#pragma once

#include <string>

namespace hyselam {

/// Makes a folder, with those above it, unless it is there. Called before the work whose results go
/// into it.
/// @throws InputError if it is not there and cannot be made, or is a file.
void makeFolder(const std::string& path);

/// Of a parameter that names a file which is kept across restarts; empty: none is. The folder is
/// not made: where a disk is not mounted yet, a new file would later take the place of the old one.
/// @throws ParameterError, if it is not there, that names it, and the argument of hyselam.launch
/// which people gave.
void checkFolderOfState(const std::string& parameter, const std::string& file);

}  // namespace hyselam
