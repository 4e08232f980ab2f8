// How messages come from other processes.
#pragma once

#include <ros/transport_hints.h>

namespace hyselam {

/// For topics whose messages are waited for (what sensors give, transforms): by default TCP holds a
/// small message back until the one before was acknowledged, which the receiver puts off by up to
/// 40 ms. All subscribers of a topic in a process must ask for it: they share a connection, made as
/// the first one wants it.
inline ros::TransportHints promptly() {
  return ros::TransportHints().tcpNoDelay();
}

}  // namespace hyselam
