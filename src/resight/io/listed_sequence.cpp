// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/listed_sequence.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "resight/io/images.hpp"
#include "resight/io/internal/depth_arrays.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/image_decoder.hpp"
#include "resight/sensor/rectify.hpp"

namespace resight::io {
namespace {

Result<Image<float>> read_rotated_depth(const fs::path& file, double metres_per_unit) {
  const auto raw = read_depth_raw(file);
  if (!raw) return raw.error();
  Image<float> depth_m(raw->width(), raw->height());
  for (std::size_t i = 0; i < raw->size(); ++i) {
    const std::uint16_t value = std::rotl((*raw)[i], 13);
    depth_m[i] = depth_or_none(value * metres_per_unit);
  }
  return depth_m;
}

Result<Image<float>> read_unsaturated_depth(const fs::path& file, double metres_per_unit) {
  const auto raw = read_depth_raw(file);
  if (!raw) return raw.error();
  return scale_unsaturated_depth(*raw, metres_per_unit);
}

/// Whether they show the same field of view.
bool has_same_shape(const Image<Rgb8>& color, const Image<float>& depth) {
  const double of_color = static_cast<double>(color.width()) / color.height();
  const double of_depth = static_cast<double>(depth.width()) / depth.height();
  return depth.width() < color.width() && std::abs(of_depth / of_color - 1) < 0.003;
}

/// Depth with fewer pixels than the colours, registered to them, as cameras of phones give it.
Image<float> enlarge_depth(const Image<float>& depth_m, int width, int height) {
  Image<float> large(width, height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) large(u, v) = depth_m(u * depth_m.width() / width, v * depth_m.height() / height);
  return large;
}

Result<Image<float>> read_depth_image(const SequenceTable& table, const ListedView& view) {
  switch (table.depth_storage) {
    case DepthStorage::kByName:
      if (holds_depth_array(extension_of(view.depth))) return read_depth_array(view.depth, table.npy_unit_m);
      return read_unsaturated_depth(view.depth, view.metres_per_unit);
    case DepthStorage::kRotatedPng:
      return read_rotated_depth(view.depth, view.metres_per_unit);
    case DepthStorage::kPng:
      break;
  }
  return read_depth(view.depth, view.metres_per_unit);
}

class ListedSequence final : public Sequence {
 public:
  explicit ListedSequence(SequenceTable table) : table_(std::move(table)) {}

  [[nodiscard]] std::string format() const override { return table_.format; }
  [[nodiscard]] int num_views() const override { return static_cast<int>(table_.views.size()); }
  [[nodiscard]] std::string view_name(int view) const override { return table_.views.at(view).name; }
  [[nodiscard]] int scene_id() const override { return table_.scene_id; }
  [[nodiscard]] int image_id(int view) const override { return table_.views.at(view).image_id; }
  [[nodiscard]] bool has_poses() const override { return table_.has_poses; }
  [[nodiscard]] bool has_ground_truth() const override { return table_.has_ground_truth; }

  [[nodiscard]] Result<std::vector<GroundTruthObject>> read_ground_truth(int view) const override {
    return table_.views.at(view).ground_truth;
  }

  [[nodiscard]] Result<Rigid3> read_pose(int view) const override { return table_.views.at(view).world_from_camera; }

  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    const ListedView& listed = table_.views.at(view);
    auto color = read_color(listed.color, kMaxViewPixels);
    if (!color) return color.error();
    auto depth = read_depth_image(table_, listed);
    if (!depth) return depth.error();
    const Intrinsics& k = listed.intrinsics;
    const Camera camera{color->width(), color->height(), k.fx, k.fy, k.cx, k.cy};
    if (listed.own_camera) {
      const auto fits = check_calibration(*listed.own_camera, camera.width, camera.height, listed.name);
      if (!fits) return fits.error();
    }
    depth = fit_to_color(std::move(*depth), listed, *color, camera);
    if (!depth) return depth.error();
    RgbdFrame frame{listed.name, camera, std::move(*color), std::move(*depth), listed.world_from_camera};
    if (const auto done = check_frame(frame); !done) return file_error(listed.color, done.error().message);
    const LensDistortion& lens = listed.own_camera ? listed.own_camera->lens : table_.lens;
    if (!lens.is_none()) {
      frame.color = undistort_color(frame.color, frame.camera, lens);
      if (!table_.depth_camera) frame.depth_m = undistort_depth(frame.depth_m, frame.camera, lens);
    }
    return frame;
  }

  [[nodiscard]] std::vector<std::string> notes() const override { return table_.notes; }
  [[nodiscard]] SequenceTable& table() { return table_; }

 private:
  /// Depth as the colour camera would measure it.
  [[nodiscard]] Result<Image<float>> fit_to_color(Image<float> depth_m, const ListedView& view,
                                                  const Image<Rgb8>& color, const Camera& camera) const {
    if (table_.depth_camera) return register_to_color(depth_m, camera);
    if (color.width() == depth_m.width() && color.height() == depth_m.height()) return depth_m;
    if (table_.may_enlarge_depth && has_same_shape(color, depth_m))
      return enlarge_depth(depth_m, color.width(), color.height());
    return file_error(view.depth,
                      fmt::format("is {}x{}, but its colour image {}x{}; expected depth registered to colour, or "
                                  "--depth-intrinsics and --color-from-depth",
                                  depth_m.width(), depth_m.height(), color.width(), color.height()));
  }

  [[nodiscard]] Result<Image<float>> register_to_color(const Image<float>& depth_m, const Camera& color_camera) const {
    const Calibration& of_depth = table_.depth_camera->calibration;
    if (const auto fits = check_calibration(of_depth, depth_m.width(), depth_m.height(), "--depth-intrinsics"); !fits)
      return fits.error();
    const Intrinsics& k = of_depth.intrinsics;
    const Camera camera{depth_m.width(), depth_m.height(), k.fx, k.fy, k.cx, k.cy};
    return register_depth(of_depth.lens.is_none() ? depth_m : undistort_depth(depth_m, camera, of_depth.lens), camera,
                          table_.depth_camera->color_from_depth, color_camera);
  }

  SequenceTable table_;
};

}  // namespace

Result<void> check_image_size(const Calibration& calibration, const fs::path& image, std::string_view what) {
  constexpr std::size_t kBytesOfHeader = std::size_t{1} << 16;
  const auto start = read_file_start(image, kBytesOfHeader);
  if (!start) return {};  // read_view() reports a damaged image.
  const auto decoder = make_image_decoder(*start);
  if (!decoder) return {};
  const auto header = (*decoder)->read_header();
  if (!header) return {};
  return check_calibration(calibration, header->width, header->height, what);
}

std::string describe_enlarged_depth(const SequenceTable& table) {
  if (table.depth_camera || table.views.empty()) return "";
  const auto color = read_color(table.views.front().color, kMaxViewPixels);
  const auto depth = read_depth_image(table, table.views.front());
  if (!color.ok() || !depth.ok() || !has_same_shape(*color, *depth)) return "";
  return fmt::format("depth of {}x{} is taken as registered to the colours of {}x{} (otherwise --depth-intrinsics)",
                     depth->width(), depth->height(), color->width(), color->height());
}

std::unique_ptr<Sequence> make_listed_sequence(SequenceTable table) {
  return std::make_unique<ListedSequence>(std::move(table));
}

SequenceTable* listed_table(Sequence& sequence) {
  auto* listed = dynamic_cast<ListedSequence*>(&sequence);
  return listed == nullptr ? nullptr : &listed->table();
}

}  // namespace resight::io
