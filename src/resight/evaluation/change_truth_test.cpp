// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/change_truth.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace resight {
namespace {

namespace fs = std::filesystem;

const std::string kIdentity = "[1,0,0,0.5, 0,1,0,0, 0,0,1,0.7, 0,0,0,1]";

class ReadTrueChanges : public testing::Test {
 protected:
  ~ReadTrueChanges() override { fs::remove(file_); }
  Result<std::vector<TrueChange>> read(const std::string& text) {
    std::ofstream(file_) << text;
    return read_true_changes(file_, 5);
  }
  static std::string event(const std::string& kind, const std::string& before, const std::string& after) {
    return R"({"view": 3, "kind": ")" + kind + R"(", "object": "mug", "instance": "mug_2", "known": true, )" +
           R"("world_from_object_before": )" + before + R"(, "world_from_object_after": )" + after + "}";
  }
  fs::path file_ = fs::temp_directory_path() / ("resight_events_" + std::to_string(::getpid()) + ".json");
};

TEST_F(ReadTrueChanges, ReadsWhatSimulateWrites) {
  const auto changes = read(R"({"events": [)" + event("moved", kIdentity, kIdentity) + "," +
                            event("removed", kIdentity, "null") + "," + event("added", "null", kIdentity) + "]}");
  ASSERT_TRUE(changes.ok()) << changes.error().message;
  ASSERT_EQ(changes->size(), 3U);
  EXPECT_EQ((*changes)[1].kind, ObjectEventKind::kRemoved);
  EXPECT_EQ((*changes)[1].view, 3);
  EXPECT_FALSE((*changes)[1].world_from_object_after.has_value());
  EXPECT_EQ((*changes)[2].world_from_object_after->translation, Eigen::Vector3d(0.5, 0, 0.7));
  ModelLibrary library;
  EXPECT_TRUE(former_places_of(*changes, library).empty());
  library.objects.resize(1);
  library.objects[0].name = "mug";
  const auto places = former_places_of(*changes, library);
  ASSERT_EQ(places.size(), 2U);  // Of the moved and of the removed object.
  EXPECT_EQ(places[0].last_view, 2);
}

}  // namespace
}  // namespace resight
