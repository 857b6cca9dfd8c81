// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypothesis_source.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "resight/recognition/box_scene_test_util.hpp"

namespace resight {
namespace {

using test::BoxScene;

PreparedView view_of(const BoxScene& scene, std::size_t number) {
  return prepare_view(render(scene.world, scene.cameras[number]).frame, scene.config.prepare);
}

TEST(ViewHypothesisSource, IdsAscendWithTheViewsThatAreUsed) {
  const BoxScene scene;
  ViewHypothesisSource source(scene.library, scene.config, nullptr);
  std::uint64_t next_id = 0;
  for (int number = 0; number < 2; ++number) {
    EXPECT_EQ(source.find_stored(number), nullptr);
    const auto made = source.generate(view_of(scene, static_cast<std::size_t>(number)), number, {}, {}, {});
    for (const Hypothesis& h : made->hypotheses) EXPECT_EQ(h.id, next_id++);
    source.reserve_ids(*made);
  }
  EXPECT_GT(next_id, 0U);
}

TEST(ViewHypothesisSource, StoresForOthersWhatItGenerates) {
  const BoxScene scene;
  const auto store = std::make_shared<ViewHypothesisStore>();
  ViewHypothesisSource first(scene.library, scene.config, store);
  StageTimes planning;
  { const ScopedTimer timer(planning, "planning"); }
  const auto made = first.generate(view_of(scene, 0), 0, {}, {}, planning);
  EXPECT_EQ(made->times.stages().back().stage, "planning");
  const ViewHypothesisSource second(scene.library, scene.config, store);
  EXPECT_EQ(second.find_stored(0), made);
  EXPECT_EQ(second.find_stored(1), nullptr);
}

TEST(ViewHypothesisSource, FacesOfBoxesInARowHaveKeypoints) {
  BoxScene scene;
  scene.world.solids.clear();
  for (const double x : {-0.102, 0.0, 0.102})
    scene.world.solids.push_back(analytic::placed(analytic::make_box(), analytic::on_table(x, 0, 0.07)));
  scene.cameras = {analytic::look_at({0, -0.6, 0.15}, {0, 0, 0.07})};
  ViewHypothesisSource source(scene.library, scene.config, nullptr);
  const auto made = source.generate(view_of(scene, 0), 0, {}, {}, {});
  const Rigid3f world_from_camera(scene.cameras[0]);
  const auto is_on_faces = [&](const Eigen::Vector3f& p) {
    const Eigen::Vector3f in_world = world_from_camera * p;
    return std::abs(in_world.y() + 0.035F) < 0.005F && in_world.z() > 0.01F;
  };
  EXPECT_GT(std::ranges::count_if(made->sift.points, is_on_faces), 10);
}

TEST(ViewHypothesisSource, AfterTheDeadlineNothingIsGenerated) {
  const BoxScene scene;
  double now_s = 0;
  const Deadline passed(-1, [&] { return now_s; });
  ViewHypothesisSource source(scene.library, scene.config, nullptr);
  const auto made = source.generate(view_of(scene, 0), 0, passed, {}, {});
  EXPECT_TRUE(made->hypotheses.empty());
  EXPECT_EQ(made->left_out, (std::vector<std::string>{"search"}));
}

}  // namespace
}  // namespace resight
