// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <numbers>

#include "resight/report/html_report.hpp"
#include "resight/report/report_test_scene.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// The ball moves in every view but the first.
ReportRun make_long_run(int num_views) {
  ReportRun run = test::make_run();
  const ViewRecord moved = run.views[1];
  for (int v = 2; v < num_views; ++v) {
    ViewRecord& view = run.views.emplace_back(moved);
    view.update.view = v;
    for (ObjectEvent& event : view.update.events) event.view = v;
  }
  return run;
}

std::string first_page(int num_views) {
  return format_report("Long", std::vector{make_long_run(num_views)}, test::make_library());
}

std::string page_of(int num_views, int page) {
  return format_report_page("Long", std::vector{make_long_run(num_views)}, test::make_library(), page);
}

int count_views(const std::string& html) {
  int count = 0;
  for (std::size_t at = html.find("<article "); at != html.npos; at = html.find("<article ", at + 1)) ++count;
  return count;
}

class ReportFolder : public ::testing::Test {
 protected:
  ReportFolder() : folder_(fs::temp_directory_path() / ("resight_report_pages_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
  }
  ~ReportFolder() override { fs::remove_all(folder_); }
  void write(int num_views) const {
    ReportRun run = make_long_run(num_views);
    if (num_views > kViewsPerPage) {
      for (ViewRecord& view : run.views) ASSERT_TRUE(store_picture(view, folder_).ok());
    }
    ASSERT_TRUE(write_report(folder_ / "report.html", "Long", std::vector{run}, test::make_library()).ok());
    remove_old_pages(folder_, num_views);
  }
  [[nodiscard]] std::size_t num_pages() const {
    std::size_t count = 0;
    if (fs::exists(folder_ / kReportPages))
      for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_ / kReportPages)) ++count;
    return count;
  }
  fs::path folder_;
};

TEST(ReportPages, AShortRunIsOnePage) {
  EXPECT_EQ(count_views(first_page(kViewsPerPage)), kViewsPerPage);
  EXPECT_THAT(first_page(kViewsPerPage), Not(HasSubstr(kReportPages)));
}

TEST(ReportPages, ALongRunHasPagesAndTheFirstOneIsBounded) {
  const std::string few = first_page(kViewsPerPage + 1);
  const std::string many = first_page(20 * kViewsPerPage);
  EXPECT_EQ(count_views(many), 0);
  EXPECT_THAT(many, HasSubstr("The first 100 of 2000 views in which an object was found or changed"));
  EXPECT_THAT(many, HasSubstr("href=\"report_pages/views_001900.html\">views 1900 to 1999<"));
  // Eighteen links more, and numbers with more digits.
  EXPECT_LT(many.size(), few.size() + 3000);
}

TEST(ReportPages, APageShowsItsViewsWithTheirHistory) {
  const int num_views = 2 * kViewsPerPage + 50;
  const std::string page = page_of(num_views, 1);
  EXPECT_EQ(count_views(page), kViewsPerPage);
  EXPECT_THAT(page, HasSubstr("id=\"view-100\""));
  EXPECT_THAT(page, HasSubstr("id=\"view-199\""));
  EXPECT_THAT(page, HasSubstr("<th>199</th></tr>"));
  EXPECT_THAT(page, HasSubstr("href=\"views_000000.html\">Previous page"));
  EXPECT_THAT(page, HasSubstr("href=\"views_000200.html\">Next page"));
  EXPECT_EQ(count_views(page_of(num_views, 2)), 50);
  EXPECT_THAT(page_of(num_views, 2), Not(HasSubstr("Next page")));
}

// A removal is known one view after it happened.
TEST(ReportPages, AChangeIsShownAtTheViewAtWhichItHappened) {
  ReportRun run = make_long_run(2 * kViewsPerPage);
  for (ViewRecord& view : run.views) view.update.events.clear();
  ObjectEvent& removal = run.views[kViewsPerPage].update.events.emplace_back();
  removal.kind = ObjectEventKind::kRemoved;
  removal.object = 0;
  removal.view = kViewsPerPage - 1;
  const std::string cell = "title=\"view 99: removed\"";
  const auto library = test::make_library();
  EXPECT_THAT(format_report("Long", std::vector{run}, library), HasSubstr(cell));
  EXPECT_THAT(format_report_page("Long", std::vector{run}, library, 0), HasSubstr(cell));
  EXPECT_THAT(format_report_page("Long", std::vector{run}, library, 1), Not(HasSubstr(cell)));
}

// Its origin lies elsewhere.
TEST(ReportPages, AMoveIsOneOfTheObjectsCenter) {
  auto library = test::make_library();
  library.objects[0].center = {0.08F, 0, 0};
  ReportRun run = make_long_run(1);
  ObjectEvent& move = run.views[0].update.events.emplace_back();
  move.kind = ObjectEventKind::kMoved;
  move.object = 0;
  move.world_from_object_before = Rigid3::identity();
  move.world_from_object_after = Rigid3::from_axis_angle({0, 0, 1}, std::numbers::pi);
  move.world_from_object_after->translation = {0.16 + 0.05, 0, 0};
  EXPECT_THAT(format_report("Turned", std::vector{run}, library), HasSubstr(" by 5.0 cm"));
}

TEST_F(ReportFolder, PicturesOfALongRunAreFilesThatItsPagesShow) {
  ReportRun run = make_long_run(2);
  const std::vector<std::uint8_t> jpeg = run.views[1].picture_jpeg;
  ASSERT_FALSE(jpeg.empty());
  ASSERT_TRUE(store_picture(run.views[1], folder_).ok());
  EXPECT_TRUE(run.views[1].picture_jpeg.empty());
  std::ifstream in(folder_ / "report_pages/view_000001.jpg", std::ios::binary);
  EXPECT_EQ(std::vector<std::uint8_t>(std::istreambuf_iterator<char>(in), {}), jpeg);
  const std::string page = format_report_page("Long", std::vector{run}, test::make_library(), 0);
  EXPECT_THAT(page, HasSubstr("src=\"view_000001.jpg\""));
  EXPECT_THAT(page, HasSubstr("src=\"data:image/jpeg;base64,")) << "the other one is still in memory";
}

TEST_F(ReportFolder, PagesOfALongerRunBeforeAreRemovedAndOtherFilesStay) {
  write(250);
  EXPECT_EQ(num_pages(), 253U);
  for (const char* name : {"view_mine.jpg", "views_1x.html", "view_.jpg", "notes.txt"})
    std::ofstream(folder_ / kReportPages / name) << "mine";
  write(150);
  EXPECT_EQ(num_pages(), 152U + 4U);
  write(2);
  EXPECT_EQ(num_pages(), 4U);
  for (const auto& entry : fs::directory_iterator(folder_ / kReportPages)) fs::remove(entry.path());
  write(2);
  EXPECT_FALSE(fs::exists(folder_ / kReportPages));
}

}  // namespace
}  // namespace resight
