// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/maximal_cliques.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// A vertex in this many greedy cliques gets none of its own; in a dense region they would all be alike.
constexpr int kMaxGreedyCliques = 3;

using Words = std::vector<std::uint64_t>;

void set_bit(std::uint64_t* words, int i) { words[i / 64] |= std::uint64_t{1} << (static_cast<unsigned>(i) % 64); }
void clear_bit(std::uint64_t* words, int i) { words[i / 64] &= ~(std::uint64_t{1} << (static_cast<unsigned>(i) % 64)); }

int count(const std::uint64_t* a, int num_words) {
  int sum = 0;
  for (int w = 0; w < num_words; ++w) sum += std::popcount(a[w]);
  return sum;
}

int count_common(const std::uint64_t* a, const std::uint64_t* b, int num_words) {
  int sum = 0;
  for (int w = 0; w < num_words; ++w) sum += std::popcount(a[w] & b[w]);
  return sum;
}

template <typename Body>
void for_each_bit(const std::uint64_t* words, int num_words, Body&& body) {
  for (int w = 0; w < num_words; ++w)
    for (std::uint64_t word = words[w]; word != 0; word &= word - 1) body(w * 64 + std::countr_zero(word));
}

// Recursion of Bron and Kerbosch. All sets live in one arena: three rows of bits per level.
class CliqueSearch {
 public:
  CliqueSearch(const BitGraph& graph, const Degeneracy& degeneracy, const FindCliquesOptions& options,
               FindCliquesResult& result)
      : graph_(graph), options_(options), result_(result), num_words_(graph.num_words()) {
    const int depth = *std::max_element(degeneracy.core.begin(), degeneracy.core.end()) + 3;
    arena_.assign(static_cast<std::size_t>(depth) * 3 * static_cast<std::size_t>(num_words_), 0);
  }

  // Finds all cliques whose first vertex in the order is `v`; false if the budget is exhausted.
  bool search_from(int v, const Words& later) {
    clique_.assign(1, v);
    const std::uint64_t* neighbors = graph_.row(v).data();
    for (int w = 0; w < num_words_; ++w) {
      candidates(1)[w] = neighbors[w] & later[static_cast<std::size_t>(w)];
      excluded(1)[w] = neighbors[w] & ~later[static_cast<std::size_t>(w)];
    }
    return extend(1);
  }

 private:
  std::uint64_t* set_at(int depth, int which) {
    return arena_.data() + (static_cast<std::size_t>(depth) * 3 + static_cast<std::size_t>(which)) *
                               static_cast<std::size_t>(num_words_);
  }
  std::uint64_t* candidates(int depth) { return set_at(depth, 0); }
  std::uint64_t* excluded(int depth) { return set_at(depth, 1); }
  std::uint64_t* branches(int depth) { return set_at(depth, 2); }

  // Vertex with the most neighbours among the candidates (ties: smallest index). Only candidates that are not its
  // neighbours need a branch of their own.
  int choose_pivot(int depth) {
    int pivot = -1;
    int best = -1;
    const auto consider = [&](int u) {
      const int common = count_common(candidates(depth), graph_.row(u).data(), num_words_);
      if (common > best) {
        best = common;
        pivot = u;
      }
    };
    for_each_bit(candidates(depth), num_words_, consider);
    for_each_bit(excluded(depth), num_words_, consider);
    return pivot;
  }

  bool extend(int depth) {
    if (result_.num_steps >= options_.max_steps) return false;
    ++result_.num_steps;
    const int num_candidates = count(candidates(depth), num_words_);
    if (static_cast<int>(clique_.size()) + num_candidates < options_.min_size) return true;
    if (num_candidates == 0) {
      if (count(excluded(depth), num_words_) == 0) result_.cliques.push_back(clique_);
      return true;
    }
    const std::uint64_t* pivot_row = graph_.row(choose_pivot(depth)).data();
    for (int w = 0; w < num_words_; ++w) branches(depth)[w] = candidates(depth)[w] & ~pivot_row[w];
    bool complete = true;
    for_each_bit(branches(depth), num_words_, [&](int u) {
      if (complete) complete = branch(depth, u);
    });
    return complete;
  }

