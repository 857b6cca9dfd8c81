// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "resight/core/image.hpp"
#include "resight/report/view_record.hpp"

namespace resight::report {

/// The style sheet of the page.
[[nodiscard]] std::string_view page_style();

/// Text that is safe between tags and in quoted attributes.
[[nodiscard]] std::string escape(std::string_view text);
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);
/// With `digits` after the point; a dash for NaN.
[[nodiscard]] std::string number(double value, int digits);
/// As a whole percentage; a dash for NaN.
[[nodiscard]] std::string percent(double share);
/// Seconds, or milliseconds below one second.
[[nodiscard]] std::string duration(double seconds);
[[nodiscard]] std::string css_color(Rgb8 color);
[[nodiscard]] std::string object_name(int object, const ModelLibrary& library);
/// A patch of the object's outline colour and its name.
[[nodiscard]] std::string object_tag(int object, const ModelLibrary& library);

/// The sections of the page, as HTML.
[[nodiscard]] std::string summary_section(std::span<const ReportRun> runs);
[[nodiscard]] std::string history_section(std::span<const ReportRun> runs, const ModelLibrary& library);
[[nodiscard]] std::string time_section(std::span<const ReportRun> runs);
[[nodiscard]] std::string views_section(std::span<const ReportRun> runs, const ModelLibrary& library);
[[nodiscard]] std::string settings_section(std::span<const ReportRun> runs);

}  // namespace resight::report
