// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/viewer/byte_cache.hpp"
#include "resight/viewer/object_table.hpp"
#include "resight/viewer/viewer_scene.hpp"

namespace resight {

/// Makes the contents that the browser asks for, each when it is first needed. Keeps the latest within a bounded
/// memory. All functions may be called from several threads.
class SceneData {
 public:
  using Content = Result<std::shared_ptr<const std::string>>;

  /// Fails if results name views that the sequence does not have.
  [[nodiscard]] static Result<std::unique_ptr<SceneData>> create(ViewerScene scene);

  [[nodiscard]] int num_views() const;
  [[nodiscard]] int num_objects() const;
  [[nodiscard]] int num_runs() const;
  [[nodiscard]] bool has_changes() const;

  // Numbers must be in range.
  [[nodiscard]] Content index();                   ///< JSON: views, objects, detections and events of all runs.
  [[nodiscard]] Content view(int view, int run);   ///< JSON: camera, outlines and details; `run` -1: without results.
  [[nodiscard]] Content color(int view);           ///< JPEG.
  [[nodiscard]] Content depth(int view);           ///< encode_depth()
  [[nodiscard]] Content trace(int view, int run);  ///< JSON: hypotheses and lost objects; empty lists without a trace.
  [[nodiscard]] Content surface(int object);       ///< encode_cloud()
  [[nodiscard]] Content changes(int view);         ///< encode_cloud(): reconstruction, removed and novel points.
  /// Counts the changes of the index, so that a client need not fetch it in vain.
  [[nodiscard]] int revision() const;

  /// Adds a view to the only run, while views are being recognised. If the run has a trace, the line of the view must
  /// have been written; fails if it cannot be read.
  [[nodiscard]] Result<void> add_view(StoredView view, std::vector<StoredEvent> events);
  /// Replaces the events by the final ones: no view follows. Adds the trace of the run, if there is one.
  void finish(std::vector<StoredEvent> events, std::optional<TraceFile> trace = std::nullopt);

 private:
  explicit SceneData(ViewerScene scene);
  using Frame = std::shared_ptr<const RgbdFrame>;
  [[nodiscard]] Result<void> match_views();
  [[nodiscard]] Result<Frame> frame(int view);
  [[nodiscard]] Result<PointCloud> read_surface(int object) const;
  template <typename Make>
  Content cached(const std::string& key, const Make& make);

  mutable std::mutex mutex_;
  ViewerScene scene_;
  ObjectTable objects_;
  std::vector<std::vector<int>> stored_views_;  ///< Per run and view of the sequence: its number in the results, or -1.
  ByteCache cache_;
  std::deque<std::pair<int, Frame>> frames_;  ///< Those that were used last.
  int revision_ = 0;
};

}  // namespace resight
