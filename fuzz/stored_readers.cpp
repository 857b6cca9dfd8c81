// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "reader.hpp"
#include "resight/annotation/annotation_project.hpp"
#include "resight/annotation/proposals_file.hpp"
#include "resight/cameras/track_journal.hpp"
#include "resight/evaluation/evaluated_run.hpp"
#include "resight/io/event_file.hpp"
#include "resight/io/recognition_results.hpp"
#include "resight/io/settings_file.hpp"
#include "resight/io/trace_file.hpp"
#include "resight/models/internal/library_payload.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/recognizer_config.hpp"
#include "resight/simulation/scene_script.hpp"

/// What resight itself writes, and settings.
namespace resight::fuzz {
namespace {

namespace fs = std::filesystem;
using Seeds = std::vector<std::string>;

Seeds make_settings_seeds() {
  return {
      "num_previous_views = 3\nremember_objects = true\n[run]\ndeadline_ms = 500.5\n[search]\nmax_new_share = "
      "\"off\"\n",
      "[verify]\n[hypotheses]\nmerge = {}\n", "a.b.c = [1, 2.5e3, true, 1979-05-27, '''x''']\n[[t]]\n"};
}
void read_config(std::string_view bytes) {
  (void)read_settings(write_scratch("settings.toml", bytes), RecognizerConfig::from_preset("default"));
}

Seeds make_script_seeds() {
  Seeds seeds;
  for (const char* name : {"breakfast", "realistic", "stacked_office", "watched_table"})
    seeds.push_back(source_file("examples/scenes/" + std::string(name) + ".toml"));
  return seeds;
}
void read_script(std::string_view bytes) {
  const auto script = read_scene_script(write_scratch("scene.toml", bytes));
  if (script) (void)check_script(*script);
}

CodedFeatures make_features(FeatureType type, int dimension) {
  CodedFeatures features;
  features.type = type;
  features.dimension = dimension;
  features.points = {{0.01F, 0, 0}};
  features.normals = {{0, 0, 1}};
  features.codes.assign(static_cast<std::size_t>(dimension), 200);
  return features;
}

ModelLibrary make_library() {
  ObjectModel object;
  object.name = "cup";
  object.bop_id = 3;
  object.surface.points = {{0, 0, 0}, {0.05F, 0, 0}, {0, 0.05F, 0}};
  object.surface.normals.assign(3, {0, 0, 1});
  object.surface.colors.assign(3, {10, 20, 30});
  object.sift = make_features(FeatureType::kSift, 128);
  object.shot = make_features(FeatureType::kShot, 352);
  object.symmetries.continuous.push_back({.direction = {0, 0, 1}, .point = {0, 0, 0}});
  object.symmetries.discrete.push_back(Rigid3::from_axis_angle({0, 0, 1}, 3.14159));
  object.diameter_m = 0.07F;
  return {.objects = {object}, .options_hash = 7, .surface_voxel_m = 0.003F};
}

Seeds make_payload_seeds() {
  const auto payload = internal::encode_payload(make_library());
  return {std::string(payload->begin(), payload->end())};
}
void read_payload(std::string_view bytes) {
  // FlatBuffers are aligned in a file; a copy is, too.
  const std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
  (void)internal::decode_payload(copy);
}

Seeds make_library_seeds() {
  return {bytes_written_by("library", [](const fs::path& file) { (void)save_library(make_library(), file); })};
}

EvaluatedRun make_run() {
  EvaluatedRun run;
  run.sequence = "scene";
  run.preset = "default";
  run.fingerprint = "0123";
  EvaluatedView view;
  view.name = "000000";
  view.truth.push_back({.object = "cup",
                        .instance = 0,
                        .visible_share = 0.5,
                        .distance_m = 1,
                        .counts = true,
                        .found = true,
                        .found_strictly = false,
                        .center_error_m = 0.01,
                        .rotation_error_rad = 0.1,
                        .lost_at = ""});
  view.detections.push_back(
      {.object = "cup", .camera_from_object = {}, .score = 0.5, .verdict = DetectionVerdict::kCorrect});
  run.views.push_back(view);
  return run;
}

constexpr const char* kJournalHead = R"({"format":"resight track journal 1","job":"fuzz"})";
Seeds make_track_journal_seeds() {
  return {bytes_written_by("seed.journal",
                           [](const fs::path& file) {
                             auto journal = TrackJournal::open(file, "fuzz");
                             TrackerStep step;
                             step.view.name = "000000";
                             (void)journal->append(step);
                             step.edges.push_back({.a = 0, .b = 1, .a_from_b = {}});
                             (void)journal->append(step);
                           }),
          kJournalHead};
}

constexpr AnnotationLimits kLimits{.num_views = 4, .num_objects = 2};

/// Of a project that has seen each kind of change.
Seeds make_journal_seeds() {
  const fs::path folder = scratch_folder() / "seed";
  {
    const auto project = AnnotationProject::open(folder, kLimits, "fuzz");
    const auto act = [&](AnnotationAction action) { (void)(*project)->act(std::move(action), (*project)->revision()); };
    AnnotatedObject object;
    object.object = 1;
    object.last_view = 2;
    act(AnnotationEdit{.title = "put", .changes = {PutObject{object}}});
    const RegionJudgement judgement{.region = {.view = 1, .kind = RegionKind::kNovel, .center_in_world_m = {1, 2, 3}},
                                    .verdict = RegionVerdict::kAccepted,
                                    .track = 0,
                                    .mask = PixelRuns{{3, 4}, {9, 1}}};
    act(AnnotationEdit{.title = "judge", .changes = {JudgeRegion{judgement}, CheckView{1, true}}});
    UnknownObjectEvent event;
    event.view = 1;
    event.name = "box";
    event.after_in_world_m = Eigen::Vector3d(1, 2, 3);
    act(AnnotationEdit{.title = "event", .changes = {PutUnknownEvent{event}}});
    act(UndoEdit{});
    act(RedoEdit{});
    act(AnnotationEdit{.title = "drop", .changes = {DropObject{0}}});
  }
  const auto copy = [&](const fs::path& file) { fs::copy_file(folder / "annotation.jsonl", file); };
  const std::string journal = bytes_written_by("seed.jsonl", copy);
  fs::remove_all(folder);
  return {journal, journal.substr(0, journal.size() - 5)};
}
void read_annotation(std::string_view bytes) {
  const fs::path folder = scratch_folder() / "project";
  fs::create_directories(folder);
  write_scratch("project/annotation.jsonl", bytes);
  (void)AnnotationProject::open(folder, kLimits, "fuzz");
  (void)parse_action(bytes);
}

Seeds make_proposal_seeds() {
  ChangeProposal region;
  region.view = 1;
  region.kind = RegionKind::kRemoved;
  region.points_in_world = {{0.5F, 0.25F, 1}, {0.5F, 0.25F, 2}};
  region.num_points = 31;
  region.box.size_m = {0.1, 0.2, 0.3};
  region.pixels = {{3, 4}, {9, 1}};
  return {bytes_written_by("proposals.json", [&](const fs::path& file) {
    (void)write_proposals(file, "fuzz", {region, region});
  })};
}

constexpr std::array kResultFiles = {"detections.json", "changes.json", "summary.json"};
Seeds make_result_seeds() {
  const std::string pose = R"({"rotation":[1,0,0,0,1,0,0,0,1],"translation_m":[0,0,1]})";
  const std::array<std::string, 3> files = {
      R"({"version":"0.2.0","preset":"default","views":[{"view":0,"name":"000000","world_from_camera":)" + pose +
          R"(,"detections":[{"object":"cup","obj_id":1,"track":0,"score":0.9,"fit":0.8,"visible_share":null,)" +
          R"("world_from_object":)" + pose +
          R"(,"uncertainty":null,"verdict":"correct","evidence":[{"view":0,"allowed":true,"visible_share":1,)" +
          R"("explained_share":0.5,"color_share":0.25}]}]}]})",
      R"({"events":[{"view":0,"kind":"moved","object":"cup","track":0,"world_from_object_before":)" + pose +
          R"(,"world_from_object_after":)" + pose +
          R"(,"confidence":0.5}],"views":[{"name":"000000","novel_points":3,"removed_points":4,)" +
          R"("changed_share":0.125,"pose_suspect":false}]})",
      R"({"inputs":{"sequence":"../scene","models":"../models.bin"}})"};
  return {join_files(files)};
}

constexpr const char* kTraceHead = "{\"format\":\"resight trace 2\"}\n";
Seeds make_trace_seeds() {
  const std::string pose = R"({"rotation":[1,0,0,0,1,0,0,0,1],"translation_m":[0,0,1]})";
  const std::string hypothesis =
      R"({"object":"cup","verdict":"no support","origin_views":[0],"correspondences":7,"start":)" + pose +
      R"(,"world_from_object":)" + pose + R"(,"test":{"quantity":"explained share","value":0.5,"limit":0.7},)" +
      R"("suppressed_by":null,"score":0.6,"fit":0.5,"visible_share":0.4,"explained_share":0.5,"pattern_similarity":0.1,)" +
      R"("newest_similarity":1,"shared_texture":0,"texture_contrast":3,"explained_scene":9,"outlier":3,"clutter":0,)" +
      R"("plane":0,"views":[{"view":0,"visible_share":0.4,"explained_share":null}]})";
  const std::string loss = R"({"object":"cup","world_from_object":)" + pose +
                           R"(,"visible_share":1,"stage":"rejected","keypoints":9,"correspondences":8,)" +
                           R"("right_correspondences":7,"center_error_m":0.01,"rotation_error_rad":null,)" +
                           R"("hypothesis":0})";
  return {kTraceHead + std::string(R"({"view":0,"name":"000000","searched":true,"generated":3,"merged":2,)") +
          R"("clustered":1,"verified":1,"hypotheses":[)" + hypothesis + R"(],"lost":[)" + loss + "]}\n"};
}
void read_trace_file(std::string_view bytes) {
  const auto trace = TraceFile::open(write_scratch("trace.jsonl", bytes), 1);
  if (trace) (void)trace->read(0, "000000");
}

Seeds make_event_seeds() {
  const std::string pose = "[1,0,0,0,0,1,0,0,0,0,1,1,0,0,0,1]";
  return {R"({"events":[{"view":2,"kind":"moved","object":"cup","known":true,"world_from_object_before":)" + pose +
              R"(,"world_from_object_after":)" + pose + R"(},{"view":3,"kind":"added","object":"box","known":false,)" +
              R"("world_from_object_before":null,"world_from_object_after":)" + pose + "}]}",
          R"({"events":[[2,"moved","cup"],[3,"added","box"]]})"};
}

}  // namespace

std::vector<FuzzReader> stored_readers() {
  return {
      {"settings", make_settings_seeds, read_config, 1000},
      {"scene_script", make_script_seeds, read_script, 500},
      {"library_payload", make_payload_seeds, read_payload},
      {"library_file", make_library_seeds,
       [](std::string_view bytes) { (void)load_library(write_scratch("library", bytes)); }},
      {"evaluated_run", [] { return Seeds{format_run(make_run())}; },
       [](std::string_view bytes) { (void)parse_run(bytes, "fuzz"); }, 2000},
      {"track_journal", make_track_journal_seeds,
       [](std::string_view bytes) { (void)TrackJournal::open(write_scratch("track.partial", bytes), "fuzz"); }},
      {"annotation", make_journal_seeds, read_annotation, 1000},
      {"proposals", make_proposal_seeds,
       [](std::string_view bytes) { (void)read_proposals(write_scratch("proposals.json", bytes), "fuzz", 4); }, 2000},
      {"results", make_result_seeds,
       [](std::string_view bytes) { (void)read_recognition_results(write_bundle(bytes, kResultFiles)); }, 2000},
      {"trace", make_trace_seeds, read_trace_file, 2000},
      {"events", make_event_seeds,
       [](std::string_view bytes) { (void)read_event_file(write_scratch("events.json", bytes), 4); }, 2000},
  };
}

}  // namespace resight::fuzz
