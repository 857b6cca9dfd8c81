// SPDX-License-Identifier: Apache-2.0
// Recognises objects and reports what happened to them. Usage: 02_recognize MODELS SEQUENCE. MODELS is written by
// `resight train`; SEQUENCE is a folder of views (`resight demo` creates both).
#include <cstdio>

#include "resight/core/allocator.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/scene_recognizer.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s MODELS SEQUENCE\n", argv[0]);
    return 2;
  }
  resight::keep_freed_memory();  // Every view needs as much memory again; saves a tenth of the time.
  const auto library = resight::load_library(argv[1]);
  const auto sequence = resight::open_posed_sequence(argv[2]);
  if (!library.ok() || !sequence.ok()) {
    std::fprintf(stderr, "%s\n", (library.ok() ? sequence.error() : library.error()).message.c_str());
    return 2;
  }

  resight::SceneRecognizer recognizer(*library, resight::RecognizerConfig::from_preset("default"));
  for (int view = 0; view < (*sequence)->num_views(); ++view) {
    auto frame = (*sequence)->read_view(view);
    if (!frame.ok()) {
      std::fprintf(stderr, "%s\n", frame.error().message.c_str());
      return 2;
    }
    const resight::SceneUpdate update = recognizer.add_view(*std::move(frame));
    std::printf("%s\n", update.view_name.c_str());
    for (const resight::Detection& detection : update.detections) {
      const Eigen::Vector3d p = detection.world_from_object.translation;
      std::printf("  %-24s at (%.3f %.3f %.3f) m, score %.2f\n",
                  library->objects[static_cast<std::size_t>(detection.object)].name.c_str(), p.x(), p.y(), p.z(),
                  detection.score);
    }
    for (const resight::ObjectEvent& event : update.events) {
      if (!resight::is_change(event.kind)) continue;
      std::printf("  %s: %s\n", resight::to_string(event.kind).c_str(),
                  library->objects[static_cast<std::size_t>(event.object)].name.c_str());
    }
  }
  return 0;
}
