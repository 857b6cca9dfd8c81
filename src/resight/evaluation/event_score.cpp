// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/event_score.hpp"

#include <algorithm>
#include <cmath>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// The centre of the place is in the image, and what the camera measures there is not clearly in front of the object.
bool looks_at(const RgbdFrame& frame, const Rigid3& world_from_object, const ObjectModel& model) {
  const Eigen::Vector3d center = world_from_object * model.center.cast<double>().eval();
  const Eigen::Vector3d p = frame.world_from_camera.inverse() * center;
  if (p.z() <= 0) return false;
  const Eigen::Vector2d pixel = frame.camera.project(p);
  if (!frame.camera.contains(pixel)) return false;
  const float depth = frame.depth_m(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  return depth >= p.z() - 0.5 * model.diameter_m;  // false for NaN
}

// One side of a change: a departure or an arrival.
struct Half {
  int view = 0;
  std::string object;
  Rigid3 world_from_object;
  bool known_by_sight = true;
};

class Matcher {
 public:
  Matcher(const ModelLibrary& library, const MatchDetectionsOptions& options) : library_(library), options_(options) {}

  [[nodiscard]] bool same_place(const std::string& object, const std::optional<Rigid3>& a,
                                const std::optional<Rigid3>& b) const {
    if (a.has_value() != b.has_value()) return false;
    const ObjectModel& model = library_.objects[static_cast<std::size_t>(library_.find(object))];
    return !a || is_within(compare_poses(*a, *b, model), options_);
  }

  [[nodiscard]] bool same_change(const TrueChange& t, const ReportedChange& r) const {
    return t.object == r.object && t.kind == r.kind &&
           same_place(t.object, t.world_from_object_before, r.world_from_object_before) &&
           same_place(t.object, t.world_from_object_after, r.world_from_object_after);
  }

  // Each report takes the earliest true one that fits; calls hit(true, report) for each pair that counts.
  template <typename Truth, typename Report, typename Fits, typename Counts, typename Hit>
  static RecognitionScore match(const std::vector<Truth>& truths, const std::vector<Report>& reports, Fits&& fits,
                                Counts&& counts, Hit&& hit) {
    RecognitionScore score;
    std::vector<char> used(truths.size(), 0);
    for (const Report& report : reports) {
      std::size_t t = 0;
      while (t < truths.size() && (used[t] || truths[t].view > report.view || !fits(truths[t], report))) ++t;
      if (t == truths.size()) {
        ++score.false_positives;
        continue;
      }
      used[t] = 1;
      if (!counts(truths[t])) continue;
      ++score.true_positives;
      hit(truths[t], report);
    }
    for (std::size_t t = 0; t < truths.size(); ++t) score.false_negatives += !used[t] && counts(truths[t]) ? 1 : 0;
    return score;
  }

  [[nodiscard]] RecognitionScore match_halves(const std::vector<Half>& truths, const std::vector<Half>& reports) const {
    return match(
        truths, reports,
        [this](const Half& t, const Half& r) {
          return t.object == r.object && same_place(t.object, t.world_from_object, r.world_from_object);
        },
        [](const Half& t) { return t.known_by_sight; }, [](const Half&, const Half&) {});
  }

 private:
  const ModelLibrary& library_;
  const MatchDetectionsOptions& options_;
};

// A change, and what the views show of it.
struct TrueEvent : TrueChange {
  ChangeSight sight;
  [[nodiscard]] bool shows_departure() const {
    return world_from_object_before && sight.was_seen && sight.before_view >= 0;
  }
  // What comes where no view looked before may have been there.
  [[nodiscard]] bool shows_arrival() const {
    return world_from_object_after && sight.after_view >= 0 && (sight.place_was_seen || shows_departure());
  }
  [[nodiscard]] bool counts() const { return shows_departure() || shows_arrival(); }
  // Of a move only one side; other changes as they are.
  [[nodiscard]] TrueChange departure() const {
    TrueChange side = *this;
    if (kind != ObjectEventKind::kMoved) return side;
    side.kind = ObjectEventKind::kRemoved;
    side.world_from_object_after.reset();
    return side;
  }
  [[nodiscard]] TrueChange arrival() const {
    TrueChange side = *this;
    if (kind != ObjectEventKind::kMoved) return side;
    side.kind = ObjectEventKind::kAdded;
    side.world_from_object_before.reset();
    return side;
  }
  [[nodiscard]] int known_since() const {
    return std::max(shows_departure() ? sight.before_view : -1, shows_arrival() ? sight.after_view : -1);
  }
};

}  // namespace

