// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/recording_topics.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "resight/core/printable.hpp"
#include "resight/io/internal/recording_images.hpp"
#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

bool is_image_type(std::string_view type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage" || type == "stereo_msgs/DisparityImage";
}

struct ImageTopic {
  int topic = -1;
  ImageContent content = ImageContent::kUnknown;
  std::string frame;
  std::string encoding;
  int rank = 0;  ///< Higher: rather the one that is meant.
};

bool contains(std::string_view text, std::string_view word) { return text.find(word) != text.npos; }

/// Registered depth before other depth, raw images before compressed ones, rectified before distorted ones.
int rank_topic(const RecordedTopic& topic, ImageContent content) {
  const std::string name = to_lower(topic.name);
  int rank = topic.type == "sensor_msgs/Image" ? 1 : 0;
  if (contains(name, "rect")) rank += 2;
  if (content == ImageContent::kDepth) {
    if (contains(name, "aligned") || contains(name, "registered")) rank += 8;
    if (contains(name, "depth")) rank += 4;
    return rank;
  }
  if (contains(name, "color") || contains(name, "rgb")) rank += 8;
  if (contains(name, "infra") || contains(name, "/ir/") || contains(name, "left") || contains(name, "right") ||
      contains(name, "mask") || contains(name, "debug"))
    rank -= 16;
  return contains(name, "depth") && !contains(name, "rgb") ? rank - 16 : rank;
}

/// Topics whose first message cannot be read are left out; `damage` becomes the last reason.
std::vector<ImageTopic> list_image_topics(const Recording& recording, const FirstMessages& first, std::string& damage) {
  std::vector<ImageTopic> images;
  const auto& topics = recording.topics();
  for (std::size_t t = 0; t < topics.size(); ++t) {
    if (!is_image_type(topics[t].type)) continue;
    const auto bytes = first.read(static_cast<int>(t), kImageStartBytes);
    if (!bytes) damage = bytes.error().message;
    if (!bytes || !*bytes) continue;
    const auto start = decode_image_start(**bytes, topics[t]);
    if (!start) continue;
    const ImageContent content = content_of(start->encoding, topics[t].name);
    images.push_back(
        {static_cast<int>(t), content, start->header.frame, start->encoding, rank_topic(topics[t], content)});
  }
  return images;
}

std::string list_names(const Recording& recording, const std::vector<ImageTopic>& images, ImageContent content) {
  std::string names;
  for (const ImageTopic& image : images)
    if (image.content == content)
      names += (names.empty() ? "" : ", ") + printable(recording.topics()[static_cast<std::size_t>(image.topic)].name);
  return names;
}

/// The topic that is given by its name, or the one of the highest rank.
Result<ImageTopic> choose_image_topic(const Recording& recording, const std::vector<ImageTopic>& images,
                                      ImageContent content, const std::string& given) {
  const bool is_color = content == ImageContent::kColor;
  const char* what = is_color ? "colour" : "depth";
  const char* option = is_color ? "--color-topic" : "--depth-topic";
  std::vector<ImageTopic> candidates;
  for (const ImageTopic& image : images) {
    const std::string& name = recording.topics()[static_cast<std::size_t>(image.topic)].name;
    if (given.empty() ? image.content == content : name == given) candidates.push_back(image);
  }
  if (candidates.empty()) {
    const std::string names = list_names(recording, images, content);
    if (!given.empty())
      return Error{fmt::format("has no images of the topic {}; topics of {} images: {}", given, what,
                               names.empty() ? "none" : names)};
    return Error{fmt::format("has no topic of {} images ({})", what,
                             is_color
                                 ? "sensor_msgs/Image such as rgb8, or CompressedImage"
                                 : "sensor_msgs/Image 16UC1 or 32FC1, compressedDepth, or stereo_msgs/DisparityImage")};
  }
  std::ranges::stable_sort(candidates, std::ranges::greater(), &ImageTopic::rank);
  if (candidates.size() > 1 && candidates[0].rank == candidates[1].rank)
    return Error{fmt::format("has several topics of {} images ({}): choose one by {}", what,
                             list_names(recording, images, content), option)};
  return candidates.front();
}