  bool branch(int depth, int u) {
    const std::uint64_t* row = graph_.row(u).data();
    for (int w = 0; w < num_words_; ++w) {
      candidates(depth + 1)[w] = candidates(depth)[w] & row[w];
      excluded(depth + 1)[w] = excluded(depth)[w] & row[w];
    }
    clique_.push_back(u);
    const bool complete = extend(depth + 1);
    clique_.pop_back();
    clear_bit(candidates(depth), u);
    set_bit(excluded(depth), u);
    return complete;
  }

  const BitGraph& graph_;
  const FindCliquesOptions& options_;
  FindCliquesResult& result_;
  int num_words_;
  Words arena_;
  std::vector<int> clique_;
};

// Grows a clique from `seed` by the candidate with the most neighbours among the other candidates (ties: smallest
// index).
std::vector<int> greedy_clique(const BitGraph& graph, int seed, Words& candidates) {
  const int num_words = graph.num_words();
  std::copy_n(graph.row(seed).begin(), num_words, candidates.begin());
  std::vector<int> clique{seed};
  for (;;) {
    int next = -1;
    int best = -1;
    for_each_bit(candidates.data(), num_words, [&](int u) {
      const int common = count_common(candidates.data(), graph.row(u).data(), num_words);
      if (common > best) {
        best = common;
        next = u;
      }
    });
    if (next < 0) return clique;
    clique.push_back(next);
    for (int w = 0; w < num_words; ++w)
      candidates[static_cast<std::size_t>(w)] &= graph.row(next)[static_cast<std::size_t>(w)];
  }
}

void sort_cliques(std::vector<std::vector<int>>& cliques) {
  for (auto& clique : cliques) std::sort(clique.begin(), clique.end());
  std::sort(cliques.begin(), cliques.end(),
            [](const auto& a, const auto& b) { return a.size() != b.size() ? a.size() > b.size() : a < b; });
  cliques.erase(std::unique(cliques.begin(), cliques.end()), cliques.end());
}

}  // namespace

void FindCliquesOptions::check() const {
  check_positive("FindCliquesOptions.min_size", min_size);
  check_not_negative("FindCliquesOptions.max_steps", max_steps);
}

FindCliquesResult find_cliques(const BitGraph& graph, const FindCliquesOptions& options) {
  options.check();
  FindCliquesResult result;
  if (graph.num_vertices() == 0) return result;
  const Degeneracy degeneracy = degeneracy_order(graph);
  const auto wide_enough = [&](int v) { return degeneracy.core[static_cast<std::size_t>(v)] + 1 >= options.min_size; };
  CliqueSearch search(graph, degeneracy, options, result);
  Words later(static_cast<std::size_t>(graph.num_words()), 0);
  Words scratch(later.size());
  // Number of greedy cliques per vertex.
  std::vector<int> num_greedy(static_cast<std::size_t>(graph.num_vertices()), 0);
  // Core numbers rise along the order; backwards, the first vertex with too low a core number ends the search.
  for (auto v = degeneracy.order.rbegin(); v != degeneracy.order.rend() && wide_enough(*v); ++v) {
    if (result.complete) result.complete = search.search_from(*v, later);
    if (!result.complete && num_greedy[static_cast<std::size_t>(*v)] < kMaxGreedyCliques) {
      std::vector<int> clique = greedy_clique(graph, *v, scratch);
      for (const int u : clique) ++num_greedy[static_cast<std::size_t>(u)];
      if (static_cast<int>(clique.size()) >= options.min_size) result.cliques.push_back(std::move(clique));
    }
    set_bit(later.data(), *v);
  }
  sort_cliques(result.cliques);
  return result;
}

}  // namespace resight
