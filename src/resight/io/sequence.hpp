// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// The folder that open_sequence() opens: `directory` itself, or the only sequence below it. Same errors.
[[nodiscard]] Result<std::filesystem::path> find_sequence_folder(const std::filesystem::path& directory);

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
  /// Names of the views written so far, as a reader of the new sequence will see them.
  [[nodiscard]] virtual const std::vector<std::string>& view_names() const = 0;
  /// Writes another file into the folder of the sequence.
  [[nodiscard]] virtual Result<void> add_file(const std::string& name, std::string_view bytes) = 0;
  [[nodiscard]] virtual Result<void> finish() = 0;
};
/// Formats that can be written (docs/formats.md).
enum class DatasetFormat { kTuw, kBop };
/// Starts a sequence in `directory`. Fails if the folder exists and is not empty, or cannot be written.
[[nodiscard]] Result<std::unique_ptr<SequenceWriter>> create_sequence(const std::filesystem::path& directory,
                                                                      DatasetFormat format);

}  // namespace resight