/// The names that CameraInfo has beside a topic of images.
std::vector<std::string> info_names(std::string_view image_topic) {
  std::string base(image_topic);
  for (const char* transport : {"/compressed", "/compressedDepth"})
    if (base.ends_with(transport)) base.resize(base.size() - std::string_view(transport).size());
  std::vector<std::string> names;
  if (base.ends_with("/image/data"))  // recordings of librealsense
    names.push_back(base.substr(0, base.size() - std::string_view("image/data").size()) + "info/camera_info");
  if (const std::size_t slash = base.rfind('/'); slash != base.npos) {
    names.push_back(base.substr(0, slash) + "/camera_info");
    if (const std::size_t above = base.rfind('/', slash - 1); slash > 0 && above != base.npos)
      names.push_back(base.substr(0, above) + "/camera_info");
  }
  names.push_back(base + "/camera_info");
  return names;
}

Result<std::optional<CameraInfoMessage>> find_camera_info(const Recording& recording, const FirstMessages& first,
                                                          std::string_view image_topic, const std::string& given) {
  const std::vector<std::string> names = given.empty() ? info_names(image_topic) : std::vector<std::string>{given};
  for (const std::string& name : names) {
    const int topic = find_topic(recording, name);
    if (topic < 0 || recording.topics()[static_cast<std::size_t>(topic)].type != "sensor_msgs/CameraInfo") continue;
    const auto bytes = first.read(topic, 1U << 16);
    if (!bytes) return bytes.error();
    if (!*bytes) continue;
    auto info = decode_camera_info(**bytes, recording.topics()[static_cast<std::size_t>(topic)].layout, name);
    if (!info) return info.error();
    return std::optional(std::move(*info));
  }
  if (!given.empty()) return Error{fmt::format("has no sensor_msgs/CameraInfo of the topic {}", given)};
  return std::optional<CameraInfoMessage>();
}

}  // namespace

int find_topic(const Recording& recording, std::string_view name) {
  const auto& topics = recording.topics();
  const auto it = std::ranges::find(topics, name, &RecordedTopic::name);
  return it == topics.end() ? -1 : static_cast<int>(it - topics.begin());
}

FirstMessages::FirstMessages(const Recording& recording)
    : recording_(recording), of_topic_(recording.topics().size(), nullptr) {
  for (const MessageEntry& message : recording.messages())
    if (const MessageEntry*& first = of_topic_[static_cast<std::size_t>(message.topic)]; first == nullptr)
      first = &message;
}

Result<std::optional<std::string>> FirstMessages::read(int topic, std::size_t max_bytes) const {
  const MessageEntry* message = of_topic_[static_cast<std::size_t>(topic)];
  if (message == nullptr) return std::optional<std::string>();
  auto bytes = recording_.read(*message, max_bytes);
  if (!bytes) return bytes.error();
  return std::optional(std::move(*bytes));
}

Result<ViewTopics> find_view_topics(const Recording& recording, const RecordingTopics& given) {
  const FirstMessages first(recording);
  ViewTopics topics;
  const std::vector<ImageTopic> images = list_image_topics(recording, first, topics.damage);
  const auto color = choose_image_topic(recording, images, ImageContent::kColor, given.color);
  const auto depth = choose_image_topic(recording, images, ImageContent::kDepth, given.depth);
  if (!color || !depth) {
    const std::string& message = color ? depth.error().message : color.error().message;
    return Error{topics.damage.empty() ? message : fmt::format("{}; damaged: {}", message, topics.damage)};
  }
  topics.color = color->topic;
  topics.depth = depth->topic;
  topics.color_frame = color->frame;
  topics.depth_frame = depth->frame;
  topics.depth_encoding = depth->encoding;
  const auto name_of = [&](int topic) -> const std::string& {
    return recording.topics()[static_cast<std::size_t>(topic)].name;
  };
  auto color_info = find_camera_info(recording, first, name_of(color->topic), given.camera_info);
  if (!color_info) return color_info.error();
  topics.color_info = std::move(*color_info);
  auto depth_info = find_camera_info(recording, first, name_of(depth->topic), "");
  if (!depth_info) return depth_info.error();
  topics.depth_info = std::move(*depth_info);
  return topics;
}

}  // namespace resight::io
