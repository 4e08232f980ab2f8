// Transport of messages between processes.
#pragma once

#include <ros/transport_hints.h>

namespace hyselam {

/// For topics with low latency (sensors, transforms): by default TCP delays a small message until
/// the previous one is acknowledged, which takes up to 40 ms. All subscribers of a topic in a
/// process must use it: they share a connection, configured by the first one.
inline ros::TransportHints tcpNoDelay() {
  return ros::TransportHints().tcpNoDelay();
}

}  // namespace hyselam
