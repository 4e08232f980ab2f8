// The version of the whole stack, which all its packages share (package.xml).
#pragma once

namespace hyselam {

/// E.g. "1.0.0" (semver.org); what is promised of it: docs/versions.md.
const char* version();

}  // namespace hyselam
