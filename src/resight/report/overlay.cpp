// SPDX-License-Identifier: Apache-2.0
#include "resight/report/overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "resight/core/check.hpp"
#include "resight/report/internal/drawing.hpp"
#include "resight/sensor/reduce_frame.hpp"

namespace resight {
namespace {

using report::LabelPainter;
using report::LineStyle;
using report::Outline;

constexpr Rgb8 kNovelColor{30, 200, 60};
constexpr Rgb8 kRemovedColor{235, 30, 40};
constexpr Rgb8 kMissedColor{255, 255, 255};

struct OutlineStyle {
  LineStyle style = LineStyle::kSolid;
  double thickness = 1.0;  // Factor of DrawOverlayOptions::outline_px.
};

OutlineStyle style_of(DetectionMark mark) {
  switch (mark) {
    case DetectionMark::kUnjudged:
    case DetectionMark::kCorrect:
      return {};
    case DetectionMark::kFalsePositive:
    case DetectionMark::kGhost:
      return {LineStyle::kDashed, 1.0};
    case DetectionMark::kIgnored:
      return {LineStyle::kSolid, 0.5};
  }
  return {};
}

std::string label_of(const Detection& detection, const std::string& name, DetectionMark mark) {
  const std::string text = fmt::format("{} {:.2f}", name, detection.score);
  if (mark == DetectionMark::kGhost) return "ghost: " + text;
  if (mark == DetectionMark::kFalsePositive) return "false: " + text;
  return text;
}

int line_width_px(double wanted_px, double share) {
  return std::max(1, static_cast<int>(std::lround(wanted_px * share)));
}

void cross_out(cv::Mat& canvas, const cv::Rect& box, Rgb8 color, int thickness_px) {
  const cv::Scalar ink = report::to_scalar(color);
  cv::line(canvas, box.tl(), box.br(), ink, thickness_px, cv::LINE_AA);
  cv::line(canvas, {box.x, box.y + box.height}, {box.x + box.width, box.y}, ink, thickness_px, cv::LINE_AA);
}

void tint_changes(Image<Rgb8>& picture, const Camera& camera, const Rigid3& world_from_camera,
                  const ChangeResult& changes, double opacity) {
  // Of a view that was reduced for the work. The first view has no mask.
  const Image<std::uint8_t>& mask = changes.novel_mask;
  if (mask.size() > 0) {
    const int divisor = picture.width() / mask.width();
    report::tint(picture, enlarge_mask(mask, divisor, picture.width(), picture.height()), kNovelColor, opacity);
  }
  const Image<std::uint8_t> removed =
      report::project_points(camera, world_from_camera.inverse(), changes.removed_in_world);
  report::tint(picture, removed, kRemovedColor, opacity);
}

void require_valid(const RgbdFrame& frame) {
  const Result<void> valid = check_frame(frame);
  require(valid.ok(), valid.ok() ? "" : valid.error().message);
}

/// Draws one frame. Later drawings cover earlier ones, so labels come last.
class OverlayPainter {
 public:
  OverlayPainter(Image<Rgb8>& picture, const Camera& camera, const Rigid3& world_from_camera,
                 const ModelLibrary& library, const DrawOverlayOptions& options)
      : canvas_(report::as_mat(picture)),
        camera_(camera),
        camera_from_world_(world_from_camera.inverse()),
        library_(library),
        options_(options) {}

  void add_missed(const GroundTruthObject& truth) {
    const int object = library_.find(truth.object);
    if (object < 0) return;
    const Outline outline = outline_of(object, truth.camera_from_object);
    report::draw_outline(canvas_, outline, kMissedColor, LineStyle::kDotted, line_width_px(options_.outline_px, 1));
    if (!outline.empty()) labels_.push_back({"missed: " + truth.object, report::bounding_box(outline), kMissedColor});
  }

  void add_detection(const Detection& detection, DetectionMark mark) {
    const Rgb8 color = object_color(detection.object);
    const Outline outline = outline_of(detection.object, camera_from_world_ * detection.world_from_object);
    if (outline.empty()) return;
    const OutlineStyle style = style_of(mark);
    const int width = line_width_px(options_.outline_px, style.thickness);
    // A dark rim makes the line visible on any background.
    report::draw_outline(canvas_, outline, {0, 0, 0}, style.style, width + 2);
    report::draw_outline(canvas_, outline, color, style.style, width);
    const cv::Rect box = report::bounding_box(outline);
    if (mark == DetectionMark::kGhost) cross_out(canvas_, box, color, width);
    labels_.push_back({label_of(detection, model(detection.object).name, mark), box, color});
  }

