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

struct TrueEvent : TrueChange {
  ChangeSight sight;
  [[nodiscard]] bool counts() const {
    return (!world_from_object_before || sight.before_view >= 0) && (!world_from_object_after || sight.after_view >= 0);
  }
  [[nodiscard]] int known_since() const { return std::max(sight.before_view, sight.after_view); }
};

}  // namespace

ChangeSightFinder::ChangeSightFinder(const ModelLibrary& library, const SequenceTruth& truth,
                                     const MatchDetectionsOptions& options)
    : library_(library), truth_(truth), options_(options) {
  require(truth.changes.has_value(), "ChangeSightFinder: the truth holds no changes");
  sights_.resize(truth.changes->size());
}

void ChangeSightFinder::add_view(const RgbdFrame& frame) {
  for (std::size_t i = 0; i < sights_.size(); ++i) {
    const TrueChange& change = (*truth_.changes)[i];
    const int object = library_.find(change.object);
    if (object < 0 || !change.known || change.view > view_) continue;
    const ObjectModel& model = library_.objects[static_cast<std::size_t>(object)];
    ChangeSight& sight = sights_[i];
    if (change.world_from_object_before && sight.before_view < 0 &&
        looks_at(frame, *change.world_from_object_before, model))
      sight.before_view = view_;
    if (!change.world_from_object_after || sight.after_view >= 0) continue;
    for (const GroundTruthObject& truth : truth_.views.at(static_cast<std::size_t>(view_)).objects)
      if (truth.object == change.object && !(truth.visible_share < options_.min_visible_share) &&
          is_within(
              compare_poses(frame.world_from_camera * truth.camera_from_object, *change.world_from_object_after, model),
              options_))
        sight.after_view = view_;
  }
  ++view_;
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
      true_departures.push_back({c.view, c.object, *c.world_from_object_before, sights[i].before_view >= 0});
    if (c.world_from_object_after)
      true_arrivals.push_back({c.view, c.object, *c.world_from_object_after, sights[i].after_view >= 0});
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
        return t.object == r.object && t.kind == r.kind &&
               matcher.same_place(t.object, t.world_from_object_before, r.world_from_object_before) &&
               matcher.same_place(t.object, t.world_from_object_after, r.world_from_object_after);
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
