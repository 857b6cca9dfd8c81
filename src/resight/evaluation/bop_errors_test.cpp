// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/bop_errors.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>

#include "resight/evaluation/bop_average_recall.hpp"
#include "resight/evaluation/bop_evaluation.hpp"
#include "resight/evaluation/pose_at_test.hpp"
#include "resight/geometry/symmetry.hpp"

namespace resight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
// f = 100 px; pixel (10, 10) is the optical axis. The field of view is so narrow that rays are hardly longer than
// depths.
const Camera kCamera{21, 21, 100, 100, 10, 10};
const std::vector<Rigid3> kNone{Rigid3::identity()};

// A square plate of 0.1 m in the plane z = 0 of the object.
TriangleMesh plate() {
  TriangleMesh mesh;
  mesh.vertices = {{-0.05F, -0.05F, 0}, {0.05F, -0.05F, 0}, {0.05F, 0.05F, 0}, {-0.05F, 0.05F, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Rigid3 turned(double deg) {
  return pose_at(0, 0, 1) * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), deg * std::numbers::pi / 180);
}

TEST(BopErrors, SurfaceDistanceIsTheFarthestVertexs) {
  const TriangleMesh mesh = plate();
  EXPECT_NEAR(mssd_m(pose_at(0.03, 0, 1.04), pose_at(0, 0, 1), mesh.vertices, kNone), 0.05, 1e-9);
  // Rotated by 90 deg, each corner moves to the next one: the side of the square. By 180 deg: the diagonal.
  EXPECT_NEAR(mssd_m(turned(90), turned(0), mesh.vertices, kNone), 0.1, 1e-8);
  EXPECT_NEAR(mssd_m(turned(180), turned(0), mesh.vertices, kNone), 0.1 * std::numbers::sqrt2, 1e-8);
}

TEST(BopErrors, ProjectionDistanceIsInPixels) {
  const TriangleMesh mesh = plate();
  EXPECT_NEAR(mspd_px(pose_at(0.03, 0, 1), pose_at(0, 0, 1), mesh.vertices, kNone, kCamera), 3.0, 1e-9);
  // Twice as far: each corner moves from 5 px to 2.5 px off the centre, along both axes.
  EXPECT_NEAR(mspd_px(pose_at(0, 0, 2), pose_at(0, 0, 1), mesh.vertices, kNone, kCamera), 2.5 * std::numbers::sqrt2,
              1e-6);
  EXPECT_TRUE(std::isinf(mspd_px(pose_at(0, 0, -1), pose_at(0, 0, 1), mesh.vertices, kNone, kCamera)));
}

TEST(BopErrors, SymmetriesAreFree) {
  const TriangleMesh mesh = plate();
  ObjectSymmetries quarter_turns;
  for (const double angle : {0.5, 1.0, 1.5})
    quarter_turns.discrete.push_back(Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), angle * std::numbers::pi));
  const std::vector<Rigid3> symmetries = enumerate_symmetries(quarter_turns);
  ASSERT_EQ(symmetries.size(), 4U);
  EXPECT_NEAR(mssd_m(turned(90), turned(0), mesh.vertices, symmetries), 0, 1e-7);
  EXPECT_NEAR(mspd_px(turned(270), turned(0), mesh.vertices, symmetries, kCamera), 0, 1e-5);
  // 100 deg is 10 deg from the nearest symmetry: a chord of the circle through the corners.
  const double chord = 2 * 0.05 * std::numbers::sqrt2 * std::sin(5 * std::numbers::pi / 180);
  EXPECT_NEAR(mssd_m(turned(100), turned(0), mesh.vertices, symmetries), chord, 1e-7);
}

Image<float> strip(int from, int to, float depth_m) {
  Image<float> image(21, 21, kNan);
  for (int u = from; u < to; ++u) image(u, 10) = depth_m;
  return image;
}

