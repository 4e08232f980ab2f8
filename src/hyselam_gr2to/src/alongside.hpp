// A step that runs alongside another where the machine can.
#pragma once

#include <future>
#include <utility>

namespace hyselam_topo {

/// The answer of a step that reads what nobody writes until it is asked for. Where no thread can be
/// begun, the step runs then. The future's end waits for it: declare what it reads before.
template <typename Step>
auto alongside(Step step) {
  return std::async(std::launch::async | std::launch::deferred, std::move(step));
}

}  // namespace hyselam_topo
