// The file in which the object map is kept across restarts.
#pragma once

#include <future>
#include <string>

#include "hyselam_objects/mapping/object_map.hpp"

namespace hyselam_objects {

/// An object map from a file, in that frame, with values that messages can hold.
/// @throws hyselam::InputError.
ObjectMap loadMapInFrame(const std::string& frame_id, const std::string& path);

/// Loaded at the start if it exists, written when the map has changed. An error is logged once, and
/// returned by error() as long as it lasts; nothing throws. To be used by one thread.
class MapFile {
 public:
  /// `log_name`: begins each line of the log; `path`: empty: no file, then nothing is done.
  MapFile(std::string log_name, std::string path);

  /// The map to start with; an empty one in that frame if there is no file, or a damaged one, which
  /// is renamed to FILE.damaged. A file that can neither be read nor renamed is never written.
  ObjectMap load(const std::string& frame_id);

  /// On the disk when it returns.
  void save(const ObjectMap& map);
  /// Returns at once: another thread writes a copy. Does nothing while a copy is being written.
  void saveInBackground(const ObjectMap& map);
  /// Waits until nothing is being written any more.
  void wait();

  /// Of the last access to the file; empty: none.
  const std::string& error();

 private:
  void setError(const std::string& error);

  std::string log_name_, path_;
  ObjectMap saved_;        ///< in the file, or being written to it
  bool outdated_ = false;  ///< the file may differ from `saved_`
  std::string error_;
  std::future<std::string> writing_;  ///< its error; its destructor waits
};

}  // namespace hyselam_objects
