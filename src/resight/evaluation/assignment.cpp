// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr double kUnreachable = std::numeric_limits<double>::infinity();

/// A cost table with at least as many columns as rows: that of the caller, or its transpose. Forbidden pairs cost more
/// than all allowed pairs together, so that the cheapest assignment of all rows has as many allowed pairs as possible.
class WideCost {
 public:
  WideCost(std::span<const double> cost, int num_rows, int num_columns)
      : cost_(cost), num_given_columns_(num_columns), is_transposed_(num_rows > num_columns) {
    double largest = 0;
    for (const double value : cost)
      if (!std::isnan(value)) largest = std::max(largest, value);
    rows = std::min(num_rows, num_columns);
    columns = std::max(num_rows, num_columns);
    forbidden_ = (largest + 1.0) * (columns + 1);
  }
  [[nodiscard]] double at(int row, int column) const {
    const double value = is_transposed_ ? given(column, row) : given(row, column);
    return std::isnan(value) ? forbidden_ : value;
  }
  [[nodiscard]] bool is_forbidden(int row, int column) const { return at(row, column) == forbidden_; }
  [[nodiscard]] bool is_transposed() const { return is_transposed_; }
  int rows = 0;
  int columns = 0;

 private:
  [[nodiscard]] double given(int row, int column) const {
    return cost_[static_cast<std::size_t>(row) * static_cast<std::size_t>(num_given_columns_) +
                 static_cast<std::size_t>(column)];
  }
  std::span<const double> cost_;
  int num_given_columns_;
  bool is_transposed_;
  double forbidden_ = 0;
};

/// Hungarian method: rows are added one by one, each along the cheapest augmenting path in the reduced costs.
class HungarianSolver {
 public:
  explicit HungarianSolver(const WideCost& cost)
      : cost_(cost),
        row_potential_(static_cast<std::size_t>(cost.rows), 0.0),
        column_potential_(slots(), 0.0),
        row_of_column_(slots(), -1),
        previous_column_(slots(), -1) {}

  std::vector<int> solve() {
    for (int row = 0; row < cost_.rows; ++row) add_row(row);
    return row_of_column_;
  }

 private:
  [[nodiscard]] std::size_t slots() const { return static_cast<std::size_t>(cost_.columns); }

  void add_row(int start_row) {
    std::vector<double> slack(slots(), kUnreachable);
    std::vector<char> reached(slots(), 0);
    std::fill(previous_column_.begin(), previous_column_.end(), -1);
    row_potential_[static_cast<std::size_t>(start_row)] = 0;
    int row = start_row;
    int from_column = -1;
    while (true) {
      const int next = relax(row, from_column, reached, slack);
      const double step = slack[static_cast<std::size_t>(next)];
      shift_potentials(start_row, step, reached, slack);
      reached[static_cast<std::size_t>(next)] = 1;
      if (row_of_column_[static_cast<std::size_t>(next)] < 0) return flip_path(next, start_row);
      from_column = next;
      row = row_of_column_[static_cast<std::size_t>(next)];
    }
  }

  /// Updates the slack of the columns that have not been reached, from `row`; returns the column with the least slack.
  int relax(int row, int from_column, const std::vector<char>& reached, std::vector<double>& slack) {
    int best = -1;
    for (int column = 0; column < cost_.columns; ++column) {
      const auto c = static_cast<std::size_t>(column);
      if (reached[c]) continue;
      const double reduced =
          cost_.at(row, column) - row_potential_[static_cast<std::size_t>(row)] - column_potential_[c];
      if (reduced < slack[c]) {
        slack[c] = reduced;
        previous_column_[c] = from_column;
      }
      if (best < 0 || slack[c] < slack[static_cast<std::size_t>(best)]) best = column;
    }
    return best;
  }

  void shift_potentials(int start_row, double step, const std::vector<char>& reached, std::vector<double>& slack) {
    row_potential_[static_cast<std::size_t>(start_row)] += step;
    for (std::size_t c = 0; c < slots(); ++c) {
      if (reached[c]) {
        row_potential_[static_cast<std::size_t>(row_of_column_[c])] += step;
        column_potential_[c] -= step;
      } else {
        slack[c] -= step;
      }
    }
  }

  void flip_path(int free_column, int start_row) {
    int column = free_column;
    while (column >= 0) {
      const int previous = previous_column_[static_cast<std::size_t>(column)];
      row_of_column_[static_cast<std::size_t>(column)] =
          previous < 0 ? start_row : row_of_column_[static_cast<std::size_t>(previous)];
      column = previous;
    }
  }

  const WideCost& cost_;
  std::vector<double> row_potential_;
  std::vector<double> column_potential_;
  std::vector<int> row_of_column_;
  std::vector<int> previous_column_;
};

}  // namespace

std::vector<int> assign_optimally(std::span<const double> cost, int num_rows, int num_columns) {
  require(num_rows >= 0 && num_columns >= 0 &&
              cost.size() == static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(num_columns),
          "assign_optimally: cost must hold num_rows x num_columns values");
  for (const double value : cost) {
    require(std::isnan(value) || (value >= 0 && std::isfinite(value)),
            "assign_optimally: each cost must be finite and >= 0, or NaN");
  }
  std::vector<int> column_of_row(static_cast<std::size_t>(num_rows), -1);
  if (num_rows == 0 || num_columns == 0) return column_of_row;

  const WideCost wide(cost, num_rows, num_columns);
  const std::vector<int> row_of_column = HungarianSolver(wide).solve();
  for (int column = 0; column < wide.columns; ++column) {
    const int row = row_of_column[static_cast<std::size_t>(column)];
    if (row < 0 || wide.is_forbidden(row, column)) continue;
    column_of_row[static_cast<std::size_t>(wide.is_transposed() ? column : row)] = wide.is_transposed() ? row : column;
  }
  return column_of_row;
}

}  // namespace resight
