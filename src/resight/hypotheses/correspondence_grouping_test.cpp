// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/correspondence_grouping.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "resight/hypotheses/testing/synthetic_correspondences.hpp"

namespace resight {
namespace {

using testing::is_near;
using testing::make_problem;
using testing::Problem;
using testing::ProblemOptions;

int num_instances_found(const Problem& problem, const std::vector<CorrespondenceGroup>& groups) {
  int found = 0;
  for (const Rigid3& truth : problem.scene_from_object)
    found += std::any_of(groups.begin(), groups.end(),
                         [&](const CorrespondenceGroup& g) { return is_near(g.scene_from_object, truth); });
  return found;
}

double recall(ProblemOptions options, const GroupCorrespondencesOptions& grouping, int num_problems) {
  int found = 0;
  for (int i = 0; i < num_problems; ++i) {
    options.seed = 500 + static_cast<std::uint64_t>(i);
    const Problem problem = make_problem(options);
    found += num_instances_found(problem, group_correspondences(problem.correspondences, grouping));
  }
  return static_cast<double>(found) / (num_problems * options.num_instances);
}

TEST(GroupCorrespondences, ACleanInstanceIsOneGroupOfAll) {
  for (const int budget : {20000, 0}) {  // 0: greedy only.
    const Problem problem =
        make_problem({.num_correspondences = 20, .inliers_per_instance = 20, .noise_m = 0.001, .seed = 31});
    const auto groups = group_correspondences(problem.correspondences, {.max_cliques = budget});
    ASSERT_EQ(groups.size(), 1U);
    EXPECT_EQ(groups[0].members.size(), 20U);
    EXPECT_TRUE(is_near(groups[0].scene_from_object, problem.scene_from_object[0], 0.005, 0.03));
  }
}

TEST(GroupCorrespondences, TwoInstancesSideBySideAreTwoGroups) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Problem problem = make_problem({.num_correspondences = 100,
                                          .inliers_per_instance = 20,
                                          .num_instances = 2,
                                          .side_by_side = true,
                                          .seed = seed});
    const auto groups = group_correspondences(problem.correspondences);
    ASSERT_GE(groups.size(), 2U) << seed;
    // The two largest groups are the instances, without mixing them.
    std::set<int> seen;
    for (std::size_t g = 0; g < 2; ++g) {
      int votes[2] = {0, 0};
      for (const int i : groups[g].members) {
        const int instance = problem.instance[static_cast<std::size_t>(i)];
        if (instance >= 0) ++votes[instance];
      }
      EXPECT_EQ(std::min(votes[0], votes[1]), 0) << seed;
      EXPECT_GE(std::max(votes[0], votes[1]), 15) << seed;
      seen.insert(votes[1] > votes[0] ? 1 : 0);
    }
    EXPECT_EQ(seen.size(), 2U) << seed;
    EXPECT_EQ(num_instances_found(problem, groups), 2) << seed;
  }
}

TEST(GroupCorrespondences, GroupsOfOnePoseAreMergedUnlessThatIsOff) {
  std::size_t num_merged = 0, num_apart = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Problem problem =
        make_problem({.num_correspondences = 200, .inliers_per_instance = 40, .share_near = 0.7, .seed = seed});
    GroupCorrespondencesOptions options;
    num_merged += group_correspondences(problem.correspondences, options).size();
    options.merge_distance_m = std::nullopt;
    num_apart += group_correspondences(problem.correspondences, options).size();
  }
  EXPECT_GT(num_apart, num_merged);
}

TEST(GroupCorrespondences, RecallAmongOutliers) {
  EXPECT_GE(recall({.num_correspondences = 80, .inliers_per_instance = 8}, {}, 40), 0.94);
  EXPECT_GE(recall({.num_correspondences = 200, .inliers_per_instance = 20}, {}, 40), 0.97);
  EXPECT_GE(recall({.num_correspondences = 600, .inliers_per_instance = 30, .num_instances = 2}, {}, 15), 0.97);
  EXPECT_GE(recall({.num_correspondences = 200, .inliers_per_instance = 20}, {.max_cliques = 0}, 40), 0.97);
  EXPECT_GE(recall({.num_correspondences = 200, .inliers_per_instance = 20}, {.expand_groups = false}, 40), 0.97);
}

TEST(GroupCorrespondences, LawsOfTheGroups) {
  int num_groups = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Problem problem = make_problem(
        {.num_correspondences = 400, .inliers_per_instance = 20, .num_instances = 3, .share_near = 0.7, .seed = seed});
    const GroupCorrespondencesOptions options;
    const auto groups = group_correspondences(problem.correspondences, options);
    std::vector<int> uses(problem.correspondences.size(), 0);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const auto& members = groups[g].members;
      EXPECT_GE(static_cast<int>(members.size()), options.min_group_size);
      EXPECT_TRUE(std::is_sorted(members.begin(), members.end()));
      EXPECT_TRUE(groups[g].scene_from_object.is_rigid(1e-9));
      if (g > 0) {
        EXPECT_LE(members.size(), groups[g - 1].members.size());
      }
      const auto residuals = inlier_residuals_sq(problem.correspondences, groups[g].scene_from_object, options.pose);
      for (const int i : members) {
        EXPECT_TRUE(std::isfinite(residuals[static_cast<std::size_t>(i)]));
        ++uses[static_cast<std::size_t>(i)];
      }
      for (std::size_t other = 0; other < g; ++other) {
        EXPECT_FALSE(is_near(groups[g].scene_from_object, groups[other].scene_from_object, 0.002, 0.02));
      }
      ++num_groups;
    }
    EXPECT_LE(*std::max_element(uses.begin(), uses.end()), options.max_uses);
  }
  EXPECT_GT(num_groups, 30);
}