ChangeSightFinder::ChangeSightFinder(const ModelLibrary& library, const SequenceTruth& truth,
                                     const MatchDetectionsOptions& options)
    : library_(library), truth_(truth), options_(options) {
  require(truth.changes.has_value(), "ChangeSightFinder: the truth holds no changes");
  sights_.resize(truth.changes->size(), {-1, -1, false, false});
  for (const TrueChange& change : *truth.changes) stands_since_.push_back(find_arrival_before(change));
}

void ChangeSightFinder::add_view(const RgbdFrame& frame) {
  for (std::size_t i = 0; i < sights_.size(); ++i) {
    const TrueChange& change = (*truth_.changes)[i];
    const int object = library_.find(change.object);
    if (object < 0 || !change.known) continue;
    const ObjectModel& model = library_.objects[static_cast<std::size_t>(object)];
    const std::optional<Rigid3>& before = change.world_from_object_before;
    const std::optional<Rigid3>& after = change.world_from_object_after;
    ChangeSight& sight = sights_[i];
    if (change.view > view_) {
      sight.was_seen =
          sight.was_seen || (before && view_ >= stands_since_[i] && shows(frame, change.object, *before, model));
      sight.place_was_seen = sight.place_was_seen || (after && looks_at(frame, *after, model));
      continue;
    }
    if (before && sight.before_view < 0 && looks_at(frame, *before, model)) sight.before_view = view_;
    if (after && sight.after_view < 0 && shows(frame, change.object, *after, model)) sight.after_view = view_;
  }
  ++view_;
}

// The last change that brought the object to where it leaves; 0 if it was there from the first view on.
int ChangeSightFinder::find_arrival_before(const TrueChange& change) const {
  const int object = library_.find(change.object);
  if (object < 0 || !change.world_from_object_before) return 0;
  const ObjectModel& model = library_.objects[static_cast<std::size_t>(object)];
  int since = 0;
  for (const TrueChange& other : *truth_.changes)
    if (other.object == change.object && other.view < change.view && other.world_from_object_after &&
        is_within(compare_poses(*other.world_from_object_after, *change.world_from_object_before, model), options_))
      since = std::max(since, other.view);
  return since;
}

bool ChangeSightFinder::shows(const RgbdFrame& frame, const std::string& object, const Rigid3& world_from_object,
                              const ObjectModel& model) const {
  const std::vector<GroundTruthObject>& objects = truth_.views.at(static_cast<std::size_t>(view_)).objects;
  return std::ranges::any_of(objects, [&](const GroundTruthObject& truth) {
    return truth.object == object && !(truth.visible_share < options_.min_visible_share) &&
           is_within(compare_poses(frame.world_from_camera * truth.camera_from_object, world_from_object, model),
                     options_);
  });
}

EventScore& EventScore::operator+=(const EventScore& other) {
  events += other.events;
  departures += other.departures;
  arrivals += other.arrivals;
  delays.insert(delays.end(), other.delays.begin(), other.delays.end());
  return *this;
}

EventScore score_events(std::span<const TrueChange> changes, std::span<const ChangeSight> sights,
                        std::span<const ReportedChange> reported, const ModelLibrary& library,
                        const MatchDetectionsOptions& options) {
  require(changes.size() == sights.size(), "score_events: one sight a change is needed");
  std::vector<TrueEvent> truths;
  std::vector<Half> true_departures, true_arrivals, departures, arrivals;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const TrueChange& c = changes[i];
    if (!c.known || library.find(c.object) < 0) continue;
    truths.push_back({c, sights[i]});
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
  const Matcher matcher(library, options);
  EventScore score;
  score.events = Matcher::match(
      truths, events,
      [&](const TrueEvent& t, const ReportedChange& r) {
        return matcher.same_change(t, r) || (!t.shows_arrival() && matcher.same_change(t.departure(), r)) ||
               (!t.shows_departure() && matcher.same_change(t.arrival(), r));
      },
      [](const TrueEvent& t) { return t.counts(); },
      [&](const TrueEvent& t, const ReportedChange& r) {
        score.delays.push_back(std::max(0, r.view - t.known_since()));
      });
  score.departures = matcher.match_halves(true_departures, departures);
  score.arrivals = matcher.match_halves(true_arrivals, arrivals);
  return score;
}

}  // namespace resight
