// SPDX-License-Identifier: Apache-2.0
// Matches descriptors of a view against those of a library. Only the search is timed, not the construction of the
// indices.
#include <fmt/format.h>

#include <algorithm>
#include <opencv2/features2d.hpp>

#include "contest.hpp"
#include "pcl/pcl_peers.hpp"
#include "resight/features/descriptor_index.hpp"
#include "stages.hpp"

namespace resight::bench {
namespace {

constexpr std::size_t kMaxQueries = 500;  // An exact search for all descriptors of a view takes minutes.

struct MatchingContest {
  int dimension = 0;
  std::vector<float> indexed, queries;
  std::vector<float> nearest_sq;  // Per query, by exact search.
  std::vector<Contestant> contestants;

  [[nodiscard]] std::size_t num_queries() const { return queries.size() / static_cast<std::size_t>(dimension); }
  [[nodiscard]] std::span<const float> row(const std::vector<float>& rows, std::size_t i) const {
    return std::span(rows).subspan(i * static_cast<std::size_t>(dimension), static_cast<std::size_t>(dimension));
  }
};

float distance_sq(std::span<const float> a, std::span<const float> b) {
  float sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

// A match is right if it is as near as the nearest neighbour, because a library contains equal descriptors.
std::string recall(const MatchingContest& contest, const std::vector<int>& found) {
  std::size_t num_right = 0;
  for (std::size_t q = 0; q < found.size(); ++q) {
    if (found[q] < 0) continue;
    const float d =
        distance_sq(contest.row(contest.queries, q), contest.row(contest.indexed, static_cast<std::size_t>(found[q])));
    num_right += d <= contest.nearest_sq[q] * 1.0001F + 1e-6F ? 1 : 0;
  }
  return fmt::format("recall {:.1f} %", 100.0 * static_cast<double>(num_right) / static_cast<double>(found.size()));
}

void add(MatchingContest& contest, const std::string& name, std::function<double(std::vector<int>&)> search) {
  const auto found = std::make_shared<std::vector<int>>();
  contest.contestants.push_back({name, [found, search = std::move(search)] { return search(*found); },
                                 [&contest, found] { return recall(contest, *found); }});
}

void add_ours(MatchingContest& contest, const std::string& name, const DescriptorIndexOptions& options) {
  const auto index = std::make_shared<DescriptorIndex>(contest.indexed, contest.dimension, options);
  add(contest, name, [&contest, index](std::vector<int>& found) {
    std::vector<DescriptorMatch> matches;
    const double cpu_s = cpu_time_s([&] { matches = index->search(contest.queries, 1); });
    found.clear();
    for (const DescriptorMatch& m : matches) found.push_back(m.index);
    return cpu_s;
  });
}

void add_opencv(MatchingContest& contest, const std::string& name, const cv::Ptr<cv::DescriptorMatcher>& matcher) {
  const auto as_matrix = [&contest](std::vector<float>& values) {
    return cv::Mat(static_cast<int>(values.size()) / contest.dimension, contest.dimension, CV_32F, values.data());
  };
  matcher->add(std::vector<cv::Mat>{as_matrix(contest.indexed)});
  matcher->train();
  add(contest, name, [&contest, matcher, as_matrix](std::vector<int>& found) {
    std::vector<cv::DMatch> matches;
    const double cpu_s = cpu_time_s([&] { matcher->match(as_matrix(contest.queries), matches); });
    found.assign(contest.num_queries(), -1);
    for (const cv::DMatch& m : matches) found[static_cast<std::size_t>(m.queryIdx)] = m.trainIdx;
    return cpu_s;
  });
}

cv::Ptr<cv::DescriptorMatcher> make_flann(int num_leaves) {
  return cv::makePtr<cv::FlannBasedMatcher>(cv::makePtr<cv::flann::KDTreeIndexParams>(4),
                                            cv::makePtr<cv::flann::SearchParams>(num_leaves));
}

void add_pcl(MatchingContest& contest) {
  add(contest, "PCL KdTreeFLANN, exact", [&contest](std::vector<int>& found) {
    auto result = pcl_peers::nearest_shot(contest.indexed, contest.queries);
    found = std::move(result.value);
    return result.cpu_s;
  });
}

MatchingContest make_contest(const FeatureSet& features, CodedFeatures ObjectModel::*of_model,
                             const ModelLibrary& library) {
  MatchingContest contest;
  contest.dimension = features.dimension;
  for (const ObjectModel& object : library.objects) {
    const std::vector<float> rows = decode(object.*of_model).descriptors;
    contest.indexed.insert(contest.indexed.end(), rows.begin(), rows.end());
  }
  const std::size_t step = features.size() / kMaxQueries + 1;
  for (std::size_t i = 0; i < features.size(); i += step) {
    const auto row = features.descriptor(i);
    contest.queries.insert(contest.queries.end(), row.begin(), row.end());
  }
  const DescriptorIndex exact(contest.indexed, contest.dimension, {.search = IndexSearch::kExact});
  for (const DescriptorMatch& m : exact.search(contest.queries, 1)) contest.nearest_sq.push_back(m.distance_sq);
  return contest;
}

void run(const std::string& name, MatchingContest& contest, const DescriptorIndexOptions& options) {
  if (contest.queries.empty() || contest.indexed.empty()) return;
  add_ours(contest, "resight", options);
  add_ours(contest, "resight, exact", {.search = IndexSearch::kExact});
  cv::setRNGSeed(1);
  for (const int num_leaves : {32, 128, 512})
    add_opencv(contest, fmt::format("OpenCV FlannBasedMatcher, 4 trees, {} leaves", num_leaves),
               make_flann(num_leaves));
  add_opencv(contest, "OpenCV BFMatcher, exact", cv::makePtr<cv::BFMatcher>(cv::NORM_L2));
  if (contest.dimension == 352) add_pcl(contest);
  compare(fmt::format("matching, {} {} against {}", contest.num_queries(), name,
                      contest.indexed.size() / static_cast<std::size_t>(contest.dimension)),
          contest.contestants);
}

}  // namespace

void compare_matching(const StageInput& input) {
  const int num_threads_before = cv::getNumThreads();
  cv::setNumThreads(1);
  MatchingContest sift = make_contest(input.sift, &ObjectModel::sift, input.library);
  run("SIFT", sift, input.config.features.match.sift_index);
  MatchingContest shot = make_contest(input.shot, &ObjectModel::shot, input.library);
  run("SHOT", shot, input.config.features.match.shot_index);
  cv::setNumThreads(num_threads_before);
}

}  // namespace resight::bench
