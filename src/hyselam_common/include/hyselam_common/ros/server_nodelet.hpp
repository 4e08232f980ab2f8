// A server as a nodelet. For packages that depend on nodelet.
#pragma once

#include <nodelet/detail/callback_queue.h>
#include <nodelet/nodelet.h>

#include <exception>
#include <memory>

namespace hyselam {

/// What comes to this queue of a nodelet during onInit is kept. The loader of nodelet before 1.10.1
/// closes the queues meanwhile, and a closed queue loses what comes: then a latched map was never
/// seen, and its subscriber, with one place taken for ever, saw no other. Nothing changes for a
/// queue that is open, or that is none of a nodelet's loader.
inline void receiveDuringInit(ros::CallbackQueueInterface& queue) {
  if (auto* of_loader = dynamic_cast<nodelet::detail::CallbackQueue*>(&queue)) of_loader->enable();
}

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
    receiveDuringInit(getSTCallbackQueue());
    try {
      server_ = std::make_unique<Server>(getNodeHandle(), getPrivateNodeHandle());
      onServer(*server_);
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load".
      NODELET_FATAL_STREAM('[' << getName() << "] not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<Server> server_;
};

}  // namespace hyselam
