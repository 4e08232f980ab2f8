#include "tours.hpp"

#include <cstdlib>
#include <sstream>

#include "hyselam_common/errors.hpp"

namespace selovis {

Tours::Tours(const std::vector<std::string>& lists) {
  for (const auto& list : lists) tours_.push_back(readLabeledFrames(list));
}

std::vector<std::size_t> Tours::sizes() const {
  std::vector<std::size_t> n;
  for (const auto& tour : tours_) n.push_back(tour.size());
  return n;
}

TrainingFrame Tours::load(std::size_t tour, std::size_t i) const {
  const LabeledFrame& f = frame(tour, i);
  return {readImage(f.image), readingsOf(f), f.place, f.pose, f.image};
}

std::vector<double> numbersOf(const std::string& text, const std::string& option) {
  std::vector<double> numbers;
  std::istringstream in(text);
  for (std::string cell; std::getline(in, cell, ',');) {
    char* end = nullptr;
    numbers.push_back(std::strtod(cell.c_str(), &end));
    if (cell.empty() || end != cell.c_str() + cell.size()) {
      throw hyselam::InputError(option, "", "'" + cell + "' is no number");
    }
  }
  return numbers;
}

}  // namespace selovis
