#include "hyselam_common/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>

#include "hyselam_common/errors.hpp"

namespace hyselam {
namespace {

std::string errnoText() {
  return std::strerror(errno);
}

/// "dir/name.ext" -> "dir/.name.PID-COUNT.tmp.ext": unique among the processes of this machine, and
/// libraries that look at the extension still see it.
std::string temporaryBeside(const std::string& path) {
  static std::atomic<unsigned> count{0};
  const std::size_t slash = path.rfind('/');
  const std::string directory = slash == std::string::npos ? "" : path.substr(0, slash + 1);
  const std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  const std::size_t dot = name.rfind('.');
  const std::string extension = dot == std::string::npos || dot == 0 ? "" : name.substr(dot);
  return directory + "." + name + "." + std::to_string(::getpid()) + "-" + std::to_string(count++) +
         ".tmp" + extension;
}

void flushToDisk(const std::string& file, const std::string& path) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) throw InputError(path, "", "cannot be written: " + errnoText());
  const int result = ::fsync(fd);
  const int error = errno;
  ::close(fd);
  // EINVAL: a file system that cannot flush single files; nothing more can be done there.
  if (result != 0 && error != EINVAL) {
    errno = error;
    throw InputError(path, "", "cannot be flushed to the disk: " + errnoText());
  }
}

}  // namespace

void replaceFileAtomically(const std::string& path,
                           const std::function<void(const std::string&)>& write) {
  struct stat old {};
  const bool exists = ::stat(path.c_str(), &old) == 0;
  if (path.empty()) throw InputError("''", "", "is no file name");
  if (exists && S_ISDIR(old.st_mode)) throw InputError(path, "", "is a directory, not a file");
  const std::string temporary = temporaryBeside(path);
  try {
    // Created here, so that a place that cannot be written is told before the work is done.
    const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0) throw InputError(path, "", "cannot be written: " + errnoText());
    if (exists) (void)::fchmod(fd, old.st_mode & 07777);
    ::close(fd);
    write(temporary);
    flushToDisk(temporary, path);
    if (::rename(temporary.c_str(), path.c_str()) != 0) {
      throw InputError(path, "", "cannot be replaced: " + errnoText());
    }
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
}

void writeFileAtomically(const std::string& path, const std::function<void(std::ostream&)>& write) {
  const auto fill = [&](const std::string& file) {
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    if (!out) throw InputError(path, "", "cannot be written: " + errnoText());
    write(out);
    out.close();
    if (!out) throw InputError(path, "", "writing failed (disk full?)");
  };
  struct stat old {};
  if (::stat(path.c_str(), &old) == 0 && (S_ISCHR(old.st_mode) || S_ISFIFO(old.st_mode))) {
    fill(path);  // /dev/stdout, /dev/null, a pipe: nothing to replace
    return;
  }
  replaceFileAtomically(path, fill);
}

std::string readTextFile(const std::string& path, std::size_t max_bytes) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0)
    throw InputError(path, "", "cannot be read: " + errnoText());
  if (S_ISDIR(info.st_mode)) throw InputError(path, "", "is a directory, not a file");
  errno = 0;
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (!file) throw InputError(path, "", "cannot be read: " + errnoText());
  gzbuffer(file.get(), 1 << 16);

  std::string text;
  constexpr unsigned kChunk = 1 << 16;  // most files are small
  for (;;) {
    const std::size_t size = text.size();
    text.resize(size + kChunk);
    const int got = gzread(file.get(), &text[size], kChunk);
    text.resize(size + static_cast<std::size_t>(std::max(got, 0)));
    int code = Z_OK;
    const char* message = gzerror(file.get(), &code);
    if (got < 0 || code == Z_BUF_ERROR) {
      const std::string place = "after " + std::to_string(text.size()) + " unpacked bytes";
      if (code == Z_BUF_ERROR) throw InputError(path, place, "gzip data end too early (truncated)");
      if (code == Z_ERRNO) throw InputError(path, place, "cannot be read: " + errnoText());
      throw InputError(path, place, std::string("gzip data are damaged (") + message + ")");
    }
    if (text.size() > max_bytes) {
      throw InputError(path, "", "is larger than " + std::to_string(max_bytes) + " bytes");
    }
    if (got == 0) break;
  }
  return text;
}

}  // namespace hyselam
