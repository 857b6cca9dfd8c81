// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "resight/core/random.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight::test {

/// A way to break a good sequence, and the faults that a check may call it.
struct Breakage {
  std::string name;
  std::vector<std::string> expected;
  bool needs_motion = false;  ///< Without poses of a moving camera it changes nothing that can be seen.
  /// It takes neighbouring views for one another, which in a sequence of views far apart is no fault of time.
  bool needs_near_views = false;
};

inline const std::vector<Breakage>& breakages() {
  static const std::vector<Breakage> all{
      {"depth_x10", {"depth_scale"}},
      {"depth_x0.1", {"depth_scale"}},
      {"depth_x1000", {"depth_scale"}},
      {"depth_x0.001", {"depth_scale"}},
      {"depth_x1.25", {"depth_scale"}, true},
      {"depth_x0.8", {"depth_scale"}, true},
      {"no_depth", {"no_depth"}},
      {"no_depth_in_third", {"no_depth"}},
      {"eight_bits", {"eight_bit_depth"}},
      {"black", {"black_image"}},
      {"motion_blur", {"motion_blur"}},
      {"color_6_px", {"unregistered_depth", "color_offset"}},
      {"unregistered", {"unregistered_depth"}},
      {"intrinsics_of_double_size", {"intrinsics"}},
      {"intrinsics_of_half_size", {"intrinsics"}},
      {"focal_1e-6", {"intrinsics"}},
      {"focal_1e300", {"intrinsics"}},
      {"focal_x1.3", {"intrinsics"}, true},
      {"focal_x0.75", {"intrinsics"}, true},
      {"poses_in_mm", {"pose_unit"}, true},
      {"poses_inverted", {"pose_convention"}, true},
      {"poses_opengl", {"pose_convention"}, true},
      {"depth_1_view_late", {"depth_time"}, true, true},
      {"poses_1_view_late", {"pose_time", "pose_error"}, true},
      {"poses_2_views_late", {"pose_time", "pose_error"}, true},
      {"poses_drift", {"pose_error", "depth_scale", "pose_time"}, true},
      {"poses_drift_slowly", {"pose_drift", "pose_error"}, true},
      {"poses_noisy", {"pose_error", "pose_time"}, true},
      {"poses_fixed", {"fixed_poses"}, true},
      {"poses_100_km_away", {"far_from_origin"}},
  };
  return all;
}

