// SPDX-License-Identifier: Apache-2.0
// The changes that `.changes` implies, against the events of the simulator that wrote it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "resight/core/random.hpp"
#include "resight/evaluation/event_score.hpp"
#include "resight/evaluation/random_table_test.hpp"
#include "resight/io/convert.hpp"
#include "resight/simulation/write_simulation.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using Kind = ObjectEventKind;

ModelLibrary library_of(const Simulation& simulation) {
  ModelLibrary library;
  for (const ProceduralObject& object : simulation.library()) {
    ObjectModel& model = library.objects.emplace_back();
    model.name = object.name;
    model.symmetries = object.symmetries;
    model.diameter_m = 0.15F;
    for (const auto& v : object.mesh.vertices) model.center += v / static_cast<float>(object.mesh.vertices.size());
  }
  return library;
}

/// One scene, with the truth from its events in BOP, and from its chains after a conversion to TUW.
class ChangeChains : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("resight_chains_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    auto simulation = Simulation::create(RandomTable(static_cast<std::uint64_t>(GetParam())).script(), 1);
    ASSERT_TRUE(simulation.ok()) << simulation.error().message;
    library_ = library_of(*simulation);
    WriteSimulationOptions options;
    options.models = false;
    ASSERT_TRUE(write_simulation(*simulation, folder_ / "bop", DatasetFormat::kBop, options).ok());
    const fs::path scene = folder_ / "bop/test/000001";
    const auto sequence = open_sequence(scene);
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    const fs::path converted = folder_ / "tuw/table";
    ASSERT_TRUE(convert_sequence(**sequence, converted, DatasetFormat::kTuw, find_change_files(scene, {})).ok());
    read(scene, true, by_events_);
    read(converted, false, by_chains_);
    const auto tuw = open_sequence(converted);
    ASSERT_TRUE(tuw.ok());
    const ChangeFiles chains = {{}, find_change_files(converted, {}).changes};
    ASSERT_TRUE(convert_sequence(**tuw, folder_ / "back/kitchen", DatasetFormat::kBop, chains).ok());
    EXPECT_TRUE(find_change_files(folder_ / "back/kitchen", {}).events.empty());
    read(folder_ / "back/kitchen", false, back_in_bop_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  struct Truth {
    SequenceTruth truth;
    std::vector<ChangeVisibility> visibilities;
    Camera camera;
    [[nodiscard]] EventScore score(const std::vector<ReportedChange>& reports, const ModelLibrary& library) const {
      return score_events(*truth.changes, visibilities, reports, library, {});
    }
    [[nodiscard]] std::vector<SeenChange> counted() const {
      std::vector<SeenChange> changes;
      for (std::size_t i = 0; i < visibilities.size(); ++i)
        if (const SeenChange change{(*truth.changes)[i], visibilities[i]}; change.counts()) changes.push_back(change);
      return changes;
    }
  };

  void read(const fs::path& folder, bool use_events, Truth& result) {
    const auto sequence = open_sequence(folder);
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    ChangeFiles files = find_change_files(folder, {});
    if (!use_events) files.events.clear();
    ASSERT_FALSE(files.empty());
    auto truth = read_sequence_truth(**sequence, library_, files);
    ASSERT_TRUE(truth.ok()) << truth.error().message;
    result.truth = std::move(*truth);
    ChangeVisibilityFinder finder(library_, result.truth);
    for (int v = 0; v < (*sequence)->num_views(); ++v) {
      const auto frame = (*sequence)->read_view(v);
      ASSERT_TRUE(frame.ok());
      result.camera = frame->camera;
      finder.add_view(*frame);
    }
    result.visibilities = finder.visibilities();
  }

  fs::path folder_;
  ModelLibrary library_;
  Truth by_events_;
  Truth by_chains_;
  Truth back_in_bop_;  ///< By the chains, after a conversion of the TUW sequence without its events.
};

// The sides of the counted changes that the views show, as text.
std::vector<std::string> sides_of(const std::vector<SeenChange>& changes) {
  std::vector<std::string> sides;
  const auto add = [&](const SeenChange& c, const std::string& side, const Rigid3& pose, int view) {
    sides.push_back(c.object + side + std::to_string(view) + " at " +
                    std::to_string(std::lround(100 * pose.translation.x())) + " " +
                    std::to_string(std::lround(100 * pose.translation.y())));
  };
  for (const SeenChange& c : changes) {
    if (c.shows_departure()) add(c, " left by view ", *c.world_from_object_before, c.visibility.before_view);
    if (c.shows_arrival()) add(c, " came by view ", *c.world_from_object_after, c.visibility.after_view);
  }
  std::ranges::sort(sides);
  return sides;
}

TEST_P(ChangeChains, ImplyTheChangesThatTheViewsShow) {
  EXPECT_EQ(sides_of(by_chains_.counted()), sides_of(by_events_.counted()));
  EXPECT_FALSE(by_events_.counted().empty());
}

TEST_P(ChangeChains, SurviveTheWayBackToBop) {
  const SequenceTruth& there = by_chains_.truth;
  const SequenceTruth& back = back_in_bop_.truth;
  ASSERT_EQ(back.changes->size(), there.changes->size());
  for (std::size_t i = 0; i < there.changes->size(); ++i) {
    const TrueChange& a = (*there.changes)[i];
    const TrueChange& b = (*back.changes)[i];
    EXPECT_TRUE(a.view == b.view && a.kind == b.kind && a.object == b.object) << i;
  }
  ASSERT_EQ(back.former_places.size(), there.former_places.size());
  for (std::size_t i = 0; i < there.former_places.size(); ++i) {
    const FormerPlace& a = there.former_places[i];
    const FormerPlace& b = back.former_places[i];
    EXPECT_TRUE(a.last_view == b.last_view && a.is_proven == b.is_proven && a.object == b.object) << i;
    EXPECT_LT((a.world_from_object.translation - b.world_from_object.translation).norm(), 1e-9);
  }
}

TEST_P(ChangeChains, ScoreReportsLikeTheEvents) {
  std::vector<ReportedChange> right;
  for (const SeenChange& change : by_events_.counted()) {
    // What an observer of the views can know.
    const SeenChange c = !change.shows_arrival()     ? change.departure()
                         : !change.shows_departure() ? change.arrival()
                                                     : change;
    right.push_back({c.known_since(), c.kind, c.object, c.world_from_object_before, c.world_from_object_after});
  }
  Rng rng(static_cast<std::uint64_t>(GetParam()));
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<ReportedChange> reports;
    for (ReportedChange report : right) {
      if (trial > 0 && rng.below(3) == 0) continue;
      report.view += static_cast<int>(rng.below(3));
      if (trial > 0 && rng.below(4) == 0 && report.world_from_object_after)
        report.world_from_object_after->translation.x() += 0.1;  // Wrong.
      reports.push_back(report);
    }
    const EventScore expected = by_events_.score(reports, library_);
    const EventScore score = by_chains_.score(reports, library_);
    EXPECT_EQ(score.events, expected.events) << "trial " << trial;
    EXPECT_EQ(score.departures, expected.departures) << "trial " << trial;
    EXPECT_EQ(score.arrivals, expected.arrivals) << "trial " << trial;
    EXPECT_EQ(score.delays, expected.delays) << "trial " << trial;
  }
}

