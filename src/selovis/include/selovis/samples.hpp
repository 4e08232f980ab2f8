// Signatures with their places: what classifiers learn from.
#pragma once

#include <cstddef>
#include <vector>

namespace selovis {

struct Samples {
  std::size_t size = 0;       ///< length of one signature
  std::vector<float> values;  ///< one signature after the other
  std::vector<int> places;    ///< class of each, from 0 on
  std::vector<int> frames;    ///< frame that each was taken from, ascending; views of one share it

  std::size_t count() const { return places.size(); }
  const float* row(std::size_t i) const { return values.data() + i * size; }
  void add(const float* signature, int place, int frame) {
    values.insert(values.end(), signature, signature + size);
    places.push_back(place);
    frames.push_back(frame);
  }
};

/// Sum of a[i] * b[i], in a fixed order.
float dot(const float* a, const float* b, std::size_t n);

}  // namespace selovis
