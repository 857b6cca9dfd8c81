// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "resight/io/sequence.hpp"

namespace resight {

struct FollowSequenceOptions {
  bool skips_late = true;  ///< Of several new views only the newest is taken. Otherwise all are, in order.
  int max_tries = 20;  ///< Calls of poll() after which a view that cannot be read is left out, if a later one is there.
};

/// A view that has just been written.
struct FollowedView {
  RgbdFrame frame;
  int number = 0;  ///< In the sequence, as it was then: an earlier view may still come.
  int scene_id = 0;
  int image_id = 0;
};

/// The views of a folder that a camera is writing. The folder may be of any format that open_sequence() detects, and
/// need not be there yet. It is opened anew for each view, so that lists, poses and images may come in any order: a
/// view counts once all of it can be read.
class SequenceFollower {
 public:
  explicit SequenceFollower(std::filesystem::path folder, OpenSequenceOptions open = {},
                            FollowSequenceOptions options = {});

  /// A view that is new and complete. None if there is none now: why_none() says what was found.
  [[nodiscard]] std::optional<FollowedView> poll();
  [[nodiscard]] const std::string& why_none() const { return why_none_; }
  /// Views that newer ones have overtaken so far.
  [[nodiscard]] int num_skipped() const { return num_skipped_; }
  /// Why views were left out since the last call: they could not be read, although later ones could.
  [[nodiscard]] std::vector<std::string> take_left_out();
  /// What was assumed when the folder was last opened.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::optional<FollowedView> take_newest(const Sequence& sequence, const std::vector<int>& fresh);
  std::optional<FollowedView> take_next(const Sequence& sequence, const std::vector<int>& fresh);

  std::filesystem::path folder_;
  OpenSequenceOptions open_;
  FollowSequenceOptions options_;
  std::set<std::string> done_;  ///< Names of views that were returned, skipped or left out.
  std::map<std::string, int> tries_;
  std::vector<std::string> left_out_;
  std::vector<std::string> notes_;
  std::string why_none_;
  int num_skipped_ = 0;
};

}  // namespace resight
