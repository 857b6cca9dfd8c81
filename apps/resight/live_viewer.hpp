// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "resight/report/view_record.hpp"
#include "resight/sensor/sequence.hpp"
#include "resight/viewer/scene_data.hpp"
#include "viewer_session.hpp"

namespace resight::app {

/// Shows views in a browser as they are recognised. Sequence and library must outlive it.
class LiveViewer {
 public:
  /// `trace`: the file that the run writes; none: it is not traced. Prints the address.
  LiveViewer(const Sequence& sequence, const ModelLibrary& library, const std::string& title, const std::string& preset,
             std::optional<TraceFile> trace);
  ~LiveViewer();
  LiveViewer(const LiveViewer&) = delete;
  LiveViewer& operator=(const LiveViewer&) = delete;

  void add_view(const ViewRecord& view);
  /// Shows the final events and the trace, if there is one, and serves on until the process is interrupted.
  void finish(const ReportRun& run, std::optional<TraceFile> trace);

 private:
  void stop();
  void tell_revision();
  const ModelLibrary& library_;
  std::unique_ptr<SceneData> scene_;
  ViewerSession session_;
  std::thread thread_;
};

}  // namespace resight::app
