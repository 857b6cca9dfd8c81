// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/matched_regions.hpp"

#include <gtest/gtest.h>

#include "resight/annotation/annotation_checks.hpp"

namespace resight {
namespace {

ChangeProposal propose(int view, RegionKind kind, double x_m, double size_m = 0.1) {
  ChangeProposal proposal;
  proposal.view = view;
  proposal.kind = kind;
  proposal.box.world_from_box = Rigid3::from_translation({x_m, 0, 0});
  proposal.box.size_m = Eigen::Vector3d(size_m, 0.5 * size_m, 0.2 * size_m);
  proposal.points_in_world = {Eigen::Vector3f(static_cast<float>(x_m), 0, 0)};
  return proposal;
}

void judge(AnnotationDocument& document, const RegionKey& region, RegionVerdict verdict) {
  document.regions[region] = {.region = region, .verdict = verdict, .track = -1, .mask = std::nullopt};
}

TEST(MatchRegions, DecisionsFollowTheirRegionsWhateverTheirNumbersAre) {
  AnnotationDocument document;
  const ChangeProposal came = propose(3, RegionKind::kNovel, 0);
  const ChangeProposal left = propose(3, RegionKind::kRemoved, 0);
  judge(document, came.key(), RegionVerdict::kAccepted);
  judge(document, left.key(), RegionVerdict::kRejected);
  // Another detection: one more region comes first, and the places differ a little.
  const std::vector<ChangeProposal> proposals = {
      propose(1, RegionKind::kNovel, 0), propose(3, RegionKind::kRemoved, 0.01), propose(3, RegionKind::kNovel, -0.02)};
  const MatchedRegions matched = match_regions(document, proposals);
  EXPECT_EQ(matched.of_proposal[0], nullptr);
  ASSERT_NE(matched.of_proposal[1], nullptr);
  EXPECT_EQ(matched.of_proposal[1]->verdict, RegionVerdict::kRejected);
  ASSERT_NE(matched.of_proposal[2], nullptr);
  EXPECT_EQ(matched.of_proposal[2]->verdict, RegionVerdict::kAccepted);
  EXPECT_TRUE(matched.unmatched.empty());
}

TEST(MatchRegions, TheNearestPairsBelongTogetherAndEachOnce) {
  AnnotationDocument document;
  judge(document, propose(2, RegionKind::kNovel, 0).key(), RegionVerdict::kAccepted);
  judge(document, propose(2, RegionKind::kNovel, 0.02).key(), RegionVerdict::kRejected);
  const std::vector<ChangeProposal> proposals = {propose(2, RegionKind::kNovel, 0.02),
                                                 propose(2, RegionKind::kNovel, 0)};
  const MatchedRegions matched = match_regions(document, proposals);
  EXPECT_EQ(matched.of_proposal[0]->verdict, RegionVerdict::kRejected);
  EXPECT_EQ(matched.of_proposal[1]->verdict, RegionVerdict::kAccepted);
}

TEST(MatchRegions, WhatIsNoLongerProposedIsKeptAndListed) {
  AnnotationDocument document;
  judge(document, propose(2, RegionKind::kNovel, 0).key(), RegionVerdict::kAccepted);
  const std::vector<ChangeProposal> proposals = {propose(2, RegionKind::kNovel, 0.03),
                                                 propose(4, RegionKind::kNovel, 0)};
  const MatchedRegions matched = match_regions(document, proposals);
  ASSERT_EQ(matched.unmatched.size(), 1U);
  const auto to_dos = find_to_dos(document, {}, proposals);
  ASSERT_EQ(to_dos.size(), 3U) << "both regions are open, and the decision is lost";
  EXPECT_EQ(to_dos[2].kind, AnnotationToDo::Kind::kLostRegion);
  EXPECT_EQ(to_dos[2].view, 2);
  ASSERT_TRUE(to_dos[2].lost.has_value());
  EXPECT_EQ(to_dos[2].text, "view 3: you accepted that something came, but this is no longer proposed");
}

TEST(MatchRegions, LargeRegionsMayMoveFarther) {
  AnnotationDocument document;
  judge(document, propose(2, RegionKind::kNovel, 0).key(), RegionVerdict::kAccepted);
  const std::vector<ChangeProposal> large = {propose(2, RegionKind::kNovel, 0.2, 1.0)};
  EXPECT_NE(match_regions(document, large).of_proposal[0], nullptr);
}

TEST(PixelRuns, GiveTheMaskBack) {
  Image<std::uint8_t> mask(7, 3);
  for (const int pixel : {0, 1, 6, 7, 8, 20}) mask[static_cast<std::size_t>(pixel)] = 255;
  const PixelRuns runs = find_runs(mask);
  EXPECT_EQ(runs, (PixelRuns{{0, 2}, {6, 3}, {20, 1}}));
  EXPECT_EQ(make_mask(runs, 7, 3), mask);
  EXPECT_TRUE(check_runs(runs).ok());
  EXPECT_EQ(make_mask({{0, 1 << 24}}, 2, 2), Image<std::uint8_t>(2, 2, 255)) << "beyond the image";
  EXPECT_TRUE(find_runs(Image<std::uint8_t>(7, 3)).empty());
}

TEST(PixelRuns, MustAscendWithinTheLargestImage) {
  for (const PixelRuns& runs : {PixelRuns{{-1, 2}}, PixelRuns{{0, 0}}, PixelRuns{{4, 2}, {5, 1}},
                                PixelRuns{{1 << 24, 1}}, PixelRuns{{5, 1 << 24}}})
    EXPECT_FALSE(check_runs(runs).ok()) << runs.front().first;
}

}  // namespace
}  // namespace resight
