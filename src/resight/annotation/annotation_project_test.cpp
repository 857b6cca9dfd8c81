// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/annotation_project.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "resight/core/input_file.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using Kind = ActionOutcome::Kind;

constexpr AnnotationLimits kLimits{.num_views = 10, .num_objects = 3};

class AnnotationProjectTest : public testing::Test {
 protected:
  AnnotationProjectTest() {
    char name[] = "/tmp/resight_annotation_XXXXXX";
    folder_ = ::mkdtemp(name);
  }
  ~AnnotationProjectTest() override { fs::remove_all(folder_); }
  [[nodiscard]] std::unique_ptr<AnnotationProject> open() const {
    auto project = AnnotationProject::open(folder_, kLimits, "inputs");
    EXPECT_TRUE(project.ok()) << project.error().message;
    return project.ok() ? *std::move(project) : nullptr;
  }
  [[nodiscard]] fs::path journal() const { return folder_ / "annotation.jsonl"; }
  fs::path folder_;
};

AnnotatedObject make_object(double x_m, int first = 0, int last = 9) {
  return {.id = -1,
          .track = -1,
          .object = 1,
          .first_view = first,
          .last_view = last,
          .world_from_object = Rigid3::from_translation({x_m, 0, 1})};
}
AnnotationChange judge(double x_m, RegionVerdict verdict, std::optional<PixelRuns> mask = std::nullopt) {
  const RegionKey region{.view = 3, .kind = RegionKind::kRemoved, .center_in_world_m = Eigen::Vector3d(x_m, 0.1, 2)};
  return JudgeRegion{{.region = region, .verdict = verdict, .track = -1, .mask = std::move(mask)}};
}
AnnotationEdit put(const AnnotatedObject& object) { return {.title = "Place", .changes = {PutObject{object}}}; }

double x_of(const AnnotationProject& project, int id) {
  return project.document().objects.at(id).world_from_object.translation.x();
}

TEST_F(AnnotationProjectTest, ActionsSurviveAndCanBeUndone) {
  {
    const auto project = open();
    EXPECT_EQ(project->act(put(make_object(0.1)), 0).kind, Kind::kApplied);
    AnnotatedObject moved = project->document().objects.at(0);
    moved.world_from_object.translation.x() = 0.2;
    EXPECT_EQ(project->act(put(moved), 1).kind, Kind::kApplied);
    EXPECT_EQ(project->act(UndoEdit{}, 2).kind, Kind::kApplied);
  }
  const auto project = open();
  EXPECT_EQ(project->revision(), 3);
  EXPECT_DOUBLE_EQ(x_of(*project, 0), 0.1);
  EXPECT_EQ(project->act(RedoEdit{}, 3).kind, Kind::kApplied);
  EXPECT_DOUBLE_EQ(x_of(*project, 0), 0.2);
  EXPECT_EQ(project->redo_title(), "");
  EXPECT_EQ(project->act(RedoEdit{}, 4).kind, Kind::kInvalid);
}

// The detections of a long sequence are one edit.
TEST_F(AnnotationProjectTest, AnEditMayHaveThousandsOfChanges) {
  AnnotationEdit edit{.title = "Start from detections", .changes = {}};
  for (int i = 0; i < 3000; ++i) edit.changes.emplace_back(PutObject{make_object(0.1 * i)});
  EXPECT_EQ(open()->act(edit, 0).kind, Kind::kApplied);
  const auto project = open();
  ASSERT_NE(project, nullptr);
  EXPECT_EQ(project->document().objects.size(), 3000U);
}

