// What readers say of files of a format's versions that they do not read; docs/versions.md lists
// all.
#pragma once

#include <string>
#include <string_view>

namespace hyselam {

/// The versions of a format that a reader reads: whole numbers from 1.
struct FormatVersions {
  int oldest = 1;
  int newest = 1;
};

/// Why a file that says it has version `found` is refused: "has version 5, this program reads 1 to
/// 4; it was written by a newer HySeLAM". The reader puts file and place before it.
std::string versionRefusal(std::string_view found, FormatVersions read);

/// The same where name and version are one text, e.g. a first line "hyselam_border_trees 1".
/// `newest`: that text as it is written now; `oldest`: version that is still read, 0: only the
/// newest. What has another name "is no 'hyselam_border_trees 1'".
std::string formatRefusal(std::string_view found, std::string_view newest, int oldest = 0);

}  // namespace hyselam
