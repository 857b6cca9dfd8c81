// SPDX-License-Identifier: Apache-2.0
#include "live_viewer.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <utility>

#include "commands.hpp"
#include "resight/report/stored_view.hpp"

namespace resight::app {
namespace {

/// A pointer to something that others keep.
template <typename T>
std::shared_ptr<const T> borrow(const T& value) {
  return {std::shared_ptr<const T>(), &value};
}

ViewerScene make_live_scene(const Sequence& sequence, const ModelLibrary& library, const std::string& title,
                            const std::string& preset, std::optional<TraceFile> trace) {
  ViewerScene scene;
  scene.title = title;
  scene.sequence = borrow(sequence);
  scene.library = borrow(library);
  scene.runs.push_back({preset, {}});
  scene.runs.front().results.preset = preset;
  scene.runs.front().results.trace = std::move(trace);
  scene.runs.front().results.version = RESIGHT_VERSION;
  scene.is_live = true;
  return scene;
}

}  // namespace

LiveViewer::LiveViewer(const Sequence& sequence, const ModelLibrary& library, const std::string& title,
                       const std::string& preset, std::optional<TraceFile> trace)
    : library_(library),
      scene_(value_or_throw(SceneData::create(make_live_scene(sequence, library, title, preset, std::move(trace))))),
      session_(*scene_, {.port = 0, .no_open = false}) {
  session_.open();
  thread_ = std::thread([this] { session_.server().run(); });
}

LiveViewer::~LiveViewer() { stop(); }

void LiveViewer::stop() {
  if (!thread_.joinable()) return;
  session_.server().stop();
  thread_.join();
}

void LiveViewer::add_view(const ViewRecord& view) {
  value_or_throw(scene_->add_view(to_stored_view(view, library_), to_stored_events(view, library_)));
  tell_revision();
}

void LiveViewer::tell_revision() { session_.server().send_event(std::to_string(scene_->revision())); }

void LiveViewer::finish(const ReportRun& run, std::optional<TraceFile> trace) {
  std::vector<StoredEvent> events;
  for (const ViewRecord& view : run.views)
    std::ranges::move(to_stored_events(view, library_), std::back_inserter(events));
  scene_->finish(std::move(events), std::move(trace));
  tell_revision();
  stop();
  session_.server().catch_interrupts();
  std::fflush(stdout);  // a program that waits for the results may read it through a pipe
  session_.server().run_until_interrupted();
}

}  // namespace resight::app
