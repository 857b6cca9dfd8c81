// SPDX-License-Identifier: Apache-2.0
// Recognises objects and reports what happened to them. Usage: 02_recognize MODELS SEQUENCE. MODELS is written by
// `resight train`; SEQUENCE is a folder of views (`resight demo` creates both).
#include <cstdio>
#include <vector>

#include "resight/core/allocator.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/recognize_sequence.hpp"

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
  const auto name_of = [&](int object) { return library->objects[static_cast<std::size_t>(object)].name.c_str(); };
  const auto print_view = [&](const resight::RgbdFrame&, const resight::SceneUpdate& update) {
    std::printf("%s\n", update.view_name.c_str());
    for (const resight::Detection& detection : update.detections) {
      const Eigen::Vector3d p = detection.world_from_object.translation;
      std::printf("  %-24s at (%.3f %.3f %.3f) m, score %.2f\n", name_of(detection.object), p.x(), p.y(), p.z(),
                  detection.score);
    }
  };
  const auto events = resight::recognize_sequence(recognizer, **sequence, print_view);
  if (!events.ok()) {
    std::fprintf(stderr, "%s\n", events.error().message.c_str());
    return 2;
  }
  for (const std::vector<resight::ObjectEvent>& events_of_view : *events) {
    for (const resight::ObjectEvent& event : events_of_view) {
      if (!resight::is_change(event.kind)) continue;
      std::printf("view %d: %s %s\n", event.view, resight::to_string(event.kind).c_str(), name_of(event.object));
    }
  }
  return 0;
}
