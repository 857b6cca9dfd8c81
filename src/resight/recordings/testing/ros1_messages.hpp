// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "resight/geometry/rigid3.hpp"

/// Small recordings for tests: ROS 1 messages in an MCAP file without chunks and index. Readers are also tested against
/// files of other writers (tests/data/recordings).
namespace resight::recordings {

template <typename T>
std::string packed(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}
inline std::string packed_text(const std::string& text) {
  return packed(static_cast<std::uint32_t>(text.size())) + text;
}
inline std::string packed_header(double time_s, const std::string& frame) {
  const auto seconds = static_cast<std::uint32_t>(time_s);
  return packed(std::uint32_t{0}) + packed(seconds) + packed(static_cast<std::uint32_t>((time_s - seconds) * 1e9)) +
         packed_text(frame);
}
inline std::string packed_rigid(const Rigid3& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  std::string bytes;
  for (const double value :
       {pose.translation.x(), pose.translation.y(), pose.translation.z(), q.x(), q.y(), q.z(), q.w()})
    bytes += packed(value);
  return bytes;
}

inline std::string image_message(double time_s, const std::string& frame, const std::string& encoding, int width,
                                 int height, const std::string& data) {
  return packed_header(time_s, frame) + packed(static_cast<std::uint32_t>(height)) +
         packed(static_cast<std::uint32_t>(width)) + packed_text(encoding) + std::string(1, '\0') +
         packed(static_cast<std::uint32_t>(data.size() / static_cast<std::size_t>(height))) + packed_text(data);
}
/// Of disparities from 1 to 100 px.
inline std::string disparity_message(double time_s, const std::string& frame, float focal_length_px, float baseline_m,
                                     int width, int height, const std::string& data) {
  return packed_header(time_s, frame) + image_message(time_s, frame, "32FC1", width, height, data) +
         packed(focal_length_px) + packed(baseline_m) + std::string(17, '\0') + packed(1.0F) + packed(100.0F) +
         packed(0.125F);
}
inline std::string camera_info_message(const std::string& frame, int width, int height, const std::string& model,
                                       const std::vector<double>& distortion, const std::vector<double>& k,
                                       const std::vector<double>& p = std::vector<double>(12)) {
  std::string bytes = packed_header(1, frame) + packed(static_cast<std::uint32_t>(height)) +
                      packed(static_cast<std::uint32_t>(width)) + packed_text(model) +
                      packed(static_cast<std::uint32_t>(distortion.size()));
  for (const double value : distortion) bytes += packed(value);
  for (const double value : k) bytes += packed(value);
  for (int i = 0; i < 9; ++i) bytes += packed(0.0);
  for (const double value : p) bytes += packed(value);
  return bytes;
}
inline std::string transform_message(double time_s, const std::string& parent, const std::string& child,
                                     const Rigid3& pose) {
  return packed(std::uint32_t{1}) + packed_header(time_s, parent) + packed_text(child) + packed_rigid(pose);
}
inline std::string odometry_message(double time_s, const std::string& parent, const std::string& child,
                                    const Rigid3& pose) {
  return packed_header(time_s, parent) + packed_text(child) + packed_rigid(pose) + std::string(8 * 36, '\0');
}
inline std::string pose_message(double time_s, const std::string& frame, const Rigid3& pose) {
  return packed_header(time_s, frame) + packed_rigid(pose);
}

/// Collects messages; bytes() is the file.
class TestRecording {
 public:
  void add(const std::string& topic, const std::string& type, double time_s, const std::string& message) {
    add_message(topic, type, time_s, packed(static_cast<std::uint64_t>(time_s * 1e9)) + message);
  }
  /// A message that cannot be read: its record ends too early.
  void add_cut(const std::string& topic, const std::string& type, double time_s) {
    add_message(topic, type, time_s, "");
  }
  [[nodiscard]] std::string bytes() const {
    const std::string magic("\x89MCAP0\r\n", 8);
    return magic + record(1, packed_text("ros1") + packed_text("")) + records_ + record(15, std::string(4, '\0')) +
           record(2, std::string(20, '\0')) + magic;
  }

 private:
  void add_message(const std::string& topic, const std::string& type, double time_s, const std::string& rest) {
    const auto [it, is_new] = channels_.try_emplace(topic, static_cast<std::uint16_t>(channels_.size() + 1));
    if (is_new) {
      add_record(3, packed(it->second) + packed_text(type) + packed_text("ros1msg") + packed_text(""));
      add_record(4, packed(it->second) + packed(it->second) + packed_text(topic) + packed_text("ros1") +
                        packed(std::uint32_t{0}));
    }
    const auto time_ns = static_cast<std::uint64_t>(time_s * 1e9);
    add_record(5, packed(it->second) + packed(std::uint32_t{0}) + packed(time_ns) + rest);
  }
  [[nodiscard]] static std::string record(char op, const std::string& content) {
    return std::string(1, op) + packed(static_cast<std::uint64_t>(content.size())) + content;
  }
  void add_record(char op, const std::string& content) { records_ += record(op, content); }
  std::string records_;
  std::map<std::string, std::uint16_t> channels_;
};

}  // namespace resight::recordings
