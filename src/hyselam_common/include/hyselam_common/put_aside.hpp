// A stored file that cannot be used is neither lost nor in the way: it gets another name.
#pragma once

#include <optional>
#include <string>

namespace hyselam {

/// False only where nothing lies there for sure. What cannot even be looked at may be there: then
/// reading it gives the reason.
bool mayExist(const std::string& path);

/// Renames a file to FILE.damaged; to FILE.damaged.2, FILE.damaged.3, ... where an earlier one
/// lies, so that none takes another one's place. Throws nothing.
/// @returns the new name; nothing: it could not be renamed and is where it was.
std::optional<std::string> putAside(const std::string& path);

/// What a log says behind the reason: that the file is kept, or nothing.
std::string keptAs(const std::optional<std::string>& aside);

}  // namespace hyselam