TEST_F(AnnotationProjectTest, UndoOfEveryKindOfChangeRestoresTheDocument) {
  const auto project = open();
  ASSERT_EQ(project->act(put(make_object(0.1)), 0).kind, Kind::kApplied);
  const AnnotationEdit edit{.title = "All",
                            .changes = {DropObject{0}, judge(1, RegionVerdict::kRejected), CheckView{3, true},
                                        PutUnknownEvent{{.id = -1,
                                                         .view = 2,
                                                         .kind = AnnotatedEventKind::kAdded,
                                                         .name = "cup",
                                                         .before_in_world_m = std::nullopt,
                                                         .after_in_world_m = Eigen::Vector3d(1, 2, 3)}}}};
  ASSERT_EQ(project->act(edit, 1).kind, Kind::kApplied);
  EXPECT_TRUE(project->document().objects.empty());
  EXPECT_EQ(project->document().unknown_events.size(), 1U);
  ASSERT_EQ(project->act(UndoEdit{}, 2).kind, Kind::kApplied);
  EXPECT_EQ(project->document().objects.size(), 1U);
  EXPECT_TRUE(project->document().regions.empty());
  EXPECT_TRUE(project->document().checked_views.empty());
  EXPECT_TRUE(project->document().unknown_events.empty());
}

TEST_F(AnnotationProjectTest, StaleActionsChangeNothing) {
  const auto project = open();
  ASSERT_EQ(project->act(put(make_object(0.1)), 0).kind, Kind::kApplied);
  EXPECT_EQ(project->act(put(make_object(0.3)), 0).kind, Kind::kStale);
  EXPECT_EQ(project->document().objects.size(), 1U);
}

TEST_F(AnnotationProjectTest, WrongActionsAreRefusedAsAWhole) {
  const auto project = open();
  AnnotationEdit edit = put(make_object(0.1));
  edit.changes.emplace_back(DropObject{7});
  EXPECT_EQ(project->act(edit, 0).kind, Kind::kInvalid);
  EXPECT_EQ(project->act(put(make_object(0.1, 5, 4)), 0).kind, Kind::kInvalid);
  EXPECT_EQ(project->act(put(make_object(0.1, 0, 10)), 0).kind, Kind::kInvalid);
  EXPECT_EQ(project->act(put(make_object(1e9)), 0).kind, Kind::kInvalid);
  EXPECT_TRUE(project->document().objects.empty());
  EXPECT_EQ(project->revision(), 0);
}

TEST_F(AnnotationProjectTest, AFailedEditTakesNoNumbers) {
  const auto project = open();
  AnnotationEdit edit = put(make_object(0.1));
  edit.changes.emplace_back(DropObject{7});
  EXPECT_EQ(project->act(edit, 0).kind, Kind::kInvalid);
  EXPECT_EQ(project->document().next_id, 0);
  EXPECT_EQ(project->act(put(make_object(0.1)), 0).kind, Kind::kApplied);
  EXPECT_TRUE(project->document().objects.contains(0));
}

TEST_F(AnnotationProjectTest, WhatTheJournalCouldNotTellAgainIsRefused) {
  const UnknownObjectEvent event{.id = -1,
                                 .view = 2,
                                 .kind = AnnotatedEventKind::kAdded,
                                 .name = "cup",
                                 .before_in_world_m = std::nullopt,
                                 .after_in_world_m = Eigen::Vector3d(1, 2, 3)};
  AnnotatedObject last = make_object(0.1);
  last.id = last.track = 1000000;
  AnnotatedObject next_of_track = make_object(0.2);
  next_of_track.id = 0;
  {
    const auto project = open();
    ASSERT_EQ(project->act(put(last), 0).kind, Kind::kApplied);
    EXPECT_EQ(project->act(put(make_object(0.2)), 1).kind, Kind::kInvalid) << "the next number is out of range";
    EXPECT_EQ(project->act(put(next_of_track), 1).kind, Kind::kInvalid);
    EXPECT_EQ(project->act(AnnotationEdit{"Event", {PutUnknownEvent{event}}}, 1).kind, Kind::kInvalid);
  }
  const auto project = open();
  ASSERT_NE(project, nullptr);
  EXPECT_EQ(project->document().objects.size(), 1U);
}

