// SPDX-License-Identifier: Apache-2.0
#include "resight/io/event_file.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

namespace resight {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr const char* kEventPose = "[1,0,0,0.5, 0,1,0,0, 0,0,1,0.7, 0,0,0,1]";

class EventFile : public testing::Test {
 protected:
  ~EventFile() override { fs::remove(file_); }
  Result<std::vector<RecordedEvent>> read(const std::string& text) {
    std::ofstream(file_) << text;
    return read_event_file(file_, 5);
  }
  /// What the reader says of a list of one event.
  std::string fault_of(const std::string& event) {
    const auto events = read(R"({"events": [)" + event + "]}");
    return events.ok() ? "nothing" : events.error().message;
  }
  static std::string event(const std::string& view, const std::string& kind, const std::string& object,
                           const std::string& before, const std::string& after) {
    return R"({"view": )" + view + R"(, "kind": ")" + kind + R"(", "object": )" + object +
           R"(, "known": true, "world_from_object_before": )" + before + R"(, "world_from_object_after": )" + after +
           "}";
  }
  fs::path file_ = fs::temp_directory_path() / ("resight_event_file_" + std::to_string(::getpid()) + ".json");
};

TEST_F(EventFile, GoodEventsAreRead) {
  const auto events = read(R"({"events": [)" + event("3", "moved", "\"mug\"", kEventPose, kEventPose) + "," +
                           event("4", "added", "\"mug\"", "null", kEventPose) + "]}");
  ASSERT_TRUE(events.ok()) << events.error().message;
  ASSERT_EQ(events->size(), 2U);
  EXPECT_EQ((*events)[0].view, 3);
  EXPECT_EQ((*events)[0].world_from_object_before->translation, Eigen::Vector3d(0.5, 0, 0.7));
  EXPECT_FALSE((*events)[1].world_from_object_before.has_value());
}

TEST_F(EventFile, EventsOfAnotherSequenceAreRefused) {
  EXPECT_TRUE(read(R"({"num_views": 5, "events": [[3, "moved", "mug"]]})").ok());
  EXPECT_THAT(read(R"({"num_views": 6, "events": [[3, "moved", "mug"]]})").error().message,
              HasSubstr("num_views: differs from the 5 views of the sequence"));
}

TEST_F(EventFile, TheShortFormHasNoPoses) {
  const auto events = read(R"({"events": [[3, "moved", "mug"], [4, "added", "box"]]})");
  ASSERT_TRUE(events.ok()) << events.error().message;
  ASSERT_EQ(events->size(), 2U);
  EXPECT_EQ((*events)[0].view, 3);
  EXPECT_EQ((*events)[0].kind, "moved");
  EXPECT_EQ((*events)[0].object, "mug");
  EXPECT_FALSE((*events)[0].world_from_object_before.has_value());
  EXPECT_FALSE((*events)[1].world_from_object_after.has_value());
  EXPECT_THAT(fault_of(R"([3, "moved"])"), HasSubstr("events[0]: expected an object, or [view, kind, object]"));
  EXPECT_THAT(fault_of(R"([3, "moved", "mug", 1])"), HasSubstr("expected an object, or [view, kind, object]"));
  EXPECT_THAT(fault_of(R"(["mug", "moved", 3])"), HasSubstr("view: expected"));
  EXPECT_THAT(fault_of(R"([5, "moved", "mug"])"), HasSubstr("view: 5, but the sequence has 5 views"));
}

TEST_F(EventFile, WhatIsNoListOfEventsIsRefused) {
  EXPECT_THAT(read("nonsense").error().message, HasSubstr("is not valid JSON: line 1"));
  for (const char* text : {"{}", "[]", "3", R"({"events": {}})", R"({"events": null})"})
    EXPECT_THAT(read(text).error().message, HasSubstr("is not an object with a list of events")) << text;
  EXPECT_THAT(read(R"({"events": [], "events": []})").error().message, HasSubstr("has the key 'events' twice"));
  EXPECT_THAT(read(std::string(100, '[')).error().message, HasSubstr("nested more than"));
  EXPECT_THAT(read_event_file("/nowhere/events.json", 5).error().message, HasSubstr("/nowhere/events.json"));
  EXPECT_THAT(read_event_file("/dev/zero", 5).error().message, HasSubstr("is not a file"));
}

TEST_F(EventFile, HostileEventsAreNamedInOneLine) {
  const std::string mug = "\"mug\"";
  EXPECT_THAT(fault_of("3"), HasSubstr("events[0]: kind: expected"));
  EXPECT_THAT(fault_of(event("3", "flown", mug, kEventPose, kEventPose)),
              HasSubstr("kind: expected added, moved or removed"));
  EXPECT_THAT(fault_of(event("5", "moved", mug, kEventPose, kEventPose)),
              HasSubstr("view: 5, but the sequence has 5 views"));
  EXPECT_THAT(fault_of(event("-1", "moved", mug, kEventPose, kEventPose)), HasSubstr("view: expected"));
  EXPECT_THAT(fault_of(event("1e300", "moved", mug, kEventPose, kEventPose)), HasSubstr("view: expected"));
  EXPECT_THAT(fault_of(event("3", "moved", "7", kEventPose, kEventPose)), HasSubstr("object: expected a text"));
  EXPECT_THAT(fault_of(event("3", "moved", R"("../../x")", kEventPose, kEventPose)), HasSubstr("slashes"));
  EXPECT_THAT(fault_of(event("3", "moved", '"' + std::string(100000, 'a') + '"', kEventPose, kEventPose)),
              HasSubstr("has 100000 bytes"));
  const std::string control = fault_of(event("3", "moved", R"("\u001b[31m\n")", kEventPose, kEventPose));
  EXPECT_THAT(control, HasSubstr("control characters"));
  EXPECT_EQ(control.find_first_of("\x1b\n"), std::string::npos);
  EXPECT_THAT(fault_of(event("3", "removed", mug, kEventPose, kEventPose)),
              HasSubstr("do not match the kind 'removed'"));
  EXPECT_THAT(fault_of(event("3", "added", mug, "null", "[1,2,3]")), HasSubstr("expected 16 finite numbers"));
  EXPECT_THAT(fault_of(event("3", "added", mug, "null", "[2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]")),
              HasSubstr("world_from_object_after: the pose is not a rigid motion"));
  EXPECT_THAT(fault_of(event("3", "added", mug, "null", "[1,0,0,1e300, 0,1,0,0, 0,0,1,0, 0,0,0,1]")),
              HasSubstr("away from the origin"));
  EXPECT_TRUE(fault_of("3").starts_with(file_.string()));
}

}  // namespace
}  // namespace resight