// Except where an object left unseen: the chain then ends as if it had left the image.
TEST_P(ChangeChains, GiveTheSameGhosts) {
  std::vector<FormerPlace> seen;
  std::size_t i = 0;  // Of the former place: one per change with a place before.
  for (std::size_t c = 0; c < by_events_.visibilities.size(); ++c) {
    if (!(*by_events_.truth.changes)[c].world_from_object_before) continue;
    const ChangeVisibility& visibility = by_events_.visibilities[c];
    if (visibility.before_view >= 0 || visibility.after_view >= 0) seen.push_back(by_events_.truth.former_places.at(i));
    ++i;
  }
  ASSERT_EQ(i, by_events_.truth.former_places.size());
  int num_ghosts = 0;
  for (int v = 0; v < RandomTable::kNumViews; ++v) {
    const TruthView& truth = by_events_.truth.views[static_cast<std::size_t>(v)];
    std::vector<DetectedObject> detections;
    for (const TruthView& other : by_events_.truth.views)  // Whatever stood anywhere at any time is reported.
      for (const GroundTruthObject& object : other.objects)
        detections.push_back({object.object,
                              truth.world_from_camera.inverse() * other.world_from_camera * object.camera_from_object,
                              1});
    const auto ghosts_at = [&](const std::vector<FormerPlace>& places) {
      std::vector<int> ghosts;
      for (const Ghost& g : find_ghosts(places, truth, v, detections, by_events_.camera, library_))
        ghosts.push_back(g.detection);
      return ghosts;
    };
    const std::vector<int> expected = ghosts_at(seen);
    EXPECT_EQ(ghosts_at(by_chains_.truth.former_places), expected) << "view " << v;
    num_ghosts += static_cast<int>(expected.size());
  }
  EXPECT_GT(num_ghosts, 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ChangeChains, testing::Range(1, 5));

}  // namespace
}  // namespace resight