TEST_F(AnnotationProjectTest, WhatCannotBeWrittenDoesNotCount) {
  const auto project = open();
  ASSERT_EQ(project->act(put(make_object(0.1)), 0).kind, Kind::kApplied);
  ASSERT_EQ(project->act(put(make_object(0.2)), 1).kind, Kind::kApplied);
  ASSERT_EQ(project->act(UndoEdit{}, 2).kind, Kind::kApplied);
  const std::string before = *read_file(journal());
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  const rlimit full{.rlim_cur = before.size() + 3, .rlim_max = old.rlim_max};
  const auto old_handler = ::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  const ActionOutcome edit = project->act(put(make_object(0.3)), 3);
  const ActionOutcome undo = project->act(UndoEdit{}, 3);
  const ActionOutcome redo = project->act(RedoEdit{}, 3);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
  ::signal(SIGXFSZ, old_handler);
  for (const ActionOutcome& outcome : {edit, undo, redo}) EXPECT_EQ(outcome.kind, Kind::kNotWritten) << outcome.message;
  EXPECT_EQ(*read_file(journal()), before);
  EXPECT_EQ(project->revision(), 3);
  EXPECT_EQ(project->document().objects.size(), 1U);
  EXPECT_EQ(project->undo_title(), "Place");
  EXPECT_EQ(project->act(RedoEdit{}, 3).kind, Kind::kApplied) << "there is room again";
  EXPECT_DOUBLE_EQ(x_of(*project, 1), 0.2);
}

TEST_F(AnnotationProjectTest, CorrectedMasksSurviveAndCanBeUndone) {
  const PixelRuns runs{{5, 3}, {10, 1}};
  const auto mask_of = [](const AnnotationProject& project) { return project.document().regions.begin()->second.mask; };
  {
    const auto project = open();
    ASSERT_EQ(project->act(AnnotationEdit{"Mask", {judge(1, RegionVerdict::kOpen, runs)}}, 0).kind, Kind::kApplied);
    ASSERT_EQ(project->act(AnnotationEdit{"Mask", {judge(1, RegionVerdict::kOpen, PixelRuns{})}}, 1).kind,
              Kind::kApplied);
    EXPECT_EQ(mask_of(*project), PixelRuns{}) << "everything was erased";
    ASSERT_EQ(project->act(UndoEdit{}, 2).kind, Kind::kApplied);
  }
  const auto project = open();
  EXPECT_EQ(mask_of(*project), runs);
  ASSERT_EQ(project->act(UndoEdit{}, 3).kind, Kind::kApplied);
  EXPECT_TRUE(project->document().regions.empty());
  // A verdict that names no mask keeps the one that is there, also when it is read again.
  const auto verdict = parse_action(
      R"({"title":"v","changes":[{"do":"judge_region","region":{"view":3,"kind":"removed","center":[1,0.1,2]},)"
      R"("verdict":"rejected"}]})");
  ASSERT_TRUE(verdict.ok()) << verdict.error().message;
  ASSERT_EQ(project->act(AnnotationEdit{"Mask", {judge(1, RegionVerdict::kOpen, runs)}}, 4).kind, Kind::kApplied);
  ASSERT_EQ(project->act(*verdict, 5).kind, Kind::kApplied);
  EXPECT_EQ(mask_of(*project), runs);
  EXPECT_NE(read_file(journal())->rfind("\"mask\":[5,3,10,1]"), std::string::npos);
  const PixelRuns overlapping{{5, 3}, {7, 1}};
  EXPECT_EQ(project->act(AnnotationEdit{"Mask", {judge(1, RegionVerdict::kOpen, overlapping)}}, 6).kind,
            Kind::kInvalid);
}

TEST_F(AnnotationProjectTest, ACutOffLastLineIsDropped) {
  {
    const auto project = open();
    ASSERT_EQ(project->act(put(make_object(0.1)), 0).kind, Kind::kApplied);
    ASSERT_EQ(project->act(put(make_object(0.2)), 1).kind, Kind::kApplied);
  }
  fs::resize_file(journal(), fs::file_size(journal()) - 5);
  const auto project = open();
  EXPECT_TRUE(project->was_cut_off());
  EXPECT_EQ(project->revision(), 1);
  EXPECT_EQ(project->act(put(make_object(0.3)), 1).kind, Kind::kApplied);
  EXPECT_EQ(project->document().objects.size(), 2U);
}

