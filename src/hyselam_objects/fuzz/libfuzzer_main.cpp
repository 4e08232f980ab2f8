// One program for each target: -DHYSELAM_FUZZ_TARGET=objectText.
#include "targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hyselam_objects::fuzz::HYSELAM_FUZZ_TARGET(data, size);
  return 0;
}