/// A sequence that is broken in one way.
class BrokenSequence : public Sequence {
 public:
  /// `original` must outlive this object. `breakage`: a name of breakages(); others change nothing.
  BrokenSequence(const Sequence& original, std::string breakage) : original_(original), breakage_(std::move(breakage)) {
    for (int v = 0; v < original.num_views(); ++v) poses_.push_back(original.read_pose(v).value());
    break_poses();
  }
  [[nodiscard]] std::string format() const override { return original_.format(); }
  [[nodiscard]] int num_views() const override { return original_.num_views(); }
  [[nodiscard]] std::string view_name(int view) const override { return original_.view_name(view); }
  [[nodiscard]] bool has_poses() const override { return original_.has_poses(); }
  [[nodiscard]] Result<Rigid3> read_pose(int view) const override { return poses_.at(static_cast<std::size_t>(view)); }
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    Result<RgbdFrame> frame = original_.read_view(view);
    if (!frame.ok()) return frame;
    frame->world_from_camera = poses_.at(static_cast<std::size_t>(view));
    break_camera(frame->camera);
    break_depth(view, frame->depth_m);
    break_color(frame->color);
    if (is("depth_1_view_late") && view + 1 < num_views()) {
      Result<RgbdFrame> later = original_.read_view(view + 1);
      if (!later.ok()) return later;
      frame->depth_m = std::move(later->depth_m);
    }
    return frame;
  }

 private:
  static constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();
  [[nodiscard]] bool is(std::string_view name) const { return breakage_ == name; }

  void break_poses() {
    Rng rng(7);
    Rigid3 drift;
    const std::vector<Rigid3> good = poses_;
    Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
    for (std::size_t v = 0; v < poses_.size(); ++v) {
      Rigid3& pose = poses_[v];
      const auto noise = [&](double size) {
        return Eigen::Vector3d(size * rng.normal(), size * rng.normal(), size * rng.normal());
      };
      if (is("poses_in_mm")) pose.translation *= 1000;
      if (is("poses_inverted")) pose = pose.inverse();
      if (is("poses_opengl")) pose = pose * Rigid3::from_rotation(flip);
      if (is("poses_1_view_late")) pose = good[v < 1 ? 0 : v - 1];
      if (is("poses_2_views_late")) pose = good[v < 2 ? 0 : v - 2];
      if (is("poses_fixed")) pose = good.front();
      if (is("poses_100_km_away")) pose.translation += Eigen::Vector3d(1e5, 0, 0);
      if (is("poses_noisy"))
        pose = pose * Rigid3{Rigid3::from_axis_angle(noise(1), 0.03 * rng.normal()).rotation, noise(0.03)};
      if (is("poses_drift_slowly")) {  // By 0.1 rad over the sequence, whatever its length: some 50 px in the end.
        const double share = static_cast<double>(v) / static_cast<double>(poses_.size());
        pose = pose * Rigid3{Rigid3::from_axis_angle({1, 0, 0}, 0.1 * share).rotation, {0, 0.03 * share, 0}};
      }
      if (is("poses_drift")) {
        drift = drift * Rigid3{Rigid3::from_axis_angle({0, 1, 0}, 0.015).rotation, {0.02, 0, 0.01}};
        pose = pose * drift;
      }
    }
  }

  void break_camera(Camera& c) const {
    const auto scale = [&](double by) {
      c.fx *= by;
      c.fy *= by;
    };
    if (is("intrinsics_of_double_size") || is("intrinsics_of_half_size")) {
      const double by = is("intrinsics_of_double_size") ? 2 : 0.5;
      scale(by);
      c.cx *= by;
      c.cy *= by;
    }
    if (is("focal_x1.3")) scale(1.3);
    if (is("focal_x0.75")) scale(0.75);
    if (is("focal_1e-6")) c.fx = 1e-6;
    if (is("focal_1e300")) c.fx = 1e300;
  }

  void break_depth(int view, Image<float>& depth_m) const {
    for (const auto& [name, by] : {std::pair("depth_x10", 10.0F),
                                   {"depth_x0.1", 0.1F},
                                   {"depth_x1000", 1000.0F},
                                   {"depth_x0.001", 0.001F},
                                   {"depth_x1.25", 1.25F},
                                   {"depth_x0.8", 0.8F}})
      if (is(name))
        for (float& z_m : depth_m.data()) z_m *= by;
    if (is("no_depth") || (is("no_depth_in_third") && view % 3 == 0)) std::ranges::fill(depth_m.data(), kNoDepth);
    if (is("eight_bits")) {
      float largest_m = 0;
      for (const float z_m : depth_m.data()) largest_m = std::fmax(largest_m, z_m);
      for (float& z_m : depth_m.data()) {
        z_m = std::round(255 * z_m / largest_m) * largest_m / 255;
        if (!(z_m > 0)) z_m = kNoDepth;
      }
    }
  }

  void break_color(Image<Rgb8>& color) const {
    const Image<Rgb8> good = color;
    const auto at = [&](double u, double v) {
      return good(std::clamp(static_cast<int>(std::lround(u)), 0, good.width() - 1),
                  std::clamp(static_cast<int>(std::lround(v)), 0, good.height() - 1));
    };
    for (int v = 0; v < color.height(); ++v)
      for (int u = 0; u < color.width(); ++u) {
        if (is("black")) color(u, v) = {static_cast<std::uint8_t>(u % 3), 1, 0};
        if (is("color_6_px")) color(u, v) = at(u - 5, v + 3);
        if (is("unregistered")) color(u, v) = at(320 + (u - 320) * 0.9 - 22, 240 + (v - 240) * 0.9 + 8);
        if (is("motion_blur")) color(u, v) = mean_along_row(good, u, v);
      }
  }
  static Rgb8 mean_along_row(const Image<Rgb8>& color, int u, int v) {
    constexpr int kHalf_px = 9;
    int r = 0, g = 0, b = 0;
    for (int x = u - kHalf_px; x <= u + kHalf_px; ++x) {
      const Rgb8& c = color(std::clamp(x, 0, color.width() - 1), v);
      r += c.r;
      g += c.g;
      b += c.b;
    }
    constexpr int kNum = 2 * kHalf_px + 1;
    return {static_cast<std::uint8_t>(r / kNum), static_cast<std::uint8_t>(g / kNum),
            static_cast<std::uint8_t>(b / kNum)};
  }

  const Sequence& original_;
  std::string breakage_;
  std::vector<Rigid3> poses_;
};

}  // namespace resight::test