TEST_F(AnnotationProjectTest, NothingIsLeftOfACutOffFirstLine) {
  ASSERT_NE(open(), nullptr);
  const std::string header = *read_file(journal());
  fs::resize_file(journal(), header.size() / 2);
  {
    const auto project = open();
    ASSERT_NE(project, nullptr);
    EXPECT_TRUE(project->was_cut_off());
  }
  EXPECT_EQ(*read_file(journal()), header);
  const auto project = open();
  ASSERT_NE(project, nullptr);
  EXPECT_FALSE(project->was_cut_off());
}

TEST_F(AnnotationProjectTest, AForeignFileWithoutLineBreakIsKept) {
  const std::string foreign = R"({"a":1})";
  std::ofstream(journal()) << foreign;
  EXPECT_FALSE(AnnotationProject::open(folder_, kLimits, "inputs").ok());
  EXPECT_EQ(*read_file(journal()), foreign);
}

TEST_F(AnnotationProjectTest, DamageBeforeTheLastLineIsAnError) {
  {
    const auto project = open();
    ASSERT_EQ(project->act(put(make_object(0.1)), 0).kind, Kind::kApplied);
    ASSERT_EQ(project->act(put(make_object(0.2)), 1).kind, Kind::kApplied);
  }
  std::string text = *read_file(journal());
  text.replace(text.find("put_object"), 3, "###");
  std::ofstream(journal()) << text;
  const auto project = AnnotationProject::open(folder_, kLimits, "inputs");
  ASSERT_FALSE(project.ok());
  EXPECT_THAT(project.error().message, testing::HasSubstr("line 2 is damaged"));
}

TEST_F(AnnotationProjectTest, OtherInputsAndASecondProcessAreRefused) {
  const auto project = open();
  const auto second = AnnotationProject::open(folder_, kLimits, "inputs");
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, testing::HasSubstr("is open in another"));
}

TEST_F(AnnotationProjectTest, AProjectBelongsToItsInputs) {
  open().reset();
  const auto other = AnnotationProject::open(folder_, kLimits, "others");
  ASSERT_FALSE(other.ok());
  EXPECT_THAT(other.error().message, testing::HasSubstr("belongs to another sequence"));
}

TEST_F(AnnotationProjectTest, AProjectOfAnEarlierVersionIsContinued) {
  open().reset();
  const std::string header = *read_file(journal());
  {
    const auto project = AnnotationProject::open(folder_, kLimits, "with pixels", "inputs");
    ASSERT_TRUE(project.ok()) << project.error().message;
    EXPECT_EQ((*project)->act(put(make_object(0.1)), 0).kind, Kind::kApplied);
  }
  EXPECT_TRUE(read_file(journal())->starts_with(header));
  EXPECT_FALSE(AnnotationProject::open(folder_, kLimits, "with pixels", "other inputs").ok());
}

TEST_F(AnnotationProjectTest, AKilledProcessLosesNoAcknowledgedActionAndItsLock) {
  int acknowledged[2];
  ASSERT_EQ(::pipe(acknowledged), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto project = open();
    for (int i = 0;; ++i) {
      if (project->act(put(make_object(0.001 * i)), i).kind != Kind::kApplied) ::_exit(1);
      const char byte = 1;
      if (::write(acknowledged[1], &byte, 1) != 1) ::_exit(1);
    }
  }
  char bytes[20];
  for (int count = 0; count < 20;) count += static_cast<int>(::read(acknowledged[0], bytes, sizeof(bytes)));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ::close(acknowledged[1]);
  int num_more = 0;
  while (::read(acknowledged[0], bytes, 1) == 1) ++num_more;
  ::close(acknowledged[0]);
  const auto project = open();
  ASSERT_NE(project, nullptr);
  EXPECT_GE(project->revision(), 20 + num_more);
  EXPECT_LE(project->revision(), 22 + num_more + 20);
}

