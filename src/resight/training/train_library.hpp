// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <string>

#include "resight/io/model_source.hpp"
#include "resight/training/training.hpp"

namespace resight {

/// Trains from what a data set holds of an object. Features: of its views, or of a turntable around its mesh (else its
/// complete cloud) if it has none. Surface: of its mesh, else its complete cloud (if that has colours), else fused from
/// the views.
/// The name and the bop_id (0 stays 0) are the source's, and so are the symmetries if it declares them (be it that
/// there are none); else they are found from the surface (find_symmetries()).
[[nodiscard]] Result<ObjectModel> train_object(const ModelSource& source, const TrainOptions& options = {});

/// Called before each object with its place (0 ..), the number of objects and its name.
using TrainProgress = std::function<void(int index, int count, const std::string& name)>;

/// Called with one line on what is amiss with a model: those of ModelSource::warnings, or that it has no features and
/// so can never be recognised.
using TrainWarning = std::function<void(const std::string& line)>;

/// Reads and trains every location, one after the other (the views of an object are spread over the threads). Names
/// must be unique, and so must the bop_ids that are given; objects without one get the lowest free numbers from 1 on,
/// in order. The first failure ends it.
[[nodiscard]] Result<ModelLibrary> train_library(std::span<const ModelLocation> locations,
                                                 const TrainOptions& options = {}, const TrainProgress& progress = {},
                                                 const TrainWarning& warning = {});

/// Fills the bop_ids that are 0 as above. An error if two objects have the same name or the same given id, or an id is
/// negative.
[[nodiscard]] Result<void> assign_bop_ids(std::vector<ObjectModel>& objects);

}  // namespace resight
