// The file in which the object map is kept across restarts.
#pragma once

#include <future>
#include <string>

#include "hyselam_objects/object_map.hpp"

namespace hyselam_objects {

/// An object map that messages can hold, in that frame.
/// @throws hyselam::InputError.
ObjectMap loadMapIn(const std::string& frame_id, const std::string& path);

/// Begun with if it is there, written when the map has changed. What goes wrong is told once in the
/// log, and by error() for as long as it does; nothing throws. To be used by one thread.
class MapFile {
 public:
  /// `who`: begins each line of the log; `path`: empty: no file, then nothing is done.
  MapFile(std::string who, std::string path);

  /// The map to begin with; an empty one in that frame if there is no file, or a damaged one, which
  /// is put aside as FILE.damaged. What can neither be read nor put aside is not written to.
  ObjectMap begin(const std::string& frame_id);

  /// On the disk when it returns.
  void save(const ObjectMap& map);
  /// Returns at once: another thread writes a copy. Not while the last one is still being written.
  void saveAside(const ObjectMap& map);
  /// Until nothing is being written any more.
  void wait();

  /// Of the file; empty: all is well.
  const std::string& error();

 private:
  void told(const std::string& error);

  std::string who_, path_;
  ObjectMap saved_;       ///< in the file, or about to be
  bool differs_ = false;  ///< the file is not known to hold it
  std::string error_;
  std::future<std::string> writing_;  ///< its error; its destructor waits
};

}  // namespace hyselam_objects
