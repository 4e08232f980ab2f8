// The page of a tool, made by a script beside the program.
#pragma once

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <string>

namespace ngram_slam {

/// FOLDER/report.html by the script of this name. Without it (no jinja2) there is no page.
inline void makePage(const std::string& script_name, const std::string& folder) {
  const std::string script =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / script_name;
  std::string program = script, argument = folder;
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  int status = 0;
  if (::posix_spawn(&child, script.c_str(), nullptr, nullptr, arguments, environ) != 0 ||
      ::waitpid(child, &status, 0) != child || status != 0) {
    std::cerr << "warning: " << folder << "/report.html was not made (" << script << ")\n";
  }
}

}  // namespace ngram_slam
