// SPDX-License-Identifier: Apache-2.0
#include "resight/report/html_report.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/report/internal/html.hpp"
#include "resight/report/report_test_scene.hpp"

namespace resight {
namespace {

using namespace resight::test;

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string report_of(const std::vector<ReportRun>& runs) { return format_report("A title", runs, make_library()); }

/// Returns the first tag that is closed out of order, or "" if all are properly nested. Counts the tags.
std::string first_bad_tag(const std::string& html, int& num_tags) {
  const std::set<std::string> never_closed = {"!DOCTYPE", "meta", "img", "br"};
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const bool closes = html[at + 1] == '/';
    const std::size_t begin = at + (closes ? 2 : 1);
    const std::string name = html.substr(begin, html.find_first_of(" >", begin) - begin);
    ++num_tags;
    if (never_closed.count(name) != 0) continue;
    if (!closes) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "</" + name + "> at " + html.substr(at, 40);
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> is never closed";
}

TEST(FormatReport, IsWellNested) {
  int num_tags = 0;
  EXPECT_EQ(first_bad_tag(report_of({make_run("mvr"), make_run("default")}), num_tags), "");
  EXPECT_GT(num_tags, 300);
}

TEST(FormatReport, NeedsNoNetworkAndNoOtherFile) {
  const std::string html = report_of({make_run()});
  for (const char* outside : {"http:", "https:", "//", "<link", "<script", "@import", "url("}) {
    // Base64 contains slashes, so pictures are excluded.
    std::string text = html;
    for (std::size_t at = text.find("base64,"); at != std::string::npos; at = text.find("base64,", at + 1)) {
      text.erase(at + 7, text.find('"', at) - at - 7);
    }
    EXPECT_EQ(text.find(outside), std::string::npos) << outside;
  }
}

TEST(FormatReport, ShowsEachViewOfEachRunSideBySide) {
  const std::string html = report_of({make_run("mvr"), make_run("default")});
  EXPECT_EQ(count_of(html, "<img "), 4);
  EXPECT_EQ(count_of(html, "<article id=\"view-"), 2);
  EXPECT_GT(count_of(html, ">mvr<"), 3);
  EXPECT_EQ(count_of(report_of({make_run()}), "<img "), 2);
}

TEST(FormatReport, LinesUpRunsOfDifferentLength) {
  ReportRun shorter = make_run("mvr");
  shorter.views.erase(shorter.views.begin());
  const std::string html = report_of({shorter, make_run("default")});
  EXPECT_EQ(count_of(html, "<article id=\"view-"), 2);
  EXPECT_EQ(count_of(html, "<img "), 3);
}

TEST(FormatReport, DescribesWhatHappened) {
  const std::string html = report_of({make_run()});
  EXPECT_NE(html.find("title=\"view 1: moved\""), std::string::npos);
  EXPECT_NE(html.find("title=\"view 1: removed\""), std::string::npos);
  EXPECT_NE(html.find("by 30.0 cm"), std::string::npos);
  EXPECT_EQ(html.find("Ghosts"), std::string::npos) << "no ground truth, no score";
}

TEST(FormatReport, ShowsScoresWhereThereIsGroundTruth) {
  ReportRun run = make_run();
  run.views[0].evaluation.emplace();
  run.views[0].evaluation->matching.score = {3, 1, 2};
  run.views[0].evaluation->missed.resize(1);
  run.views[0].evaluation->missed[0].object = "lost_thing";
  run.views[0].marks[0] = DetectionMark::kGhost;
  const std::string html = report_of({run});
  EXPECT_NE(html.find("0.75 / 0.60 / 0.67"), std::string::npos);
  EXPECT_NE(html.find("3 / 1 / 2"), std::string::npos);
  EXPECT_NE(html.find("Missed: lost_thing"), std::string::npos);
  EXPECT_NE(html.find(">ghost</td>"), std::string::npos);
  EXPECT_EQ(html.find("nan"), std::string::npos);
}

TEST(FormatReport, MarksSettingsThatDiffer) {
  ReportRun other = make_run("mvr");
  other.settings[1].second = "0.05";
  const std::string html = report_of({make_run(), other});
  EXPECT_NE(html.find("<b>changes.tolerance_m</b>"), std::string::npos);
  EXPECT_EQ(html.find("<b>num_previous_views</b>"), std::string::npos);
}

TEST(FormatReport, EscapesWhatTheUserNamed) {
  ReportRun run = make_run("<b>\"x\"</b>");
  run.views[0].update.view_name = "<script>alert('1')</script>";
  run.settings.emplace_back("a<b", "c&d");
  ModelLibrary library = make_library();
  library.objects[0].name = "<img src=x>";
  const std::string html = format_report("<i>title", std::vector<ReportRun>{run}, library);
  for (const char* raw : {"<script", "<i>title", "<img src=x", "a<b<", "c&d"}) {
    EXPECT_EQ(html.find(raw), std::string::npos) << raw;
  }
  EXPECT_NE(html.find("&lt;img src=x&gt;"), std::string::npos);
  EXPECT_NE(html.find("table &lt;1&gt;"), std::string::npos);
}

TEST(FormatReport, BearsAnEmptyRunAndRefusesNone) {
  ReportRun empty;
  empty.preset = "default";
  int num_tags = 0;
  EXPECT_EQ(first_bad_tag(report_of({empty}), num_tags), "");
  EXPECT_THROW((void)report_of({}), std::invalid_argument);
}

TEST(WriteReport, WritesThePageOrNamesTheFile) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("resight_report_test_" + std::to_string(::getpid()));
  const std::vector<ReportRun> runs = {make_run()};
  ASSERT_TRUE(write_report(folder / "report.html", "A title", runs, make_library()).ok());
  std::ifstream in(folder / "report.html", std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), report_of(runs));
  const Result<void> blocked = write_report(folder / "report.html" / "x.html", "A title", runs, make_library());
  ASSERT_FALSE(blocked.ok());
  EXPECT_NE(blocked.error().message.find("report.html"), std::string::npos);
  std::filesystem::remove_all(folder);
}

std::vector<std::uint8_t> decode_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned buffer = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    buffer = buffer << 6 | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<std::uint8_t>(buffer >> bits & 255U));
    }
  }
  return bytes;
}

TEST(Base64, KnownWordsAndRoundTrip) {
  const auto encode = [](const std::string& text) {
    return report::base64(std::vector<std::uint8_t>(text.begin(), text.end()));
  };
  EXPECT_EQ(encode(""), "");  // RFC 4648, Sec. 10.
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
  Rng rng(5);
  for (std::size_t length = 0; length < 100; ++length) {
    std::vector<std::uint8_t> bytes(length);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(rng.below(256));
    const std::string text = report::base64(bytes);
    EXPECT_EQ(text.size() % 4, 0U);
    EXPECT_EQ(decode_base64(text), bytes) << "length " << length;
  }
}

TEST(HtmlText, NumbersForReaders) {
  EXPECT_EQ(report::number(0.12345, 2), "0.12");
  EXPECT_EQ(report::number(std::nan(""), 2), "–");
  EXPECT_EQ(report::percent(0.256), "26 %");
  EXPECT_EQ(report::duration(0.0042), "4.2 ms");
  EXPECT_EQ(report::duration(0.42), "420 ms");
  EXPECT_EQ(report::duration(4.2), "4.20 s");
  EXPECT_EQ(report::css_color({255, 0, 16}), "#ff0010");
}

}  // namespace
}  // namespace resight
