// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "resight/sensor/sequence.hpp"

namespace resight {

/// The annotation files of one view of a TUW sequence, in either style.
struct TuwViewAnnotation {
  struct PoseFile {
    std::string object;
    int instance = 0;
    std::filesystem::path pose;
    std::filesystem::path occlusion;  ///< Empty if none.
  };
  std::vector<PoseFile> poses;  ///< Ordered by object, then instance.
  std::filesystem::path anno;   ///< `<view>.anno`; empty if none. Used only if there are no pose files.
  [[nodiscard]] bool empty() const { return poses.empty() && anno.empty(); }
};

/// Assigns the annotation files of `directory` to the views (by file stem). The number of digits in the view name of a
/// file may differ from that of the view. Ignores camera poses, times and results in the directory.
[[nodiscard]] std::vector<TuwViewAnnotation> find_tuw_annotations(const std::filesystem::path& directory,
                                                                  const std::vector<std::string>& views);

/// Finds the annotations of a sequence: in the sequence itself, in its sub-folder, or (for `<set>/<test>/<sequence>`)
/// in `<set>/annotations/<sequence>` and similar folders (docs/formats.md). Returns the first folder that annotates a
/// view, else `sequence`.
[[nodiscard]] std::filesystem::path find_tuw_annotation_directory(const std::filesystem::path& sequence,
                                                                  const std::vector<std::string>& views);

/// Reads the annotation of one view. visible_share = 1 - occlusion; NaN without an occlusion file.
[[nodiscard]] Result<std::vector<GroundTruthObject>> read_tuw_annotation(const TuwViewAnnotation& annotation);
/// Parses lines `<name> (<visible share>): m11 .. m44`.
[[nodiscard]] Result<std::vector<GroundTruthObject>> parse_tuw_anno(std::string_view text, std::string_view name);

/// Writes `<view>_<object>_<instance>.txt` and, if the visible share is known,
/// `<view>_occlusion_<object>_<instance>.txt`.
[[nodiscard]] Result<void> write_tuw_annotation(const std::filesystem::path& directory, const std::string& view,
                                                const std::vector<GroundTruthObject>& objects);

}  // namespace resight