TEST(GroupCorrespondences, UsesAreLimited) {
  int most_free = 0;
  for (const int max_uses : {1, 2, 100}) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const Problem problem =
          make_problem({.num_correspondences = 500, .inliers_per_instance = 20, .share_near = 1.0, .seed = seed});
      std::vector<int> uses(problem.correspondences.size(), 0);
      for (const auto& group : group_correspondences(problem.correspondences, {.max_uses = max_uses}))
        for (const int i : group.members) ++uses[static_cast<std::size_t>(i)];
      const int most = *std::max_element(uses.begin(), uses.end());
      EXPECT_LE(most, max_uses);
      most_free = std::max(most_free, most);
    }
  }
  EXPECT_GT(most_free, 2);  // Without the limit there are more.
}

TEST(GroupCorrespondences, NoGroupUsesAKeypointTwice) {
  Problem problem = make_problem({.num_correspondences = 60, .inliers_per_instance = 40, .seed = 33});
  auto& c = problem.correspondences;
  const std::size_t n = c.size();
  for (std::size_t i = 0; i < n; ++i) {  // A second model keypoint, 1 mm away, for each scene keypoint.
    Correspondence twin = c[i];
    twin.model_point.x() += 0.001F;
    twin.model_feature += static_cast<int>(n);
    c.push_back(twin);
  }
  const auto groups = group_correspondences(c);
  ASSERT_FALSE(groups.empty());
  EXPECT_TRUE(is_near(groups[0].scene_from_object, problem.scene_from_object[0]));
  EXPECT_GE(groups[0].members.size(), 30U);
  for (const auto& group : groups) {
    std::set<int> scene_features;
    for (const int i : group.members) scene_features.insert(c[static_cast<std::size_t>(i)].scene_feature);
    EXPECT_EQ(scene_features.size(), group.members.size());
  }
}

TEST(GroupCorrespondences, EmptyAndNanInputGiveNoGroups) {
  EXPECT_TRUE(group_correspondences({}).empty());
  Problem problem = make_problem({.num_correspondences = 30, .inliers_per_instance = 20, .seed = 34});
  const auto before = group_correspondences(problem.correspondences);
  ASSERT_EQ(before.size(), 1U);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  auto with_nan = problem.correspondences;
  with_nan.insert(with_nan.begin(), with_nan[0]);
  with_nan.front().scene_point.x() = nan;
  const auto after = group_correspondences(with_nan);
  ASSERT_EQ(after.size(), 1U);
  auto shifted = before[0].members;  // Indices refer to the input.
  for (int& i : shifted) ++i;
  EXPECT_EQ(after[0].members, shifted);
  for (auto& c : problem.correspondences) c.model_point.setConstant(nan);
  EXPECT_TRUE(group_correspondences(problem.correspondences).empty());
}

TEST(GroupCorrespondences, SameBytesTwice) {
  const Problem problem = make_problem({.num_correspondences = 300, .inliers_per_instance = 30, .seed = 35});
  const auto a = group_correspondences(problem.correspondences);
  const auto b = group_correspondences(problem.correspondences);
  ASSERT_GE(a.size(), 1U);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].members, b[i].members);
    EXPECT_EQ(a[i].scene_from_object.matrix(), b[i].scene_from_object.matrix());
  }
}

TEST(SelectBestCorrespondences, TakesTheTypesInTurns) {
  std::vector<Correspondence> c(10);
  for (std::size_t i = 0; i < c.size(); ++i) {
    c[i].model_point.setZero();
    c[i].scene_point.setZero();
    c[i].type = i < 7 ? FeatureType::kSift : FeatureType::kShot;
    c[i].distance_sq = i < 7 ? 0.1F * static_cast<float>(7 - i) : 10.0F + static_cast<float>(i);
  }
  EXPECT_EQ(select_best_correspondences(c, 4), (std::vector<int>{5, 6, 7, 8}));
  EXPECT_EQ(select_best_correspondences(c, 8), (std::vector<int>{2, 3, 4, 5, 6, 7, 8, 9}));
  c[6].distance_sq = std::numeric_limits<float>::quiet_NaN();
  c[8].scene_point.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(select_best_correspondences(c, 4), (std::vector<int>{4, 5, 7, 9}));
  EXPECT_EQ(select_best_correspondences(c, 100).size(), 9U);
}

TEST(GroupCorrespondencesOptions, RejectsNonsense) {
  EXPECT_NO_THROW(GroupCorrespondencesOptions{}.check());
  EXPECT_THROW((GroupCorrespondencesOptions{.max_distance_difference_m = 0}).check(), std::invalid_argument);
  EXPECT_THROW((GroupCorrespondencesOptions{.max_dot_difference = std::nan("")}).check(), std::invalid_argument);
  EXPECT_THROW((GroupCorrespondencesOptions{.min_group_size = 2}).check(), std::invalid_argument);
  EXPECT_THROW((GroupCorrespondencesOptions{.max_correspondences = 0}).check(), std::invalid_argument);
  EXPECT_THROW((GroupCorrespondencesOptions{.max_cliques = -1}).check(), std::invalid_argument);
  EXPECT_THROW((GroupCorrespondencesOptions{.max_uses = 0}).check(), std::invalid_argument);
}

}  // namespace
}  // namespace resight