  void draw_labels() {
    LabelPainter painter(canvas_);
    for (const Label& label : labels_) painter.draw(label.text, label.target, label.color);
  }

 private:
  struct Label {
    std::string text;
    cv::Rect target;
    Rgb8 color;
  };

  [[nodiscard]] const ObjectModel& model(int object) const {
    return library_.objects[static_cast<std::size_t>(object)];
  }
  [[nodiscard]] Outline outline_of(int object, const Rigid3& camera_from_object) const {
    return report::project_outline(camera_, camera_from_object, model(object).surface, library_.surface_voxel_m);
  }

  cv::Mat canvas_;
  const Camera& camera_;
  Rigid3 camera_from_world_;
  const ModelLibrary& library_;
  const DrawOverlayOptions& options_;
  std::vector<Label> labels_;
};

}  // namespace

std::string to_string(DetectionMark mark) {
  switch (mark) {
    case DetectionMark::kUnjudged:
      return "unjudged";
    case DetectionMark::kCorrect:
      return "correct";
    case DetectionMark::kFalsePositive:
      return "false";
    case DetectionMark::kGhost:
      return "ghost";
    case DetectionMark::kIgnored:
      return "not counted";
  }
  return "unknown";
}

void DrawOverlayOptions::check() const {
  check_in_range("DrawOverlayOptions.change_opacity", change_opacity, 0.0, 1.0);
  check_positive("DrawOverlayOptions.outline_px", outline_px);
}

Rgb8 object_color(int object) {
  static constexpr std::array<Rgb8, 12> kColors = {{{70, 150, 255},
                                                    {255, 165, 30},
                                                    {240, 90, 220},
                                                    {60, 220, 225},
                                                    {250, 230, 60},
                                                    {160, 110, 250},
                                                    {255, 160, 160},
                                                    {190, 140, 90},
                                                    {20, 140, 150},
                                                    {200, 200, 255},
                                                    {150, 60, 120},
                                                    {230, 200, 150}}};
  const auto count = static_cast<int>(kColors.size());
  return kColors[static_cast<std::size_t>(((object % count) + count) % count)];
}

Image<Rgb8> draw_overlay(const RgbdFrame& frame, const ModelLibrary& library, const SceneUpdate& update,
                         std::span<const DetectionMark> marks, std::span<const GroundTruthObject> missed,
                         const DrawOverlayOptions& options) {
  options.check();
  require_valid(frame);
  require(marks.empty() || marks.size() == update.detections.size(),
          "draw_overlay: marks must be empty or one per detection");
  for (const Detection& detection : update.detections) std::ignore = library.object(detection.object);  // Throws early.
  Image<Rgb8> picture = frame.color;
  if (options.show_changes)
    tint_changes(picture, frame.camera, update.world_from_camera, update.changes, options.change_opacity);
  OverlayPainter painter(picture, frame.camera, update.world_from_camera, library, options);
  for (const GroundTruthObject& truth : missed) painter.add_missed(truth);
  if (options.show_detections) {
    for (std::size_t i = 0; i < update.detections.size(); ++i) {
      painter.add_detection(update.detections[i], marks.empty() ? DetectionMark::kUnjudged : marks[i]);
    }
  }
  if (options.show_labels) painter.draw_labels();
  return picture;
}

Image<Rgb8> draw_changes(const RgbdFrame& frame, const ChangeResult& changes, const DrawOverlayOptions& options) {
  options.check();
  require_valid(frame);
  Image<Rgb8> picture = frame.color;
  for (Rgb8& pixel : picture.data()) {
    const auto grey = static_cast<std::uint8_t>(std::lround(0.299 * pixel.r + 0.587 * pixel.g + 0.114 * pixel.b));
    pixel = {grey, grey, grey};
  }
  tint_changes(picture, frame.camera, frame.world_from_camera, changes, options.change_opacity);
  return picture;
}

std::vector<std::uint8_t> encode_jpeg(const Image<Rgb8>& picture, int quality, int max_width_px) {
  require(!picture.empty(), "encode_jpeg: the picture is empty");
  check_in_range("encode_jpeg: quality", quality, 1, 100);
  check_not_negative("encode_jpeg: max_width_px", max_width_px);
  Image<Rgb8> copy = picture;
  cv::Mat bgr;
  cv::cvtColor(report::as_mat(copy), bgr, cv::COLOR_RGB2BGR);
  if (max_width_px > 0 && bgr.cols > max_width_px) {
    const int height =
        std::max(1, static_cast<int>(std::lround(static_cast<double>(bgr.rows) * max_width_px / bgr.cols)));
    cv::resize(bgr, bgr, cv::Size(max_width_px, height), 0, 0, cv::INTER_AREA);
  }
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return bytes;
}

}  // namespace resight
