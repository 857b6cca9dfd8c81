// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "resight/report/html_report.hpp"
#include "resight/report/internal/html.hpp"

namespace resight::report {
namespace {

struct CellStyle {
  const char* css_class;
  const char* glyph;
  int weight;  // Of several events in one cell, the one with the largest weight is shown.
};

CellStyle style_of_event(ObjectEventKind kind) {
  switch (kind) {
    case ObjectEventKind::kFound:
      return {"found", "●", 2};
    case ObjectEventKind::kAdded:
      return {"added", "+", 3};
    case ObjectEventKind::kMoved:
      return {"moved", "→", 4};
    case ObjectEventKind::kRemoved:
      return {"removed", "×", 5};
    case ObjectEventKind::kStillThere:
      return {"still", "●", 1};
    case ObjectEventKind::kNotSeen:
      return {"unseen", "?", 0};
  }
  return {"none", "", -1};
}

/// Rows of the table: events of each track by view.
struct Timeline {
  struct Row {
    int object = -1;
    std::map<int, ObjectEventKind> events;  // By view.
  };
  std::map<int, Row> rows;  // By track.

  void add(const ObjectEvent& event) {
    Row& row = rows[event.track];
    row.object = event.object;
    const auto [place, is_new] = row.events.emplace(event.view, event.kind);
    if (!is_new && style_of_event(event.kind).weight > style_of_event(place->second).weight) place->second = event.kind;
  }
};

Timeline make_timeline(const ReportRun& run, std::span<const int> views) {
  const std::set<int> shown(views.begin(), views.end());
  Timeline timeline;
  for (const ViewRecord& view : run.views)
    for (const ObjectEvent& event : view.update.events)
      if (shown.contains(event.view)) timeline.add(event);
  return timeline;
}

/// Whether an event makes a view worth showing among thousands.
bool is_news(ObjectEventKind kind) { return is_change(kind) || kind == ObjectEventKind::kFound; }

/// The rows of objects for which something happened in the views.
void keep_news(Timeline& timeline) {
  std::erase_if(timeline.rows, [](const auto& row) {
    return std::ranges::none_of(row.second.events, [](const auto& event) { return is_news(event.second); });
  });
}

std::string cell(const CellStyle& style, const std::string& title) {
  return fmt::format("<span class=\"cell {}\" title=\"{}\">{}</span>", style.css_class, title, style.glyph);
}

std::string timeline_table(const Timeline& timeline, std::span<const int> views, const ModelLibrary& library) {
  std::string html = "<table class=\"history\"><thead><tr><th class=\"name\">Object</th>";
  for (const int view : views) html += fmt::format("<th>{}</th>", view);
  html += "</tr></thead><tbody>\n";
  for (const auto& [track, row] : timeline.rows) {
    html += fmt::format("<tr><th class=\"name\">{} <span class=\"soft\">#{}</span></th>",
                        object_tag(row.object, library), track);
    for (const int view : views) {
      const auto event = row.events.find(view);
      html += "<td>";
      if (event != row.events.end()) {
        html += cell(style_of_event(event->second), fmt::format("view {}: {}", view, to_string(event->second)));
      } else {
        html += "<span class=\"cell none\"></span>";
      }
      html += "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table>";
}

std::string legend() {
  const std::pair<ObjectEventKind, const char*> entries[] = {{ObjectEventKind::kFound, "first recognised"},
                                                             {ObjectEventKind::kStillThere, "still there"},
                                                             {ObjectEventKind::kAdded, "added"},
                                                             {ObjectEventKind::kMoved, "moved"},
                                                             {ObjectEventKind::kRemoved, "removed"},
                                                             {ObjectEventKind::kNotSeen, "not seen"}};
  std::string html = "<p class=\"soft legend\">";
  for (const auto& [kind, text] : entries) html += "<span>" + cell(style_of_event(kind), text) + text + "</span>";
  return html + "</p>\n";
}

std::string timeline_card(const ReportRun& run, const Timeline& timeline, std::span<const int> views,
                          const ModelLibrary& library) {
  return "<section class=\"card\" style=\"margin-bottom:12px\"><h3>" + escape(run.preset) + "</h3>\n" +
         timeline_table(timeline, views, library) + "</section>\n";
}

std::vector<int> views_in(const ReportRun& run, const ViewRange& range) {
  std::vector<int> views;
  for (const ViewRecord& view : run.views)
    if (range.contains(view.update.view)) views.push_back(view.update.view);
  return views;
}

std::vector<int> views_with_news(const ReportRun& run) {
  std::set<int> views;  // At which it happened. It may have been reported later.
  for (const ViewRecord& view : run.views)
    for (const ObjectEvent& event : view.update.events)
      if (is_news(event.kind)) views.insert(event.view);
  return {views.begin(), views.end()};
}

}  // namespace

std::string history_section(std::span<const ReportRun> runs, const ModelLibrary& library, const ViewRange& range) {
  std::string tables;
  for (const ReportRun& run : runs) {
    const std::vector<int> views = views_in(run, range);
    const Timeline timeline = make_timeline(run, views);
    if (!timeline.rows.empty()) tables += timeline_card(run, timeline, views, library);
  }
  if (tables.empty()) return "";
  return "<h2 id=\"history\">Object history</h2>\n" + legend() + tables;
}

std::string changes_section(std::span<const ReportRun> runs, const ModelLibrary& library) {
  std::string tables;
  for (const ReportRun& run : runs) {
    std::vector<int> views = views_with_news(run);
    const std::size_t num_views = views.size();
    if (num_views == 0) continue;
    views.resize(std::min<std::size_t>(num_views, kViewsPerPage));
    Timeline timeline = make_timeline(run, views);
    keep_news(timeline);
    if (views.size() < num_views)
      tables += fmt::format("<p class=\"soft\">The first {} of {} views in which an object was found or changed.</p>\n",
                            views.size(), num_views);
    tables += timeline_card(run, timeline, views, library);
  }
  if (tables.empty()) return "";
  return "<h2 id=\"history\">Changes of objects</h2>\n" + legend() + tables;
}

}  // namespace resight::report
