// Two rooms are learned from images; then a drive through them is recognized, image by image.
#include <cstdio>
#include <opencv2/core/mat.hpp>

#include "selovis/recognition/image_recognizer.hpp"

/// A wall with stripes: wide green ones in the kitchen, narrow violet ones in the hall.
cv::Mat imageOf(bool kitchen, int step) {
  cv::Mat image(60, 80, CV_8UC3, kitchen ? cv::Scalar(40, 160, 60) : cv::Scalar(180, 90, 200));
  for (int x = step % 7; x < 80; x += kitchen ? 9 : 4) image.col(x).setTo(cv::Scalar::all(10));
  return image;
}

int main() {
  selovis::TrainingOptions options;
  options.descriptor = "LBPbyHSV-U8N";
  options.classifier.kernel = selovis::SvmKernel::kExemplar;
  options.views = {0.0};
  const auto load = [](std::size_t /*tour*/, std::size_t i) -> selovis::TrainingFrame {
    return {imageOf(i >= 10, static_cast<int>(i)), {}, i >= 10 ? "kitchen" : "hall"};
  };
  const selovis::PlaceModel model = selovis::trainPlaceModel({20}, load, options);

  selovis::ImageRecognizerParams params;
  params.filter.kind = selovis::PlaceFilterKind::kMarkov;
  selovis::ImageRecognizer recognizer(model, model.transitions, params);
  for (int step = 0; step < 8; ++step) {
    const auto r = recognizer.update(imageOf(step >= 4, step + 3));
    std::printf("%s %.2f\n", recognizer.places()[r.estimate.place].c_str(), r.estimate.probability);
  }
  return 0;
}
