// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Opens a sequence directory and detects the format from its contents. The error says what was expected.
[[nodiscard]] Result<std::unique_ptr<Sequence>> open_sequence(const std::filesystem::path& directory);

/// Same, for uses that need camera poses. Fails for several views without poses.
[[nodiscard]] Result<std::unique_ptr<Sequence>> open_posed_sequence(const std::filesystem::path& directory);

/// Writes a sequence view by view. It appears under its final name only with finish().
class SequenceWriter {
 public:
  virtual ~SequenceWriter() = default;
  [[nodiscard]] virtual Result<void> write_view(const RgbdFrame& frame,
                                                const std::vector<GroundTruthObject>& ground_truth) = 0;
  [[nodiscard]] virtual Result<void> finish() = 0;
};
/// Formats that can be written (docs/formats.md).
enum class DatasetFormat { kTuw, kBop };
/// Starts a sequence in `directory`. Fails if the folder exists and is not empty, or cannot be written.
[[nodiscard]] Result<std::unique_ptr<SequenceWriter>> create_sequence(const std::filesystem::path& directory,
                                                                      DatasetFormat format);

}  // namespace resight
