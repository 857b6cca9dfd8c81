// SPDX-License-Identifier: Apache-2.0
// Valid data, mistakes on the command line, and settings files.
#include "cli.hpp"

namespace resight::cli_test {
namespace {

std::string make_long_key(const std::string& part, int count) {
  std::string key = "# " + std::string(200, '.') + "\na";
  for (int i = 0; i < count; ++i) key += "." + part;
  return key + " = 1\n";
}
const std::string kLongKey = make_long_key("a", 50000);
const std::string kLongQuotedKey = make_long_key("\"=\"", 200000);
const std::string kLongUnknownKey = std::string(50000, 'k') + " = 1\n";

const Row kArgumentRows[] = {
    // The valid data are accepted, so the other rows fail because of what they damage.
    {"Version", kNothing, "--version", 0, ""},
    {"Help", kNothing, "recognize --help", 0, ""},
    {"Recognize", kNothing, kRecognize, 0, "", "out/report.html"},
    {"RecognizeTuw", kNothing, kRecognizeTuw, 0, "", "out/detections.csv"},
    {"Changes", kNothing, kChanges, 0, "", "out/000002.ply"},
    {"ChangesTuw", kNothing, kChangesTuw, 0, "", "out/cloud_02.png"},
    {"ChangesTum", kNothing, kChangesTum, 0, "", "out"},
    {"Convert", kNothing, kConvert, 0, "", "out"},
    {"Evaluate", kNothing, kEvaluate, 0, "", "out/results.json"},
    {"EvaluateWithTheKOfItsSettings", write("c.toml", "num_previous_views = 1\n"),
     "evaluate --models models.resight --dataset views --presets mvr --config c.toml --out out", 0, "",
     "out/runs/views.mvr.k1.json"},
    {"EvaluateWithSettingsThatAPresetLacks", write("c.toml", "[changes]\nsigmas = 3\n"),
     "evaluate --models models.resight --dataset views --presets mvr --config c.toml --out out", 2,
     "c\\.toml: changes\\.sigmas has no effect unless changes\\.enabled = true \\(preset mvr\\)"},
    {"EvaluateTwiceWithoutClustering", write("c.toml", "[hypotheses.cluster]\nenabled = false\n"),
     "evaluate --models models.resight --dataset views --config c.toml --without-clustering --out out", 2,
     "--without-clustering: has no effect, because the settings do without clustering"},
    {"Train", kNothing, kTrain, 0, "", "new.resight"},

    // The command line.
    {"NoCommand", kNothing, "", 2, "no command was given .*recognize"},
    {"UnknownCommand", kNothing, "nonsense", 2, "unknown command 'nonsense' .*recognize"},
    {"UnknownOptionBeforeTheCommand", kNothing, "--nonsense", 2, "unknown option '--nonsense'"},
    {"UnknownOption", kNothing, "changes --sequence views --out out --nonsense", 2, "changes: .*--nonsense"},
    {"MissingOption", kNothing, "changes --sequence views", 2, "changes: --out is required"},
    {"MisspeltOption", kNothing, "changes --seqence views --out out", 2,
     "changes: unexpected '--seqence'; --sequence is required"},
    {"ArgumentInPlaceOfAnOption", kNothing, "changes views", 2, "changes: unexpected 'views'; --"},
    {"OptionWithoutValue", kNothing, "changes --sequence views --out", 2, "changes: --out"},
    {"UnknownPreset", kNothing, "changes --sequence views --out out --preset best", 2, "best .*mvr-chd"},
    {"NegativeK", kNothing, "changes --sequence views --out out -k -1", 2, "-1 .*0"},
    {"BrokenK", kNothing, "changes --sequence views --out out -k 1.5", 2, "1\\.5"},
    {"KThatIsAWord", kNothing, "changes --sequence views --out out -k all", 2, "all"},
    {"NoThreads", kNothing, "changes --sequence views --out out -j 0", 2, "0 .*1"},
    {"NegativeSeed", kNothing, "recognize --models models.resight --sequence views --out out --seed -1", 2, "seed"},
    {"NegativeDeadline", kNothing, "recognize --models models.resight --sequence views --out out --deadline-ms -1", 2,
     "deadline-ms: -1 is not a number above 0"},
    {"DeadlineThatIsNoNumber", kNothing,
     "recognize --models models.resight --sequence views --out out --deadline-ms nan", 2,
     "nan is not a number above 0"},
    {"ViewsFromNan", kNothing, "info tum --from nan", 2, "--from: nan is not a number of seconds"},
    {"ViewsUntilInfinity", kNothing, "info tum --until inf", 2, "--until: inf is not a number of seconds"},
    {"CheckWithoutLibraryOfADamagedView", cut("views/depth/000002.png", 0.5), "check views --models no.resight", 2,
     "no\\.resight: no such file"},
    {"TimeDifferenceOfNan", kNothing, "info views --max-time-difference-ms nan", 2, "nan is not a number"},
    {"NameWithEscapeSequences", kNothing,
     "changes --sequence \"$(printf 'no\\033[31mwhere\\nresight: done')\" --out out", 2,
     "no\\\\x1b\\[31mwhere\\\\x0aresight: done: no such"},
    {"ZeroDeadline", kNothing, "recognize --models models.resight --sequence views --out out --deadline-ms 0", 2,
     "deadline-ms"},
    {"SeedThatIsTooLarge", kNothing, "demo --out out --seed 99999999999999999999", 2, "seed"},
    {"UnknownFormat", kNothing, "convert views out --to png", 2, "png .*bop"},
    {"UnknownScene", kNothing, "simulate --preset nonsense --out out", 2, "nonsense"},
    {"TrackWithoutSequence", kNothing, "track --out poses.txt", 2, "--sequence"},
    {"TrackOfMissingSequence", kNothing, "track --sequence nowhere --out poses.txt", 2, "nowhere"},
    {"TrackByAnUnknownWay", kNothing, "track --sequence views --out poses.txt --poses guess", 2, "guess .*refine"},
    {"TrackOverData", kNothing, "track --sequence views --out poses.txt --write-sequence full", 2,
     "full: exists already"},
    {"TrackWithoutLibrary", kNothing, "track --sequence views --out poses.txt --models no.resight", 2, "no\\.resight"},
    {"TrackWithACloudThatIsAPicture", kNothing, "track --sequence views --out poses.txt --fused cloud.png", 2,
     "cloud\\.png: .*\\.ply"},
    {"TrackOfTinyViews", kNothing, "track --sequence views --out poses.txt", 2, "views: no two views could be joined"},
    {"ChangesOfTinyViewsWithoutPoses", kNothing, "changes --sequence views --poses auto --out out", 2,
     "views: no two views could be joined"},
    {"RecognizePosesByAnUnknownWay", kNothing, "recognize --models models.resight --sequence views --out out --poses x",
     2, "x .*auto"},
    {"ModelWithoutSequence", kNothing, "model --out out", 2, "--sequence"},
    {"ModelOfMissingSequence", kNothing, "model --sequence nowhere --out out", 2, "nowhere"},
    {"ModelOverData", kNothing, "model --sequence tuw --out full", 2, "full: exists already"},
    {"ModelOntoNothing", kNothing, "model --sequence tuw --onto nowhere --out out", 2, "nowhere"},
    {"ModelOntoASequence", kNothing, "model --sequence tuw --onto tuw --out out", 2, "tuw"},
    {"ModelOntoSmallViews",
     both(write("thing/views/cloud_1.pcd",
                "# camera 9 9 0.5 0.5\nVERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
                "WIDTH 2\nHEIGHT 2\nPOINTS 4\nDATA ascii\n"
                "-.05 -.05 .9 1\n.05 -.05 .9 1\n-.05 .05 .9 1\n.05 .05 .9 1\n"),
          both(write("thing/views/pose_1.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"),
               write("thing/views/object_indices_1.txt", "0\n"))),
     "model --sequence tuw --onto thing --out out", 2,
     "thing: view cloud_1: is 2 columns wide \\(expected 80 or more\\)"},
    {"ModelOfTinyViews", kNothing, "model --sequence tuw --out out", 2, "tuw: .*is 64 columns wide"},
    {"UnknownRecordedObject", kNothing, "simulate --preset turntable-recording --object nonsense --out out", 2,
     "nonsense"},
    {"ObjectOfAScene", kNothing, "simulate --preset demo --object mug --out out", 2, "--object"},
    {"RecordingsWithoutNoise", kNothing, "simulate --preset dynamic-tabletop-recordings --noise-free --out out", 2,
     "--noise-free does not apply to --preset dynamic-tabletop-recordings"},
    {"NoScene", kNothing, "simulate --out out", 2, "neither"},
    {"TwoScenes", kNothing, "simulate scene.toml --preset demo --out out", 2, "simulate: .*excludes"},

    {"UnknownPresets", kNothing, "evaluate --models models.resight --dataset views --presets mvr,best --out out", 2,
     "--presets: .*best"},
    {"NoPresets", kNothing, "evaluate --models models.resight --dataset views --presets '' --out out", 2,
     "--presets: ''"},
    {"BrokenRangeOfK", kNothing, "evaluate --models models.resight --dataset views -k 3-1 --out out", 2,
     "--previous-views: '3-1'"},
    {"BrokenShard", kNothing, "evaluate --models models.resight --dataset views --shard 3/2 --out out", 2,
     "--shard: '3/2'"},
    {"EmptyIntrinsics", kNothing, "changes --sequence views --out out --intrinsics ''", 2, "--intrinsics: ''"},
    {"EmptyShard", kNothing, "evaluate --models models.resight --dataset views --shard '' --out out", 2, "--shard: ''"},

    // Settings files.
    {"MissingConfig", kNothing, "changes --sequence views --out out --config no.toml", 2, "no\\.toml: no such file"},
    {"ConfigWithAKeyOfManyParts", write("c.toml", kLongKey.c_str()),
     "changes --sequence views --out out --config c.toml", 2, "line 2: a key has more than 100 parts"},
    {"ConfigWithAKeyOfManyQuotedParts", write("c.toml", kLongQuotedKey.c_str()),
     "changes --sequence views --out out --config c.toml", 2, "line 2: a key has more than 100 parts"},
    {"FileOfTheKernelAsConfig", kNothing, "changes --sequence views --out out --config /proc/self/status", 2,
     "/proc/self/status: is not a file"},
    {"ConfigWithALongUnknownKey", write("c.toml", kLongUnknownKey.c_str()),
     "changes --sequence views --out out --config c.toml", 2, "unknown key k{100}\\.\\. of 50000 bytes"},
    {"FolderAsConfig", kNothing, "changes --sequence views --out out --config empty", 2, "empty: "},
    {"ConfigThatIsNoToml", write("c.toml", "[changes\n"), "changes --sequence views --out out --config c.toml", 2,
     "c\\.toml: line 1"},
    {"UnknownSetting", write("c.toml", "[changes]\nspeed = 1\n"), "changes --sequence views --out out --config c.toml",
     2, "c\\.toml: unknown key changes\\.speed"},
    {"SettingOutOfRange", write("c.toml", "[changes]\nvoxel_m = -0.01\n"),
     "changes --sequence views --out out --config c.toml", 2, "c\\.toml: .*voxel_m = -0\\.01"},

    {"PipeAsConfig", pipe("c.toml"), "changes --sequence views --out out --config c.toml", 2,
     "c\\.toml: is not a file"},
    {"EndlessConfig", kNothing, "changes --sequence views --out out --config /dev/zero", 2, "/dev/zero: is not a file"},
};

INSTANTIATE_TEST_SUITE_P(Arguments, CommandLine, testing::ValuesIn(kArgumentRows), name_of_row);

}  // namespace
}  // namespace resight::cli_test
