// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "commands.hpp"
#include "evaluation_plan.hpp"
#include "output_paths.hpp"
#include "progress.hpp"
#include "recognition_run.hpp"
#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"
#include "resight/evaluation/bop_evaluation.hpp"
#include "resight/evaluation/evaluate_sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/report/evaluation_report.hpp"
#include "resight/report/worst_views.hpp"
#include "resight/training/training.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

constexpr double kMergeWait_s = 60;
constexpr int kNumPictures = 5;  // Of the worst views per configuration.

class Evaluation {
 public:
  explicit Evaluation(const EvaluateArguments& arguments)
      : arguments_(arguments),
        library_(value_or_throw(load_library(arguments.models, TrainOptions{}.hash()))),
        plan_(make_evaluation_plan(arguments)) {
    if (!arguments.bop) return;
    bop_objects_ = value_or_throw(read_bop_objects(plan_.models, library_));
    if (bop_objects_->empty()) throw InputError(fmt::format("--bop: {} has no meshes", plan_.models.string()));
  }

  // Computes the missing runs of this shard. Finished runs are not computed again.
  void compute() {
    std::vector<const EvaluationUnit*> mine;
    for (const EvaluationUnit& unit : plan_.units)
      if (unit.shard == arguments_.shard && !stored_run(unit)) mine.push_back(&unit);
    if (mine.empty()) return;
    std::size_t num_views = 0;
    std::set<std::string> checked;
    for (const EvaluationUnit* unit : mine) {
      const auto sequence = value_or_throw(open_posed_sequence(unit->sequence.folder));
      if (!sequence->has_ground_truth())
        throw InputError(fmt::format("{}: has no ground truth to evaluate against", unit->sequence.folder.string()));
      num_views += static_cast<std::size_t>(sequence->num_views());
      if (!checked.insert(unit->sequence.name).second) continue;
      print_notes(*sequence, unit->sequence.name);
      warn_about_faults(*sequence, true, unit->sequence.name);
    }
    Progress progress("evaluate", static_cast<int>(num_views));
    int done = 0;
    for (std::size_t i = 0; i < mine.size();) {
      // Runs that share views and hypotheses are consecutive.
      const std::size_t first = i;
      while (i < mine.size() && mine[i]->group == mine[first]->group) ++i;
      compute_group(std::span(mine).subspan(first, i - first), progress, done);
    }
  }

  // Writes the results if all runs are present; otherwise reports the missing ones.
  void conclude() const {
    std::vector<EvaluatedRun> runs;
    std::vector<const EvaluationUnit*> missing;
    for (const EvaluationUnit& unit : plan_.units) {
      auto run = stored_run(unit);
      if (run) run->sequence = unit.sequence.name;  // JSON cannot hold every name of a folder
      if (run) runs.push_back(std::move(*run));
      if (!run) missing.push_back(&unit);
    }
    if (!missing.empty()) return report_missing(missing);
    // All tables of one evaluation appear together. Shards that end at the same time wait for each other.
    auto folder = value_or_throw(PendingDirectory::create(arguments_.out, ExistingFolder::kFill, kMergeWait_s));
    const std::set<std::string> pictures = draw_worst_views(runs, folder.path());
    value_or_throw(write_evaluation(folder.path(), {plan_.dataset_name, RESIGHT_VERSION}, runs, kNumPictures));
    const std::string bop = arguments_.bop ? write_bop(runs, folder.path()) : "";
    value_or_throw(folder.commit());
    remove_old_results(pictures);
    print_table(runs);
    print_text(bop);
  }

 private:
  [[nodiscard]] std::filesystem::path file_of(const EvaluationUnit& unit) const {
    return arguments_.out / "runs" / (unit.name + ".json");
  }

  // Anybody may have written a stored run: views and objects that are not there would end the work late.
  [[nodiscard]] bool belongs_to(const EvaluationUnit& unit, const EvaluatedRun& run) const {
    const auto is_known = [this](const EvaluatedDetection& d) { return library_.find(d.object) >= 0; };
    const RecognizerConfig& config = unit.config;
    return run.fingerprint == unit.fingerprint && run.preset == config.preset &&
           run.num_previous_views == config.num_previous_views &&
           run.is_clustered == config.hypotheses.cluster.has_value() &&
           static_cast<int>(run.views.size()) == unit.sequence.num_views &&
           std::ranges::all_of(
               run.views, [&](const EvaluatedView& view) { return std::ranges::all_of(view.detections, is_known); });
  }

  // The stored run of a unit, unless it is missing or stems from other settings, models or another version.
  [[nodiscard]] std::optional<EvaluatedRun> stored_run(const EvaluationUnit& unit) const {
    const std::filesystem::path file = file_of(unit);
    const auto text = read_file(file);
    if (!text) return std::nullopt;
    auto run = parse_run(*text, file.string());
    if (!run.ok() || !belongs_to(unit, *run)) return std::nullopt;
    return std::move(run).value();
  }

  void compute_group(std::span<const EvaluationUnit* const> units, Progress& progress, int& done) {
    const EvaluationSequence& where = units.front()->sequence;
    const auto sequence = value_or_throw(open_posed_sequence(where.folder));
    const SequenceTruth truth =
        value_or_throw(read_sequence_truth(*sequence, library_, where.changes, where.unknown_models));
    warn_about_names(truth, where.folder.string());
    EvaluateSequenceOptions options;
    options.hypotheses = std::make_shared<ViewHypothesisStore>();
    for (const EvaluationUnit* unit : units) {
      options.progress = [&](int, const EvaluatedView& view) {
        progress.report(++done, fmt::format("{} {}: {} right, {} wrong, {} missed, {:.2f} s", unit->name, view.name,
                                            view.score.true_positives, view.score.false_positives,
                                            view.score.false_negatives, view.times.total_wall_s()));
      };
      EvaluatedRun run = value_or_throw(evaluate_sequence(*sequence, truth, library_, unit->config, options));
      run.sequence = where.name;
      run.fingerprint = unit->fingerprint;
      run.num_threads = arguments_.num_threads;
      value_or_throw(write_file(file_of(*unit), format_run(run)));
    }
  }

