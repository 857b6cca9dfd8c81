// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/track_journal.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <iterator>
#include <optional>
#include <vector>

#include "resight/core/files.hpp"
#include "resight/sensor/testing/ball_scene.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

constexpr int kViews = 8;

PreparedView make_view(int v) {
  const double angle = 0.09 * v;
  return prepare_view(test::render_ball_scene(
      {}, test::look_at_point({1.2 * std::sin(angle), -1.1 * std::cos(angle), 0.6}, {0, 0.1, 0.05}), 0.001,
      static_cast<std::uint64_t>(v + 1)));
}

/// Replaces the last number of this name.
void replace_last(std::string& text, const std::string& key, const std::string& value) {
  const std::size_t begin = text.rfind("\"" + key + "\":") + key.size() + 3;
  text.replace(begin, text.find(',', begin) - begin, value);
}

class TrackJournalTest : public testing::Test {
 protected:
  TrackJournalTest() {
    fs::create_directories(folder_);
    fs::remove(file_);
  }
  ~TrackJournalTest() override { fs::remove_all(folder_); }

  // Tracks the views after those in the journal, up to view `to` - 1.
  void go_on(ViewTracker& tracker, const std::string& job, int to) const {
    auto opened = TrackJournal::open(file_, job);
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    TrackJournal& journal = *opened;
    int view = 0;
    for (const TrackerStep& step : journal.steps()) {
      std::optional<PreparedView> prepared;
      if (step.view.is_keyframe) prepared = make_view(view);
      tracker.restore_view(step, prepared ? &*prepared : nullptr);
      ++view;
    }
    for (; view < to; ++view) {
      (void)tracker.add_view(make_view(view));
      ASSERT_TRUE(journal.append(tracker.last_step()).ok());
    }
  }
  [[nodiscard]] std::size_t num_steps(const std::string& job) const {
    return TrackJournal::open(file_, job)->steps().size();
  }
  [[nodiscard]] std::string read() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path folder_ = fs::temp_directory_path() / ("resight_journal_" + std::to_string(::getpid()));
  fs::path file_ = folder_ / "poses.txt.partial";
};

TEST_F(TrackJournalTest, AnInterruptedRunEndsAsOneThatWasNot) {
  ViewTracker whole;
  for (int v = 0; v < kViews; ++v) (void)whole.add_view(make_view(v));
  const CameraTrack expected = whole.finish();
  {
    ViewTracker interrupted;
    go_on(interrupted, "job", 5);
  }
  ViewTracker tracker;
  go_on(tracker, "job", kViews);
  const CameraTrack track = tracker.finish();
  ASSERT_EQ(track.views.size(), expected.views.size());
  EXPECT_EQ(track.edges.size(), expected.edges.size());
  for (std::size_t v = 0; v < track.views.size(); ++v) {
    EXPECT_EQ(track.views[v].world_from_camera.matrix(), expected.views[v].world_from_camera.matrix()) << v;
    EXPECT_EQ(track.views[v].sigma, expected.views[v].sigma) << v;
    EXPECT_EQ(track.views[v].is_keyframe, expected.views[v].is_keyframe) << v;
  }
}

TEST_F(TrackJournalTest, OnlyWholeStepsOfTheSameJobCount) {
  ViewTracker tracker;
  go_on(tracker, "job", 4);
  ASSERT_EQ(num_steps("job"), 4U);
  const std::string good = read();
  for (const auto& spoil : std::vector<std::function<void(std::string&)>>{
           [](std::string& text) { text.resize(text.size() - 1); },  // The end of the line is missing.
           [](std::string& text) { text[text.rfind("\"overlap\"")] = 'x'; },
           [](std::string& text) { text.insert(text.rfind("\"rotation\":[") + 12, "1"); },
           [](std::string& text) { text[text.rfind("\"component\":0") + 12] = '9'; },
           [](std::string& text) { replace_last(text, "num_matches", "1e32"); },
           [](std::string& text) { replace_last(text, "num_matches", "0.5"); },
           [](std::string& text) { replace_last(text, "component", "-1"); }}) {
    std::string text = good;
    spoil(text);
    ASSERT_TRUE(write_file(file_, text).ok());
    EXPECT_EQ(num_steps("job"), 3U);
  }
  EXPECT_EQ(num_steps("another"), 0U);
  ViewTracker other;
  go_on(other, "another", 1);
  EXPECT_EQ(num_steps("job"), 0U);
  EXPECT_EQ(num_steps("another"), 1U);
}

TEST_F(TrackJournalTest, BeginsWithTheFirstStepAndIsRemovedInTheEnd) {
  ViewTracker tracker;
  (void)tracker.add_view(make_view(0));
  auto opened = TrackJournal::open(file_, "job");
  ASSERT_TRUE(opened.ok());
  TrackJournal& journal = *opened;
  EXPECT_FALSE(fs::exists(file_));
  ASSERT_TRUE(journal.append(tracker.last_step()).ok());
  auto below = TrackJournal::open(file_ / "below", "job");  // Below a file.
  EXPECT_FALSE(below.ok() && below->append(tracker.last_step()).ok());
  EXPECT_EQ(num_steps("job"), 1U);
  journal.remove();
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(TrackJournalTest, AForeignFileIsNotTakenForAJournal) {
  ASSERT_TRUE(write_file(file_, "my notes\n").ok());
  const auto opened = TrackJournal::open(file_, "job");
  ASSERT_FALSE(opened.ok());
  EXPECT_NE(opened.error().message.find("no journal"), std::string::npos) << opened.error().message;
  EXPECT_EQ(read(), "my notes\n");
}

TEST_F(TrackJournalTest, NamesNeedNotBeUtf8) {
  ViewTracker tracker;
  (void)tracker.add_view(make_view(0));
  auto journal = TrackJournal::open(file_, "a folder \xff");
  ASSERT_TRUE(journal.ok());
  ASSERT_TRUE(journal->append(tracker.last_step()).ok());
  EXPECT_EQ(TrackJournal::open(file_, "a folder \xff")->steps().size(), 1U);
}

}  // namespace
}  // namespace resight
