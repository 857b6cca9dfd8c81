// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/export_annotation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "resight/annotation/internal/region_files.hpp"
#include "resight/annotation/internal/truth_files.hpp"
#include "resight/core/files.hpp"
#include "resight/io/images.hpp"
#include "resight/io/sequence.hpp"
#include "resight/io/tuw_changes.hpp"
#include "resight/io/tuw_ground_truth.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = ".resight-annotation";  // A folder with this file is ours and may be replaced.

std::vector<AnnotatedObject> objects_in_view(const AnnotationDocument& document, int view) {
  std::vector<AnnotatedObject> objects;
  for (const auto& [id, object] : document.objects)
    if (object.is_in(view)) objects.push_back(object);
  return objects;
}

/// Writes the files of one export, view by view.
class TruthWriter {
 public:
  /// `masks`: a folder for the masks, which are moved into the sequence when it is finished.
  TruthWriter(const ModelLibrary& library, fs::path masks, fs::path tuw)
      : library_(library), renderer_(library), mask_folder_(std::move(masks)), tuw_(std::move(tuw)) {}

  Result<void> add_view(const AnnotationDocument& document, const RgbdFrame& frame, const std::string& name,
                        SequenceWriter& writer) {
    const int view = static_cast<int>(masks_.size());
    masks_.push_back(renderer_.render(objects_in_view(document, view), frame));
    std::vector<GroundTruthObject> truth;
    std::map<std::string, int> counts;
    for (const ObjectMask& mask : masks_.back()) {
      const ObjectModel& model = library_.objects[static_cast<std::size_t>(mask.object.object)];
      truth.push_back({model.name, model.bop_id, counts[model.name]++,
                       frame.world_from_camera.inverse() * mask.object.world_from_object, mask.visible_share()});
      add_to_chain(mask.object.id, {name, view, model.name, truth.back().instance});
    }
    num_objects_ += static_cast<int>(truth.size());
    if (const auto done = writer.write_view(frame, truth); !done) return done;
    if (const auto done = write_masks(writer.view_names().back()); !done) return done;
    if (const auto done = write_tuw_annotation(tuw_, name, truth); !done) return done;
    return write_file(tuw_ / (name + ".anno"), annotation::format_anno(truth));
  }

  /// The masks per view, whose images are in the folder.
  [[nodiscard]] const std::vector<std::vector<ObjectMask>>& masks() const { return masks_; }
  [[nodiscard]] std::vector<ChangeChain> chains() const {
    std::vector<ChangeChain> chains;
    for (const auto& [id, chain] : chains_) chains.push_back(chain);
    return chains;
  }
  [[nodiscard]] int num_objects() const { return num_objects_; }

 private:
  /// Of the last view. Their images are dropped: those of a long sequence would fill the memory.
  Result<void> write_masks(const std::string& view_name) {
    for (std::size_t i = 0; i < masks_.back().size(); ++i) {
      ObjectMask& mask = masks_.back()[i];
      const std::string file = fmt::format("{}_{:06}.png", view_name, i);
      if (const auto done = write_mask(mask_folder_ / "mask" / file, std::exchange(mask.whole, {})); !done) return done;
      if (const auto done = write_mask(mask_folder_ / "mask_visib" / file, std::exchange(mask.visible, {})); !done)
        return done;
    }
    return {};
  }
  void add_to_chain(int placement, ChangeChainEntry entry) { chains_[placement].entries.push_back(std::move(entry)); }

  const ModelLibrary& library_;
  ObjectMaskRenderer renderer_;
  fs::path mask_folder_;
  fs::path tuw_;
  std::vector<std::vector<ObjectMask>> masks_;
  std::map<int, ChangeChain> chains_;
  int num_objects_ = 0;
};

Result<void> move_masks(const fs::path& from, const fs::path& to) {
  std::error_code error;
  for (const char* name : {"mask", "mask_visib"}) {
    fs::rename(from / name, to / name, error);
    if (error == std::errc::no_such_file_or_directory) continue;  // No object is in any view.
    if (error) return file_error(to / name, "cannot be written (" + error.message() + ")");
  }
  fs::remove(from, error);
  return {};
}

/// Puts a finished export into the place of an earlier one. At any moment, one of them is whole.
Result<void> replace_export(const fs::path& pending, const fs::path& folder) {
  if (auto done = check_export_folder(folder); !done) return done;
  const auto beside = [&](const char* state) {
    return folder.parent_path() / fmt::format(".{}.resight-{}", folder.filename().string(), state);
  };
  const fs::path ready = beside("new"), old = beside("old");
  std::error_code error;
  for (const fs::path& left : {ready, old}) fs::remove_all(left, error);
  // The hidden folder lies inside the existing one, so it is moved out before that one is.
  fs::rename(pending, ready, error);
  if (error) return file_error(ready, "cannot be written (" + error.message() + ")");
  if (fs::exists(folder, error)) fs::rename(folder, old, error);
  if (error) return file_error(folder, "cannot be replaced (" + error.message() + ")");
  fs::rename(ready, folder, error);
  if (error) {
    std::error_code ignored;
    fs::rename(old, folder, ignored);
    return file_error(folder, "cannot be written (" + error.message() + ")");
  }
  fs::remove_all(old, error);
  return {};
}

}  // namespace

Result<void> check_export_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(folder, error))) return {};
  if (!fs::is_directory(fs::symlink_status(folder, error)) || !fs::exists(folder / kMark, error))
    return file_error(folder, "is no earlier export, so it is not replaced");
  return {};
}

Result<ExportSummary> export_annotation(const AnnotationDocument& document, const ModelLibrary& library,
                                        std::span<const ChangeProposal> proposals, ViewStore& views,
                                        const std::string& scene, const fs::path& folder) {
  auto pending = PendingDirectory::create(folder, ExistingFolder::kFill);
  if (!pending) return pending.error();
  const fs::path bop = pending->path() / "bop" / scene;
  const fs::path tuw = pending->path() / "tuw" / scene;
  auto writer = create_sequence(bop, DatasetFormat::kBop);
  if (!writer) return writer.error();
  const fs::path masks = pending->path() / "masks";
  TruthWriter truth(library, masks, tuw);
  for (int v = 0; v < views.num_views(); ++v) {
    const auto frame = views.get(v);
    if (!frame) return frame.error();
    if (const auto done = truth.add_view(document, **frame, views.sequence().view_name(v), **writer); !done)
      return done.error();
  }
  const auto events = derive_events(document, library, views.num_views());
  const std::string text = annotation::format_events(events, library, scene, views.num_views());
  if (const auto done = (*writer)->add_file("events.json", text); !done) return done.error();
  const std::string info = annotation::format_mask_info(truth.masks(), (*writer)->view_names());
  if (const auto done = (*writer)->finish(); !done) return done.error();
  // The writer's own one knows no masks.
  if (const auto done = write_file(bop / "scene_gt_info.json", info); !done) return done.error();
  if (const auto done = move_masks(masks, bop); !done) return done.error();
  if (const auto done = write_changes(pending->path() / "tuw" / (scene + ".changes"), truth.chains()); !done)
    return done.error();
  if (const auto done = annotation::write_regions(document, proposals, library, views, pending->path() / "regions");
      !done)
    return done.error();
  if (const auto done = write_file(pending->path() / kMark, "may be replaced\n"); !done) return done.error();
  if (const auto done = replace_export(pending->path(), folder); !done) return done.error();
  return ExportSummary{.num_views = views.num_views(),
                       .num_objects = truth.num_objects(),
                       .num_events = static_cast<int>(events.size())};
}

}  // namespace resight
