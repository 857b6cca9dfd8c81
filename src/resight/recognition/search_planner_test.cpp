// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/search_planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "resight/models/testing/square_world.hpp"

namespace resight {
namespace {

using test::kLeft;
using test::kRight;
using test::make_plate;
using test::see_plates;

constexpr int kTrack = 7;

// A plate that was found at its place in view 0 and is fully explained by every view since.
class SearchPlannerTest : public ::testing::Test {
 protected:
  SearchPlannerTest() {
    library_.objects = {make_plate("a")};
    tracked_.track = kTrack;
    tracked_.object = 0;
    tracked_.world_from_object = kLeft;
    tracked_.since_view = 0;
  }
  static SearchPlannerOptions every_fourth() {
    SearchPlannerOptions options;
    options.place_interval = 4;
    return options;
  }
  SearchPlanner make_planner(const SearchPlannerOptions& options) const {
    return {library_, options, {}, TrackCorrespondences(6, 0.01)};
  }

  // Whether the place of the plate is searched in a view.
  bool is_searched(int number, const RgbdFrame& frame) {
    const Image<std::uint8_t> skipped = planner_.find_skipped_pixels(number, frame, std::array{tracked_});
    return std::ranges::count(skipped.data(), 255) == 0;
  }
  void record(int number, double explained_share = 1) {
    Detection detection;
    detection.object = 0;
    detection.track = kTrack;
    detection.world_from_object = kLeft;
    detection.views = {{number, true, 1, explained_share, 0}};
    pool_.add_view({}, std::vector{number});
    Hypothesis hypothesis;
    hypothesis.object = 0;
    hypothesis.world_from_object = kLeft;
    detection.hypothesis_id = pool_.cluster(pool_.merge({hypothesis}))[0].id;
    planner_.record(number, std::array{detection}, std::array{tracked_}, pool_);
    tracked_.last_view = tracked_.seen_view = number;
  }
  // Views 0 to 2: found, confirmed, skipped.
  void confirm() {
    for (int number = 0; number < 3; ++number) {
      ASSERT_EQ(is_searched(number, frame_), number < 2);
      record(number);
    }
  }

