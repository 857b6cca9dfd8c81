// SPDX-License-Identifier: Apache-2.0
#include "picture_sheets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <span>

#include "resight/io/images.hpp"

namespace resight::bench {
namespace {

constexpr int kPanel_px = 200;
constexpr int kCaption_px = 20;
constexpr int kMinCrop_px = 80;
constexpr int kColumns = 2;
constexpr int kRows = 6;
constexpr Rgb8 kRight{0, 200, 0};
constexpr Rgb8 kFalse{230, 0, 0};
constexpr Rgb8 kMissed{40, 90, 255};
constexpr Rgb8 kNotCounted{150, 150, 150};

// Channel order: red, green, blue.
cv::Mat as_mat(Image<Rgb8>& image) { return {image.height(), image.width(), CV_8UC3, image.data().data()}; }

// A square around the region with room on all sides, within the image.
cv::Rect crop_around(const Region& pixels, int width, int height) {
  std::vector<cv::Point> points;
  for (const int pixel : pixels) points.emplace_back(pixel % width, pixel / width);
  const cv::Rect box = cv::boundingRect(points);
  const int side = std::min({std::max(kMinCrop_px, 2 * std::max(box.width, box.height)), width, height});
  const int left = std::clamp(box.x + (box.width - side) / 2, 0, width - side);
  const int top = std::clamp(box.y + (box.height - side) / 2, 0, height - side);
  return {left, top, side, side};
}

Image<Rgb8> draw_reported(const Image<Rgb8>& color, const SideTruth& truth, const Mask& mask) {
  Image<Rgb8> picture = color;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    Rgb8& c = picture[i];
    c = {static_cast<std::uint8_t>(c.r / 2), static_cast<std::uint8_t>(c.g / 2), static_cast<std::uint8_t>(c.b / 2)};
    const bool reported = mask[i] != 0;
    if (truth.pixels[i] == TruthPixel::kChanged) c = reported ? kRight : kMissed;
    if (truth.pixels[i] == TruthPixel::kUnchanged && reported) c = kFalse;
    if (truth.pixels[i] == TruthPixel::kIgnored && reported) c = kNotCounted;
  }
  return picture;
}

Image<Rgb8> make_tile(std::array<Image<Rgb8>, 3> panels, const cv::Rect& crop, const std::string& caption) {
  Image<Rgb8> tile(3 * kPanel_px, kPanel_px + kCaption_px);
  const cv::Mat canvas = as_mat(tile);
  for (int i = 0; i < 3; ++i) {
    const cv::Mat target = canvas(cv::Rect(i * kPanel_px, kCaption_px, kPanel_px, kPanel_px));
    cv::resize(as_mat(panels[static_cast<std::size_t>(i)])(crop), target, target.size(), 0, 0, cv::INTER_NEAREST);
  }
  cv::putText(canvas, caption, {4, 14}, cv::FONT_HERSHEY_SIMPLEX, 0.4, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  return tile;
}

Result<void> write_sheet(const std::filesystem::path& file, std::span<const Image<Rgb8>> tiles) {
  const int width = tiles.front().width();
  const int height = tiles.front().height();
  const int rows = (static_cast<int>(tiles.size()) + kColumns - 1) / kColumns;
  Image<Rgb8> sheet(kColumns * width, rows * height);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    Image<Rgb8> tile = tiles[i];
    const int column = static_cast<int>(i) % kColumns;
    const int row = static_cast<int>(i) / kColumns;
    as_mat(tile).copyTo(as_mat(sheet)(cv::Rect(column * width, row * height, width, height)));
  }
  return write_color(file, sheet);
}

Result<void> write_sheets(const std::filesystem::path& folder, const std::string& name,
                          std::span<const Image<Rgb8>> tiles) {
  constexpr auto kPerSheet = std::size_t{kColumns} * std::size_t{kRows};
  for (std::size_t first = 0; first < tiles.size(); first += kPerSheet) {
    const auto of_sheet = tiles.subspan(first, std::min(kPerSheet, tiles.size() - first));
    const auto file = folder / fmt::format("{}_{:02}.png", name, first / kPerSheet + 1);
    if (auto done = write_sheet(file, of_sheet); !done) return done;
  }
  return {};
}

}  // namespace

void PictureSheets::add(const LabelledView& before, const LabelledView& after, const ChangeTruth& truth,
                        const ReportedChanges& reported, const Mistake& mistake) {
  const LabelledView& shows = mistake.side == kAdded ? after : before;
  const cv::Rect crop = crop_around(mistake.pixels, shows.classes.width(), shows.classes.height());
  Image<Rgb8> overlay = draw_reported(shows.frame.color, truth.sides[mistake.side], reported.masks[mistake.side]);
  (mistake.is_false ? false_ : missed_)
      .push_back(make_tile({before.frame.color, after.frame.color, std::move(overlay)}, crop,
                           fmt::format("{}: {}", after.frame.name, mistake.text)));
}

Result<void> PictureSheets::write(const std::filesystem::path& folder) const {
  if (auto done = write_sheets(folder, "missed", missed_); !done) return done;
  return write_sheets(folder, "false", false_);
}

}  // namespace resight::bench
