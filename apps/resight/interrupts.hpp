// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

namespace resight::app {

/// From now on, the program removes its temporary files before a signal ends it (Ctrl-C, SIGTERM, a closed terminal or
/// pipe), and a limit on the size of files is an error like a full disk. Signals that the caller of the program ignores
/// stay ignored, as under nohup. To be called again after others have handled these signals.
void clean_up_when_interrupted();

/// A signal that ends the program also removes this temporary file, which lies outside the outputs. Any thread may call
/// this; after such a signal, the call blocks until the program has ended.
void remove_when_interrupted(const std::filesystem::path& file);
/// Removes such a file now.
void remove_temporary_file(const std::filesystem::path& file);

/// From now on, the first Ctrl-C or SIGTERM only makes is_stop_requested() true. The second one ends the program as
/// described above.
void stop_when_interrupted();
[[nodiscard]] bool is_stop_requested();

}  // namespace resight::app
