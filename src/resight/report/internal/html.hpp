// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "resight/core/image.hpp"
#include "resight/report/view_record.hpp"

namespace resight::report {

/// Views by their numbers in the sequence.
struct ViewRange {
  int first = 0;
  int end = 0;  ///< Behind the last one.
  [[nodiscard]] bool contains(int view) const { return view >= first && view < end; }
};
/// All views of the runs.
[[nodiscard]] ViewRange range_of(std::span<const ReportRun> runs);

/// Style sheet of the page.
[[nodiscard]] std::string_view page_style();

/// Escapes text for use between tags and in quoted attributes.
[[nodiscard]] std::string escape(std::string_view text);
/// Base64 encoding (RFC 4648), with padding.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);
/// Number with `digits` decimals; a dash for NaN.
[[nodiscard]] std::string number(double value, int digits);
/// Whole percentage; a dash for NaN.
[[nodiscard]] std::string percent(double share);
/// Seconds, or milliseconds below one second; a dash for NaN.
[[nodiscard]] std::string duration(double seconds);
/// Colour as #rrggbb.
[[nodiscard]] std::string css_color(Rgb8 color);
/// Escaped name of an object. Throws std::invalid_argument if the object is not in the library.
[[nodiscard]] std::string object_name(int object, const ModelLibrary& library);
/// A patch in the object's outline colour, followed by its name.
[[nodiscard]] std::string object_tag(int object, const ModelLibrary& library);

/// Sections of the page as HTML.
[[nodiscard]] std::string summary_section(std::span<const ReportRun> runs);
[[nodiscard]] std::string history_section(std::span<const ReportRun> runs, const ModelLibrary& library,
                                          const ViewRange& range);
[[nodiscard]] std::string time_section(std::span<const ReportRun> runs);
[[nodiscard]] std::string views_section(std::span<const ReportRun> runs, const ModelLibrary& library,
                                        const ViewRange& range);
/// The history of a long run, as far as it is one of changes, up to kViewsPerPage views with changes.
[[nodiscard]] std::string changes_section(std::span<const ReportRun> runs, const ModelLibrary& library);
[[nodiscard]] std::string settings_section(std::span<const ReportRun> runs);

}  // namespace resight::report