TEST(BopErrors, VisibleSurfaceDiscrepancyByHand) {
  VsdOptions options;
  options.misalignment_shares = {0.05, 0.10, 0.20};
  const Image<float> nothing(21, 21, kNan);
  const auto vsd = [&](const Image<float>& estimate, const Image<float>& truth, const Image<float>& measured) {
    return vsd_errors(estimate, truth, measured, kCamera, 0.1, options);
  };
  const Image<float> truth = strip(6, 14, 1.0F);
  EXPECT_EQ(vsd(truth, truth, truth), std::vector<double>(3, 0.0));
  EXPECT_EQ(vsd(nothing, nothing, truth), std::vector<double>(3, 1.0));
  // Shifted by two of eight pixels: union 10, intersection 6.
  EXPECT_EQ(vsd(strip(8, 16, 1.0F), truth, strip(0, 21, 1.0F)), std::vector<double>(3, 0.4));
  // 12 mm nearer everywhere: more than 5 % and 10 % of the diameter of 0.1 m, less than 20 %.
  EXPECT_EQ(vsd(strip(6, 14, 0.988F), truth, truth), (std::vector<double>{1, 1, 0}));
  // 30 mm behind the measured surface, the estimate is visible only where the truth is: six of eight pixels, all
  // misaligned.
  EXPECT_EQ(vsd(strip(8, 16, 1.03F), truth, strip(0, 21, 1.0F)), (std::vector<double>(3, 1.0)));
  // A nearer surface occludes half of the truth, and half of an estimate equal to it.
  Image<float> hidden = strip(6, 14, 1.0F);
  for (int u = 6; u < 10; ++u) hidden(u, 10) = 0.8F;
  EXPECT_EQ(vsd(truth, truth, hidden), std::vector<double>(3, 0.0));
  // Only the visible half is compared: an estimate without it has nothing in common.
  EXPECT_EQ(vsd(strip(6, 10, 1.0F), truth, hidden), std::vector<double>(3, 1.0));
  // Without measured depth, the object counts as visible.
  EXPECT_EQ(vsd(strip(10, 14, 1.0F), truth, nothing), std::vector<double>(3, 0.5));
}

TEST(BopErrors, DistancesAreAlongTheRay) {
  // 45 deg off the axis, a ray is sqrt(2) times as long as its depth: 8 mm of depth are 11.3 mm, more than 10 % of 0.1
  // m.
  const Camera wide{21, 21, 10, 10, 10, 10};
  Image<float> truth(21, 21, kNan);
  truth(20, 10) = 1.0F;
  Image<float> estimate(21, 21, kNan);
  estimate(20, 10) = 0.992F;
  VsdOptions options;
  options.misalignment_shares = {0.10, 0.12};
  EXPECT_EQ(vsd_errors(estimate, truth, truth, wide, 0.1, options), (std::vector<double>{1, 0}));
}

TEST(BopErrors, RenderedDepthIsThePlates) {
  const Image<float> depth_m = render_object_depth(plate(), kCamera, pose_at(0.001, 0.001, 1));
  EXPECT_NEAR(depth_m(10, 10), 1.0F, 1e-6);
  EXPECT_NEAR(depth_m(6, 6), 1.0F, 1e-6);
  EXPECT_TRUE(std::isnan(depth_m(4, 10)));  // The plate begins at -0.049 m, pixel 5.1.
}

class BopRecall : public testing::Test {
 protected:
  BopRecall() {
    objects_["plate"] = {plate(), kNone, 0.1 * std::numbers::sqrt2};
    frame_.camera = kCamera;
    frame_.depth_m = Image<float>(21, 21, kNan);
  }
  static GroundTruthObject truth(const Rigid3& pose, double visible_share = 1.0) {
    GroundTruthObject object;
    object.object = "plate";
    object.camera_from_object = pose;
    object.visible_share = visible_share;
    return object;
  }
  BopAverageRecall recall_of(const std::vector<GroundTruthObject>& truths, const std::vector<DetectedObject>& found) {
    BopRecallCounter counter(objects_);
    counter.add_view(frame_, truths, found);
    return counter.average_recall();
  }
  std::map<std::string, BopObject> objects_;
  RgbdFrame frame_;
};

