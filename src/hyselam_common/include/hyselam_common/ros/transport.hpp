// How messages come from other processes.
#pragma once

#include <ros/transport_hints.h>

namespace hyselam {

/// For topics whose small messages are waited for (scans, transforms): by default TCP holds a small
/// message back until the one before was acknowledged, which the receiver puts off by up to 40 ms.
inline ros::TransportHints promptly() {
  return ros::TransportHints().tcpNoDelay();
}

}  // namespace hyselam