// The page, which shows these messages, counts views from 1.
TEST_F(AnnotationProjectTest, MessagesCountViewsFromOne) {
  const auto project = open();
  const auto message = [&](AnnotationChange change) {
    return project->act(AnnotationEdit{"Edit", {std::move(change)}}, 0).message;
  };
  EXPECT_EQ(message(PutObject{make_object(0.1, 4, 3)}), "the placement ends at view 4 before it begins at view 5");
  EXPECT_EQ(message(PutObject{make_object(0.1, 4, 10)}), "views 5 to 11 are not in the sequence");
  EXPECT_EQ(message(CheckView{10, true}), "there is no view 11");
  RegionJudgement judgement{.region = {}, .verdict = RegionVerdict::kAccepted, .track = -1, .mask = std::nullopt};
  judgement.region.view = 12;
  EXPECT_EQ(message(JudgeRegion{judgement}), "there is no view 13");
  EXPECT_EQ(message(PutUnknownEvent{{.id = -1,
                                     .view = 0,
                                     .kind = AnnotatedEventKind::kAdded,
                                     .name = "thing",
                                     .before_in_world_m = std::nullopt,
                                     .after_in_world_m = Eigen::Vector3d::Zero()}}),
            "no change can happen before view 1");
  EXPECT_EQ(project->revision(), 0);
}

TEST(ParseAction, TitlesHoldTheLongestNameOfAnObject) {
  const auto parse = [](const std::string& title) {
    return parse_action(format_action(AnnotationEdit{title, {DropObject{1}}}));
  };
  const auto action = parse("Turn by symmetry " + std::string(200, 'x'));
  EXPECT_TRUE(action.ok());
  EXPECT_FALSE(parse(std::string(301, 'x')).ok());
}

TEST(ParseAction, ReadsWhatIsWritten) {
  const AnnotationAction action = put(make_object(0.123456789012345));
  const auto read = parse_action(format_action(action));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(format_action(*read), format_action(action));
  const AnnotationAction judgement =
      AnnotationEdit{"Mask", {judge(0.1 + 0.2, RegionVerdict::kAccepted, PixelRuns{{3, 4}, {100, 1}})}};
  const auto judged = parse_action(format_action(judgement));
  ASSERT_TRUE(judged.ok()) << judged.error().message;
  EXPECT_EQ(format_action(*judged), format_action(judgement)) << "the place to the last digit";
}

TEST(ParseAction, RefusesWhatIsNoAction) {
  const std::string pose = "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,1,1]";
  const auto edit = [](const std::string& change) { return R"({"title":"t","changes":[)" + change + "]}"; };
  const auto object = [&](const std::string& numbers) {
    return edit(R"({"do":"put_object","object":0,"first_view":0,"last_view":1,"pose":)" + numbers + "}");
  };
  EXPECT_TRUE(parse_action(object(pose)).ok());
  for (
      const std::string& text :
      {std::string(""), std::string("7"), std::string("{}"), edit(""), edit("{}"), edit(R"({"do":"drop_object"})"),
       edit(R"({"do":"format_disk"})"), object("[1,2]"), object("[2,0,0,0,0,1,0,0,0,0,1,0,0,0,1,1]"),
       object("[1,0,0,0,0,1,0,0,0,0,1,0,1e999,0,1,1]"), object("[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,1,1]"),
       edit(R"({"do":"judge_region","region":3,"verdict":"accepted"})"),
       edit(R"({"do":"judge_region","region":{"view":3,"kind":"novel"},"verdict":"accepted"})"),
       edit(R"({"do":"judge_region","region":{"view":3,"kind":"new","center":[0,0,0]},"verdict":"accepted"})"),
       edit(R"({"do":"judge_region","region":{"view":3,"kind":"novel","center":[0,0,0]},"verdict":"open","mask":[1]})"),
       edit(
           R"({"do":"judge_region","region":{"view":3,"kind":"novel","center":[0,0,0]},"verdict":"open","mask":[-1,2]})"),
       edit(R"({"do":"drop_object","id":1,"id":2})"), edit(R"({"do":"drop_object","id":1e300})"),
       edit(R"({"do":"drop_object","id":99999999999999})")})
    EXPECT_FALSE(parse_action(text).ok()) << text;
}

}  // namespace
}  // namespace resight