  [[nodiscard]] Result<std::unique_ptr<Sequence>> open_evaluated(const std::string& name) const {
    const auto unit = std::ranges::find(plan_.units, name,
                                        [](const EvaluationUnit& u) -> const std::string& { return u.sequence.name; });
    return open_posed_sequence(unit->sequence.folder);
  }

  // Of earlier evaluations into the same folder.
  void remove_old_results(const std::set<std::string>& pictures) const {
    std::error_code error;
    if (!arguments_.bop) std::filesystem::remove(arguments_.out / "bop.md", error);
    std::vector<std::filesystem::path> old;
    for (std::filesystem::directory_iterator it(arguments_.out / "worst", error), end; !error && it != end;
         it.increment(error))
      if (it->path().extension() == ".jpg" && !pictures.contains("worst/" + it->path().filename().string()))
        old.push_back(it->path());
    for (const std::filesystem::path& picture : old) std::filesystem::remove(picture, error);
  }

  // Returns the names of the pictures.
  std::set<std::string> draw_worst_views(const std::vector<EvaluatedRun>& runs,
                                         const std::filesystem::path& folder) const {
    std::set<std::string> pictures;
    std::map<std::string, SequenceTruth> truths;  // By sequence.
    for (const WorstView& worst : find_worst_views(runs, kNumPictures)) {
      const auto sequence = value_or_throw(open_evaluated(worst.run->sequence));
      const RgbdFrame frame = value_or_throw(sequence->read_view(worst.view));
      if (!truths.contains(worst.run->sequence))
        truths[worst.run->sequence] = value_or_throw(read_sequence_truth(*sequence, library_));
      const auto& objects = truths[worst.run->sequence].views[static_cast<std::size_t>(worst.view)].objects;
      const auto jpeg = encode_jpeg(draw_evaluated_view(frame, library_, objects, worst.evaluated()));
      pictures.insert(worst_view_picture(worst));
      value_or_throw(write_file(folder / worst_view_picture(worst),
                                std::string_view(reinterpret_cast<const char*>(jpeg.data()), jpeg.size())));
    }
    return pictures;
  }

  // Returns the text to be printed.
  std::string write_bop(const std::vector<EvaluatedRun>& runs, const std::filesystem::path& folder) const {
    const auto open = [this](const std::string& name) { return open_evaluated(name); };
    const std::string table = format_bop_table(value_or_throw(evaluate_bop(runs, *bop_objects_, library_, open)));
    value_or_throw(write_file(folder / "bop.md", table));
    return "\n" + table;
  }

  void report_missing(const std::vector<const EvaluationUnit*>& missing) const {
    std::vector<int> shards;
    for (const EvaluationUnit* unit : missing) shards.push_back(unit->shard);
    std::ranges::sort(shards);
    shards.erase(std::unique(shards.begin(), shards.end()), shards.end());
    std::string again;
    for (const int shard : shards) again += fmt::format(" {}/{}", shard, arguments_.num_shards);
    const std::string what = fmt::format("{} of {} runs are missing (first: {}); run with --shard{}", missing.size(),
                                         plan_.units.size(), missing.front()->name, again);
    if (arguments_.merge) throw InputError(fmt::format("{}: {}", arguments_.out.string(), what));
    print("{}\n", what);
  }

  void print_table(const std::vector<EvaluatedRun>& runs) const {
    print("\n{:<10} {:>2} {:>9} {:>7} {:>7} {:>9} {:>7} {:>7} {:>10}\n", "preset", "K", "precision", "recall", "F",
          "strict F", "ghosts", "/place", "s/view");
    for (const ConfigurationSummary& c : summarize_runs(runs))
      print("{:<10} {:>2} {:>9} {:>7} {:>7} {:>9} {:>7} {:>7} {:>10.2f}{}\n", c.preset, c.num_previous_views,
            format_share(c.score.precision()), format_share(c.score.recall()), format_share(c.score.f_score()),
            format_share(c.strict_score.f_score()), c.ghosts.num_detections,
            std::isnan(c.ghosts.per_former_place()) ? "-" : fmt::format("{:.2f}", c.ghosts.per_former_place()),
            c.times.stages.total_wall_s() / c.num_views, c.is_clustered ? "" : "  without clustering");
    print("\ntables: {}\n", (arguments_.out / "tables.md").string());
  }

  const EvaluateArguments& arguments_;
  ModelLibrary library_;  // Loaded first: the plan hashes its file.
  EvaluationPlan plan_;
  std::optional<std::map<std::string, BopObject>> bop_objects_;  // With --bop.
};

}  // namespace

void run_evaluate(const EvaluateArguments& arguments) {
  check_output_folder(arguments.out, "evaluate", {arguments.dataset, arguments.models});
  for (const char* folder : {"runs", "worst"})
    value_or_throw(check_writable_folder(arguments.out / folder, ExistingFolder::kFill));
  // Another command that is filling the folder would refuse the tables after all the work.
  const double wait_s = arguments.num_shards > 1 ? kMergeWait_s : 0;
  static_cast<void>(value_or_throw(PendingDirectory::create(arguments.out, ExistingFolder::kFill, wait_s)));
  Evaluation evaluation(arguments);
  if (!arguments.merge) evaluation.compute();
  evaluation.conclude();
}

}  // namespace resight::app
