// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <string>

#include "resight/io/model_source.hpp"
#include "resight/training/training.hpp"

namespace resight {

/// Trains from all data of an object in a data set.
/// - Features: from its views; without views, from a turntable around its mesh, else around its complete cloud.
/// - Surface: from its mesh, else from its complete cloud (if there are views, only a coloured one), else fused from
///   its views.
/// - Name and bop_id (0 stays 0): from the source.
/// - Symmetries: from the source if it declares them (also if it declares none), else by find_symmetries().
/// - Symmetries of the shape alone: by find_symmetries() for each surface with colours.
/// TrainOptions::find_symmetries = false skips both searches.
[[nodiscard]] Result<ObjectModel> train_object(const ModelSource& source, const TrainOptions& options = {});

/// Called before each object with its index (from 0), the number of objects and its name.
using TrainProgress = std::function<void(int index, int count, const std::string& name)>;

/// Called with one line for each problem of a model: a line of ModelSource::warnings, that the object has no features
/// and cannot be recognised, or that it is larger than objects on tables and shelves are.
using TrainWarning = std::function<void(const std::string& line)>;

/// Reads and trains all locations one by one (the views of each object are processed in parallel). Names and given
/// bop_ids must be unique. Objects without a bop_id get the lowest free numbers from 1, in order. Stops at the first
/// failure.
[[nodiscard]] Result<ModelLibrary> train_library(std::span<const ModelLocation> locations,
                                                 const TrainOptions& options = {}, const TrainProgress& progress = {},
                                                 const TrainWarning& warning = {});

/// Replaces bop_ids of 0 by the lowest free numbers. Fails if two objects have the same name or the same given id, or
/// an id is negative.
[[nodiscard]] Result<void> assign_bop_ids(std::vector<ObjectModel>& objects);

}  // namespace resight
