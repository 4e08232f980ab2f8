// A server as a nodelet. For packages that depend on nodelet.
#pragma once

#include <nodelet/nodelet.h>

#include <exception>
#include <memory>

namespace hyselam {

/// Holds a `Server` made from the nodelet's public and private node handles, whose callbacks all
/// come through the single-threaded queue. A server that cannot be made is not loaded; its manager
/// lives on.
template <typename Server>
class ServerNodelet : public nodelet::Nodelet {
 protected:
  /// What else belongs to a server that stands.
  virtual void onServer(Server&) {}

 private:
  void onInit() final {
    try {
      server_ = std::make_unique<Server>(getNodeHandle(), getPrivateNodeHandle());
      onServer(*server_);
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load".
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<Server> server_;
};

}  // namespace hyselam
