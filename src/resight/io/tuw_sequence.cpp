// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/pcd_header.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/organized_pcd.hpp"
#include "resight/io/tuw_ground_truth.hpp"

namespace resight::io {
namespace {

class TuwSequence final : public Sequence {
 public:
  TuwSequence(std::vector<fs::path> files, std::vector<std::string> names, std::vector<TuwViewAnnotation> annotations)
      : files_(std::move(files)), names_(std::move(names)), annotations_(std::move(annotations)) {}

  [[nodiscard]] std::string format() const override { return "tuw"; }
  [[nodiscard]] int num_views() const override { return static_cast<int>(files_.size()); }
  [[nodiscard]] std::string view_name(int view) const override { return names_.at(view); }

  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    const auto cloud = read_pcd(files_.at(view));
    if (!cloud) return cloud.error();
    auto frame = to_frame(*cloud, files_[view].string());
    if (!frame) return frame;
    frame->name = names_[view];
    if (const auto done = check_frame(*frame); !done) return file_error(files_[view], done.error().message);
    return frame;
  }

  // Views that we wrote have their camera and z forward, so the header is enough. Others may be rotated (to_frame()).
  [[nodiscard]] Result<Rigid3> read_pose(int view) const override {
    const auto header = read_pcd_header(files_.at(view));
    if (!header) return header.error();
    if (header->camera) return header->viewpoint;
    return Sequence::read_pose(view);
  }

  [[nodiscard]] bool has_ground_truth() const override {
    return std::ranges::any_of(annotations_, [](const TuwViewAnnotation& a) { return !a.empty(); });
  }
  [[nodiscard]] Result<std::vector<GroundTruthObject>> read_ground_truth(int view) const override {
    return read_tuw_annotation(annotations_.at(view));
  }

 private:
  std::vector<fs::path> files_;
  std::vector<std::string> names_;
  std::vector<TuwViewAnnotation> annotations_;
};

class TuwSequenceWriter final : public SequenceWriter {
 public:
  explicit TuwSequenceWriter(PendingDirectory directory) : directory_(std::move(directory)) {}

  [[nodiscard]] Result<void> write_view(const RgbdFrame& frame,
                                        const std::vector<GroundTruthObject>& ground_truth) override {
    if (const auto done = check_frame(frame); !done) return done;
    if (const auto fits = check_tuw_view_name(frame.name, names_.empty() ? "" : names_.back()); !fits)
      return file_error(directory_.final_path(), fits.error().message);
    names_.push_back(frame.name);
    const auto done = write_pcd(directory_.path() / (frame.name + ".pcd"), to_pcd_cloud(frame));
    if (!done) return done;
    return write_tuw_annotation(directory_.path(), frame.name, ground_truth);
  }

  [[nodiscard]] const std::vector<std::string>& view_names() const override { return names_; }
  [[nodiscard]] Result<void> add_file(const std::string& name, std::string_view bytes) override {
    return write_file(directory_.path() / name, bytes);
  }
  [[nodiscard]] Result<void> finish() override {
    if (names_.empty()) return file_error(directory_.final_path(), "no view was written");
    return directory_.commit();
  }

 private:
  PendingDirectory directory_;
  std::vector<std::string> names_;
};

bool is_pcd(const std::string& name) { return extension_of(name) == "pcd"; }

SequenceResult open_files(std::vector<fs::path> files, const fs::path& directory) {
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.stem().string());
  auto annotations = find_tuw_annotations(find_tuw_annotation_directory(directory, names), names);
  return SequenceResult(std::make_unique<TuwSequence>(std::move(files), std::move(names), std::move(annotations)));
}

}  // namespace

Result<void> check_tuw_view_name(const std::string& name, const std::string& before) {
  if (!is_safe_name(name)) return Error{"the view name '" + name + "' cannot be a file name"};
  // Readers sort files by name and assume this to be the order of time.
  if (!before.empty() && !natural_less(before, name))
    return Error{"view '" + name + "' comes after '" + before + "'; names must ascend in time"};
  return {};
}

// Unorganised clouds alone are models. A damaged file may be a view.
bool is_tuw_sequence(const fs::path& directory) {
  return std::ranges::any_of(list_files(directory), [&](const std::string& name) {
    if (!is_pcd(name)) return false;
    const auto size = read_pcd_size(directory / name);
    return !size || size->height > 1;
  });
}

SequenceResult open_tuw_sequence(const fs::path& directory) {
  std::vector<fs::path> files;
  for (const std::string& name : list_files(directory)) {
    if (!is_pcd(name)) continue;
    const auto size = read_pcd_size(directory / name);
    if (!size) return size.error();
    if (size->height > 1) files.push_back(directory / name);
  }
  return open_files(std::move(files), directory);
}

SequenceResult open_single_pcd(const fs::path& file) {
  const auto size = read_pcd_size(file);
  if (!size) return size.error();
  if (size->height <= 1) return file_error(file, "is an unorganised cloud; expected a view (organised, HEIGHT > 1)");
  return open_files({file}, fs::absolute(file).parent_path());
}

Result<std::unique_ptr<SequenceWriter>> create_tuw_sequence(const fs::path& directory) {
  auto pending = PendingDirectory::create(directory);
  if (!pending) return pending.error();
  return std::unique_ptr<SequenceWriter>(std::make_unique<TuwSequenceWriter>(std::move(*pending)));
}

}  // namespace resight::io