  ModelLibrary library_;
  TrackedObject tracked_;
  RgbdFrame frame_ = see_plates({kLeft, kRight});
  SearchPlanner planner_ = make_planner(every_fourth());
  HypothesisPool pool_{library_, std::nullopt};
};

TEST_F(SearchPlannerTest, APlaceIsSearchedInTheFirstViewsAndThenOncePerInterval) {
  std::vector<int> searched;
  for (int number = 0; number < 11; ++number) {
    if (is_searched(number, frame_)) searched.push_back(number);
    record(number);
  }
  EXPECT_EQ(searched, (std::vector{0, 1, 5, 9}));
}

TEST_F(SearchPlannerTest, OnlyThePixelsOfTheObjectAreSkipped) {
  confirm();
  const Image<std::uint8_t> skipped = planner_.find_skipped_pixels(3, frame_, std::array{tracked_});
  for (int v = 0; v < skipped.height(); ++v)
    for (int u = 0; u < skipped.width(); ++u)
      EXPECT_EQ(skipped(u, v) != 0, frame_.depth_m(u, v) < 1.5F && u < skipped.width() / 2) << u << " " << v;
}

// Its centre is beside the image, and only searches that see the centre count.
TEST_F(SearchPlannerTest, APlaceThatWasNeverSearchedIsSearched) {
  tracked_.world_from_object = test::plate_at(-0.64, 0, 1);
  frame_ = see_plates({tracked_.world_from_object});
  for (int number = 0; number < 3; ++number) {
    EXPECT_TRUE(is_searched(number, frame_)) << number;
    record(number);
  }
}

TEST_F(SearchPlannerTest, ATentativeObjectIsSearchedFor) {
  confirm();
  tracked_.is_confirmed = false;
  EXPECT_TRUE(is_searched(3, frame_));
}

TEST_F(SearchPlannerTest, AnObjectThatTheLastViewDidNotConfirmIsSearchedFor) {
  confirm();
  tracked_.seen_view = 1;
  EXPECT_TRUE(is_searched(3, frame_));
}

TEST_F(SearchPlannerTest, AnObjectThatTheLastViewExplainedInPartIsSearchedFor) {
  confirm();
  record(2, 0.8);
  EXPECT_TRUE(is_searched(3, frame_));
}

TEST_F(SearchPlannerTest, AnObjectThatIsNearerThanInAnySearchIsSearchedFor) {
  confirm();
  const Rigid3 forward = Rigid3::from_translation({0, 0, 0.3});
  RgbdFrame nearer = see_plates({forward.inverse() * kLeft});
  nearer.world_from_camera = forward;
  EXPECT_TRUE(is_searched(3, nearer));
  record(3);
  EXPECT_FALSE(is_searched(4, nearer)) << "as near as in the last search";
}

TEST_F(SearchPlannerTest, AnObjectWhosePlaceHasChangedIsSearchedFor) {
  confirm();
  planner_.set_outdated(std::array{tracked_}, std::array<std::uint8_t, 1>{0});
  EXPECT_FALSE(is_searched(3, frame_));
  planner_.set_outdated(std::array{tracked_}, std::array<std::uint8_t, 1>{1});
  EXPECT_TRUE(is_searched(3, frame_));
  record(3);
  planner_.set_outdated(std::array{tracked_}, {});
  EXPECT_FALSE(is_searched(4, frame_));
}

TEST_F(SearchPlannerTest, AfterAnIncompleteSearchEveryPlaceIsSearched) {
  confirm();
  planner_.request_full_search();
  EXPECT_TRUE(is_searched(3, frame_));
}

TEST_F(SearchPlannerTest, AForgottenTrackStartsAnew) {
  confirm();
  planner_.record(2, {}, {}, pool_);
  EXPECT_TRUE(is_searched(3, frame_));
}

TEST_F(SearchPlannerTest, CorrespondencesOfSearchesBeforeTheWindowHoldThePose) {
  Hypothesis found;
  found.id = 3;
  found.object = 0;
  found.world_from_object = kLeft;
  found.correspondences.resize(5);
  for (std::size_t i = 0; i < 5; ++i) {
    Correspondence& c = found.correspondences[i];
    c.model_feature = static_cast<int>(i);
    c.scene_point = Rigid3f(kLeft) * c.model_point;
  }
  pool_.add_view({found}, std::vector{0});
  Detection detection;
  detection.object = 0;
  detection.track = kTrack;
  detection.hypothesis_id = pool_.cluster(pool_.merge({}))[0].id;
  detection.world_from_object = kLeft;
  detection.views.emplace_back();
  planner_.record(2, std::array{detection}, std::array{tracked_}, pool_);
  tracked_.last_view = 4;
  const auto hypotheses = [&](int window_begin) {
    return planner_.tracked_hypotheses(std::array{tracked_}, window_begin);
  };
  ASSERT_EQ(hypotheses(3).size(), 1U);
  EXPECT_EQ(hypotheses(3)[0].correspondences.size(), 5U);
  EXPECT_EQ(hypotheses(3)[0].world_from_object.translation, kLeft.translation);
  EXPECT_EQ(hypotheses(3)[0].origin_views, (std::vector<int>{4}));
  EXPECT_TRUE(hypotheses(2)[0].correspondences.empty()) << "the window has those of view 2 itself";
  tracked_.since_view = 3;
  EXPECT_TRUE(hypotheses(3)[0].correspondences.empty()) << "it has moved since";
  tracked_.since_view = 0;
  planner_.set_outdated(std::array{tracked_}, std::array<std::uint8_t, 1>{1});
  EXPECT_TRUE(hypotheses(3)[0].correspondences.empty()) << "its place has changed since";
}

TEST_F(SearchPlannerTest, OffItSearchesEveryViewEverywhere) {
  SearchPlanner planner = make_planner({});
  EXPECT_FALSE(planner.skips_places());
  for (int number = 0; number < 5; ++number) {
    EXPECT_TRUE(planner.needs_search(prepare_view(frame_), {}));
    EXPECT_EQ(planner.find_skipped_pixels(number, frame_, std::array{tracked_}).size(), 0U);
  }
}

TEST_F(SearchPlannerTest, RefusesInvalidOptions) {
  SearchPlannerOptions options;
  options.place_interval = -1;
  EXPECT_THROW((void)make_planner(options), std::invalid_argument);
  options = {};
  options.min_explained_share = 2;
  EXPECT_THROW((void)make_planner(options), std::invalid_argument);
}

}  // namespace
}  // namespace resight
