// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/annotation/annotation_action.hpp"
#include "resight/io/recognition_results.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// The first edit of an annotation that starts from the recogniser's output: the tracks that its events name, each with
/// one placement per place and between two removals. The pose is that of the best detection at the place. A track that
/// was found (not added) is there from the first view on; one that was not reported removed stays until the last view.
/// What the report of a move supersedes belongs to its track. Fails if the results name views or objects that are not
/// there, or the cameras were elsewhere. An edit without changes if nothing was recognised.
[[nodiscard]] Result<AnnotationEdit> detections_to_edit(const RecognitionResults& results, const Sequence& sequence,
                                                        const ModelLibrary& library);

}  // namespace resight