TEST_F(BopRecall, PerfectAndEmpty) {
  const BopAverageRecall perfect = recall_of({truth(pose_at(0, 0, 1))}, {{"plate", pose_at(0, 0, 1), 1}});
  EXPECT_EQ(perfect.num_targets, 1);
  EXPECT_EQ(perfect.mean(), 1.0);
  const BopAverageRecall missed = recall_of({truth(pose_at(0, 0, 1))}, {});
  EXPECT_EQ(missed.num_targets, 1);
  EXPECT_EQ(missed.mean(), 0.0);
  EXPECT_TRUE(std::isnan(recall_of({}, {}).mean()));
}

TEST_F(BopRecall, CountsThresholdsPassed) {
  // 3 cm to the side: 21.2 % of the diameter passes 25 to 50 %, six of ten thresholds. 3 px pass none of the thresholds
  // of 0.16 to 1.64 px (r = 21 / 640).
  const BopAverageRecall aside = recall_of({truth(pose_at(0, 0, 1))}, {{"plate", pose_at(0.03, 0, 1), 1}});
  EXPECT_DOUBLE_EQ(aside.mssd, 0.6);
  EXPECT_DOUBLE_EQ(aside.mspd, 0.0);
  // 5.5 mm to the side: 3.9 % of the diameter; 0.55 px pass the thresholds of 0.66 to 1.64 px, seven of ten.
  const BopAverageRecall near = recall_of({truth(pose_at(0, 0, 1))}, {{"plate", pose_at(0.0055, 0, 1), 1}});
  EXPECT_DOUBLE_EQ(near.mssd, 1.0);
  EXPECT_DOUBLE_EQ(near.mspd, 0.7);
}

TEST_F(BopRecall, TheBestScoresCountAndHiddenTruthDoesNot) {
  // One target: only the estimate with the highest score counts, and it is wrong.
  EXPECT_EQ(
      recall_of({truth(pose_at(0, 0, 1))}, {{"plate", pose_at(0, 0, 1), 0.5}, {"plate", pose_at(0.5, 0, 1), 0.9}}).mssd,
      0.0);
  const BopAverageRecall hidden =
      recall_of({truth(pose_at(0, 0, 1)), truth(pose_at(0.2, 0, 1), 0.05)}, {{"plate", pose_at(0, 0, 1), 0.5}});
  EXPECT_EQ(hidden.num_targets, 1);
  EXPECT_EQ(hidden.mssd, 1.0);
  // Two instances, one found: half.
  EXPECT_EQ(recall_of({truth(pose_at(0, 0, 1)), truth(pose_at(0.2, 0, 1))}, {{"plate", pose_at(0, 0, 1), 0.5}}).mssd,
            0.5);
  // Two estimates of one instance are one hit.
  EXPECT_EQ(recall_of({truth(pose_at(0, 0, 1)), truth(pose_at(0.2, 0, 1))},
                      {{"plate", pose_at(0, 0, 1), 0.5}, {"plate", pose_at(0.001, 0, 1), 0.6}})
                .mssd,
            0.5);
}

class BopObjects : public testing::Test {
 protected:
  BopObjects() { std::filesystem::create_directories(folder_); }
  ~BopObjects() override { std::filesystem::remove_all(folder_); }
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("resight_bop_objects_" + std::to_string(::getpid()));
};

// The benchmark allows 1 % of the diameter between two motions of a symmetry.
TEST_F(BopObjects, TurnAboutAnAxisIsNoError) {
  std::ofstream(folder_ / "obj_000001.ply")
      << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "100 0 0\n-50 87 0\n-50 -87 0\n3 0 1 2\n";
  std::ofstream(folder_ / "models_info.json")
      << R"({"1": {"diameter": 174, "symmetries_continuous": [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}})";
  const auto objects = read_bop_objects(folder_, {});
  ASSERT_TRUE(objects.ok()) << objects.error().message;
  ASSERT_EQ(objects->size(), 1U);
  const BopObject& disc = objects->begin()->second;
  for (const double deg : {2.5, 100.0})
    EXPECT_LT(mssd_m(turned(deg), turned(0), disc.mesh.vertices, disc.symmetries), 0.01 * disc.diameter_m) << deg;
}

}  // namespace
}  // namespace resight
