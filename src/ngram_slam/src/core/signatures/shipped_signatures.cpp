#include "shipped_signatures.hpp"

#include "ngram_slam/signatures/place_signature.hpp"

namespace ngram_slam {

const SignatureModel& SignatureModel::shipped() {
  static const SignatureModel model =
      parse(kShippedSignatures[0].text, "models/place_signatures.txt");
  return model;
}

}  // namespace ngram_slam
