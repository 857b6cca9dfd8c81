// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/hypothesis_pool.hpp"

#include <gtest/gtest.h>

#include "resight/models/testing/square_world.hpp"

namespace resight {
namespace {

using test::make_plate;
using test::plate_at;

class HypothesisPoolTest : public ::testing::Test {
 protected:
  HypothesisPoolTest() { library_.objects = {make_plate("a")}; }
  static Hypothesis at(std::uint64_t id, double x) {
    Hypothesis hypothesis;
    hypothesis.id = id;
    hypothesis.object = 0;
    hypothesis.world_from_object = plate_at(x, 0, 1);
    return hypothesis;
  }
  static std::vector<std::uint64_t> ids(const std::vector<Hypothesis>& hypotheses) {
    std::vector<std::uint64_t> result;
    for (const Hypothesis& h : hypotheses) result.push_back(h.id);
    return result;
  }
  static HypothesisEvidence evidence(Verdict verdict, double explained_share) {
    HypothesisEvidence e;
    e.verdict = verdict;
    e.explained_share = explained_share;
    return e;
  }
  using Ids = std::vector<std::uint64_t>;
  const std::vector<int> kFirst{0}, kBoth{0, 1};

  ModelLibrary library_;
  HypothesisPool pool_{library_, ClusterHypothesesOptions{}};
};

TEST_F(HypothesisPoolTest, MergesTheWindowAndForgetsOlderViews) {
  pool_.add_view({at(0, 0), at(1, 1)}, kFirst);
  EXPECT_EQ(ids(pool_.merge({})), (Ids{0, 1}));
  pool_.add_view({at(2, 2)}, kBoth);
  EXPECT_EQ(ids(pool_.merge({})), (Ids{0, 1, 2}));
  pool_.add_view({}, std::vector{1, 2});  // A view that is not searched counts, too.
  EXPECT_EQ(ids(pool_.merge({})), (Ids{2}));
  pool_.add_view({at(3, 3)}, std::vector{1, 3});  // The last view has left before others.
  pool_.add_view({at(4, 4)}, std::vector{1, 4});
  EXPECT_EQ(ids(pool_.merge({})), (Ids{2, 4}));
}

TEST_F(HypothesisPoolTest, IdsOfTrackedHypothesesAreAboveAllOthersAndAscend) {
  pool_.add_view({at(1000000, 0)}, kFirst);
  const std::vector<Hypothesis> first = pool_.merge({at(0, 1), at(0, 2)});
  ASSERT_EQ(first.size(), 3U);
  EXPECT_EQ(first[0].id, 1000000U);
  EXPECT_LT(first[0].id, first[1].id);
  EXPECT_LT(first[1].id, first[2].id);
  const std::vector<Hypothesis> second = pool_.merge({at(0, 1)});
  EXPECT_GT(second[1].id, first[2].id) << "unique within a run";
}

TEST_F(HypothesisPoolTest, AClusterWithATrackedMemberIsTracked) {
  pool_.add_view({at(0, 0), at(1, 1)}, kFirst);
  const std::vector<Hypothesis> clustered = pool_.cluster(pool_.merge({at(0, 0.001)}));
  ASSERT_EQ(clustered.size(), 2U);
  for (const Hypothesis& h : clustered) EXPECT_EQ(pool_.is_tracked(h), h.world_from_object.translation.x() < 0.5);
}

TEST_F(HypothesisPoolTest, KnowsWhatTheNewestViewContributed) {
  pool_.add_view({at(0, 0)}, kFirst);
  pool_.add_view({at(1, 0.001), at(2, 1)}, kBoth);
  for (const Hypothesis& h : pool_.cluster(pool_.merge({at(0, 0)})))
    EXPECT_EQ(ids(pool_.members_of_newest_view(h.id)), h.world_from_object.translation.x() < 0.5 ? Ids{1} : Ids{2});
}

TEST_F(HypothesisPoolTest, WithoutClusteringEachStandsForItself) {
  HypothesisPool pool(library_, std::nullopt);
  pool.add_view({at(0, 0), at(1, 0)}, kFirst);
  const std::vector<Hypothesis> all = pool.cluster(pool.merge({at(0, 0)}));
  ASSERT_EQ(all.size(), 3U);
  EXPECT_FALSE(pool.is_tracked(all[0]));
  EXPECT_TRUE(pool.is_tracked(all[2]));
  EXPECT_EQ(ids(pool.members_of_newest_view(1)), (Ids{1}));
}

TEST_F(HypothesisPoolTest, RefutedMembersAreForgotten) {
  pool_.add_view({at(0, 0), at(1, 1), at(2, 2), at(3, 3)}, kFirst);
  pool_.add_view({at(4, 0.001)}, kBoth);
  const std::vector<Hypothesis> clustered = pool_.cluster(pool_.merge({}));
  ASSERT_EQ(clustered.size(), 4U);
  std::vector<HypothesisEvidence> all;
  for (const Hypothesis& h : clustered) {
    const double x = h.world_from_object.translation.x();
    if (x < 0.5)
      all.push_back(evidence(Verdict::kNoSupport, 0.3));  // Two members, of two views.
    else if (x < 1.5)
      all.push_back(evidence(Verdict::kTooFewVisible, 0));  // It may be hidden.
    else if (x < 2.5)
      all.push_back(evidence(Verdict::kDifferentAppearance, 0.9));
    else
      all.push_back(evidence(Verdict::kCost, 0.4));
  }
  pool_.forget_refuted(clustered, all, 0);
  EXPECT_EQ(pool_.merge({}).size(), 5U) << "off";
  pool_.forget_refuted(clustered, all, 0.4);
  EXPECT_EQ(ids(pool_.merge({})), (Ids{1, 3}));
}

TEST_F(HypothesisPoolTest, ARejectedTrackedObjectIsNoticedIfItIsVisible) {
  pool_.add_view({at(0, 0)}, kFirst);
  const std::vector<Hypothesis> clustered = pool_.cluster(pool_.merge({at(0, 1)}));
  ASSERT_EQ(clustered.size(), 2U);
  const std::size_t tracked = pool_.is_tracked(clustered[0]) ? 0 : 1;
  const auto is_rejected = [&](std::size_t which, Verdict verdict) {
    std::vector<HypothesisEvidence> all(2, evidence(Verdict::kAccepted, 1));
    all[which].verdict = verdict;
    return pool_.is_tracked_object_rejected(clustered, all);
  };
  for (const Verdict verdict : {Verdict::kNoSupport, Verdict::kDifferentAppearance, Verdict::kCost}) {
    EXPECT_TRUE(is_rejected(tracked, verdict));
    EXPECT_FALSE(is_rejected(1 - tracked, verdict));
  }
  EXPECT_FALSE(is_rejected(tracked, Verdict::kTooFewVisible));
  EXPECT_FALSE(is_rejected(tracked, Verdict::kAccepted));
}

}  // namespace
}  // namespace resight
