// Whole files in and out: a reader never sees half a file, a failed write leaves the old one.
#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace hyselam {

/// Replaces `path` by what `write` puts into the stream (binary): writes a temporary file beside
/// it, flushes it to the disk, renames it. On any failure, an exception of `write` included, the
/// temporary file is removed and an existing file stays as it was.
/// @throws InputError when the place cannot be written; passes on what `write` throws.
void writeFileAtomically(const std::string& path, const std::function<void(std::ostream&)>& write);

/// The same for libraries that open a file by its name: `write` receives the name of a
/// temporary file in the same directory (with the extension of `path`), which is then flushed and
/// renamed.
void replaceFileAtomically(const std::string& path,
                           const std::function<void(const std::string& temporary)>& write);

/// The content of a file; gzip data (known by its first two bytes, not by name) is unpacked.
/// @throws InputError for a missing file, a directory, damaged or truncated gzip data, or content
/// of more than `max_bytes` after unpacking.
std::string readTextFile(const std::string& path, std::size_t max_bytes = std::size_t{4} << 30);

}  // namespace hyselam
