// SPDX-License-Identifier: Apache-2.0
#include "resight/features/sift.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>

#include "resight/features/feature_test_scenes.hpp"

namespace resight {
namespace {

constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

void expect_same(const FeatureSet& a, const FeatureSet& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.descriptors, b.descriptors);
}

TEST(ExtractSift, GivesUnitDescriptorsAtMeasuredPoints) {
  const PreparedView view = prepare_view(test::make_wavy_frame(1));
  for (const bool root_sift : {false, true}) {
    const FeatureSet features = extract_sift(view, {.root_sift = root_sift});
    ASSERT_GT(features.size(), 200U);
    EXPECT_EQ(features.type, FeatureType::kSift);
    ASSERT_EQ(features.dimension, 128);
    ASSERT_EQ(features.normals.size(), features.size());
    ASSERT_EQ(features.descriptors.size(), features.size() * 128);
    for (std::size_t i = 0; i < features.size(); ++i) {
      double norm_sq = 0;
      for (const float x : features.descriptor(i)) norm_sq += static_cast<double>(x) * x;
      ASSERT_NEAR(norm_sq, 1, 1e-5);
      const Eigen::Vector2d pixel = view.frame.camera.project(features.points[i].cast<double>());
      const std::size_t at =
          view.cloud.z.index(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
      ASSERT_EQ(features.points[i].z(), view.cloud.z[at]);
      ASSERT_EQ(features.normals[i], view.cloud.normal(at));
    }
  }
}

TEST(ExtractSift, RootSiftIsTheSquareRootOfTheL1NormalisedDescriptor) {
  const PreparedView view = prepare_view(test::make_wavy_frame(1));
  const FeatureSet plain = extract_sift(view, {.root_sift = false});
  const FeatureSet root = extract_sift(view, {.root_sift = true});
  ASSERT_GT(plain.size(), 200U);
  ASSERT_EQ(plain.points, root.points);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    double sum = 0;
    for (const float x : plain.descriptor(i)) sum += x;
    for (std::size_t d = 0; d < 128; ++d)
      ASSERT_NEAR(root.descriptor(i)[d], std::sqrt(plain.descriptor(i)[d] / sum), 1e-5);
  }
}

TEST(ExtractSift, PutsABlobWhereItIs) {
  RgbdFrame frame = test::make_wavy_frame(1);
  std::ranges::fill(frame.depth_m.data(), 1.0F);
  double sum_u = 0;
  double sum_v = 0;
  constexpr int kBlobs = 12;
  for (int blob = 0; blob < kBlobs; ++blob) {
    const double u0 = 100 + 0.37 * blob;
    const double v0 = 90 + 0.59 * blob;
    for (int v = 0; v < frame.camera.height; ++v)
      for (int u = 0; u < frame.camera.width; ++u) {
        const auto level =
            static_cast<std::uint8_t>(40 + 180 * std::exp(-((u - u0) * (u - u0) + (v - v0) * (v - v0)) / 18));
        frame.color(u, v) = {level, level, level};
      }
    const FeatureSet features = extract_sift(prepare_view(frame));
    ASSERT_GE(features.size(), 1U);
    Eigen::Vector2d best(1e9, 1e9);
    for (const Eigen::Vector3f& p : features.points) {
      const Eigen::Vector2d error = frame.camera.project(p.cast<double>()) - Eigen::Vector2d(u0, v0);
      if (error.norm() < best.norm()) best = error;
    }
    ASSERT_LT(best.norm(), 0.2);
    sum_u += best.x();
    sum_v += best.y();
  }
  EXPECT_NEAR(sum_u / kBlobs, 0, 0.05);  // no shift: keypoints are relative to the pixel centres of the image
  EXPECT_NEAR(sum_v / kBlobs, 0, 0.05);
}

TEST(ExtractSift, LeavesOutPixelsWithoutDepthAndOutsideTheMask) {
  RgbdFrame frame = test::make_wavy_frame(2);
  const FeatureSet all = extract_sift(prepare_view(frame));
  Image<std::uint8_t> mask(frame.camera.width, frame.camera.height);
  for (int v = 0; v < frame.camera.height; ++v)
    for (int u = 0; u < frame.camera.width; ++u) {
      if (u < 100) frame.depth_m(u, v) = kNoDepth;
      mask(u, v) = v < 150 ? 1 : 0;
    }
  const PreparedView view = prepare_view(frame);
  const FeatureSet masked = extract_sift(view, {}, &mask);
  ASSERT_GT(masked.size(), 50U);
  // Exactly the keypoints of the whole image whose nearest pixel is usable.
  std::size_t expected = 0;
  for (const Eigen::Vector3f& p : all.points) {
    const Eigen::Vector2d pixel = frame.camera.project(p.cast<double>());
    const int u = static_cast<int>(std::lround(pixel.x()));
    const int v = static_cast<int>(std::lround(pixel.y()));
    expected += view.cloud.has_normal(view.cloud.z.index(u, v)) && mask(u, v) != 0 ? 1 : 0;
  }
  EXPECT_EQ(masked.size(), expected);
  EXPECT_LT(masked.size(), all.size());
  std::ranges::fill(mask.data(), 0);
  EXPECT_EQ(extract_sift(view, {}, &mask).size(), 0U);
}

TEST(ExtractSift, IsTheSameForAnyNumberOfThreadsOfOpenCv) {
  const PreparedView view = prepare_view(test::make_wavy_frame(3));
  const int num_threads_before = cv::getNumThreads();
  cv::setNumThreads(1);
  const FeatureSet serial = extract_sift(view);
  cv::setNumThreads(4);
  for (int run = 0; run < 3; ++run) expect_same(serial, extract_sift(view));
  cv::setNumThreads(num_threads_before);
  ASSERT_GT(serial.size(), 200U);
}

TEST(ExtractSift, FindsNothingInAUniformOrTinyImage) {
  RgbdFrame frame = test::make_wavy_frame(3);
  std::ranges::fill(frame.color.data(), Rgb8{90, 90, 90});
  const FeatureSet none = extract_sift(prepare_view(frame));
  EXPECT_EQ(none.size(), 0U);
  EXPECT_EQ(none.dimension, 128);
  RgbdFrame tiny;
  tiny.camera = {2, 2, 100, 100, 0.5, 0.5};
  tiny.color = Image<Rgb8>(2, 2);
  tiny.depth_m = Image<float>(2, 2, 1.0F);
  EXPECT_EQ(extract_sift(prepare_view(tiny)).size(), 0U);
}

TEST(ExtractSift, RefusesBadInput) {
  const PreparedView view = prepare_view(test::make_wavy_frame(3));
  EXPECT_THROW((void)extract_sift(view, {.contrast_threshold = -1}), std::invalid_argument);
  EXPECT_THROW((void)extract_sift(view, {.edge_threshold = 0}), std::invalid_argument);
  EXPECT_THROW((void)extract_sift(view, {.num_octave_layers = 0}), std::invalid_argument);
  const Image<std::uint8_t> small(3, 3, 1);
  EXPECT_THROW((void)extract_sift(view, {}, &small), std::invalid_argument);
}

}  // namespace
}  // namespace resight
