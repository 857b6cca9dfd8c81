// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/event_score.hpp"

#include <algorithm>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// One side of a change: a departure or an arrival.
struct Half {
  int view = 0;
  std::string object;
  Rigid3 world_from_object;
  bool is_observed = true;
};

// Uncounted truths are neither hit nor miss, and reports of them are ignored. Calls hit(truth, report) for each counted
// pair.
template <typename Truth, typename Report, typename Fits, typename Counts, typename Hit>
RecognitionScore score_matches(const std::vector<Truth>& truths, const std::vector<Report>& reports, Fits&& fits,
                               Counts&& counts, Hit&& hit) {
  RecognitionScore score;
  std::vector<char> used(truths.size(), 0);
  const std::vector<int> truth_of = match_in_order(truths, reports, fits, counts);
  for (std::size_t r = 0; r < reports.size(); ++r) {
    if (truth_of[r] < 0) {
      ++score.false_positives;
      continue;
    }
    const auto t = static_cast<std::size_t>(truth_of[r]);
    used[t] = 1;
    if (!counts(truths[t])) continue;
    ++score.true_positives;
    hit(truths[t], reports[r]);
  }
  for (std::size_t t = 0; t < truths.size(); ++t) score.false_negatives += !used[t] && counts(truths[t]) ? 1 : 0;
  return score;
}

RecognitionScore score_halves(const std::vector<Half>& truths, const std::vector<Half>& reports,
                              const ChangeMatcher& matcher) {
  return score_matches(
      truths, reports,
      [&](const Half& t, const Half& r) {
        return t.object == r.object && matcher.same_place(t.object, t.world_from_object, r.world_from_object);
      },
      [](const Half& t) { return t.is_observed; }, [](const Half&, const Half&) {});
}

}  // namespace

EventScore& EventScore::operator+=(const EventScore& other) {
  events += other.events;
  departures += other.departures;
  arrivals += other.arrivals;
  delays.insert(delays.end(), other.delays.begin(), other.delays.end());
  return *this;
}

EventScore score_events(std::span<const TrueChange> changes, std::span<const ChangeVisibility> visibilities,
                        std::span<const ReportedChange> reported, const ModelLibrary& library,
                        const MatchDetectionsOptions& options) {
  require(changes.size() == visibilities.size(), "score_events: visibilities must have one entry per change");
  std::vector<SeenChange> truths;
  std::vector<Half> true_departures, true_arrivals, departures, arrivals;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const TrueChange& c = changes[i];
    if (!c.known || library.find(c.object) < 0) continue;
    truths.push_back({c, visibilities[i]});
    if (c.world_from_object_before)
      true_departures.push_back({c.view, c.object, *c.world_from_object_before, truths.back().shows_departure()});
    if (c.world_from_object_after)
      true_arrivals.push_back({c.view, c.object, *c.world_from_object_after, truths.back().shows_arrival()});
  }
  std::vector<ReportedChange> events;
  for (const ReportedChange& r : reported) {
    if (!is_change(r.kind)) continue;
    require(library.find(r.object) >= 0, "score_events: no object '" + r.object + "' in the library");
    events.push_back(r);
  }
  std::ranges::stable_sort(events, {}, &ReportedChange::view);
  for (const ReportedChange& r : events) {
    if (r.world_from_object_before) departures.push_back({r.view, r.object, *r.world_from_object_before, true});
    if (r.world_from_object_after) arrivals.push_back({r.view, r.object, *r.world_from_object_after, true});
  }
  std::ranges::stable_sort(truths, {}, &SeenChange::view);
  const ChangeMatcher matcher(library, options);
  EventScore score;
  score.events = score_matches(
      reconcile_with_reports(truths, events, matcher), events,
      [&](const SeenChange& t, const ReportedChange& r) { return matcher.fits(t, r); },
      [](const SeenChange& t) { return t.counts(); },
      [&](const SeenChange& t, const ReportedChange& r) {
        score.delays.push_back(std::max(0, std::max(r.view, r.reported_view) - t.known_since()));
      });
  score.departures = score_halves(true_departures, departures, matcher);
  score.arrivals = score_halves(true_arrivals, arrivals, matcher);
  return score;
}

}  // namespace resight
