// SPDX-License-Identifier: Apache-2.0
#include "resight/io/parse_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace resight {
namespace {

/// What is wrong where the parser stopped, behind the first `num_read` bytes.
std::string describe_syntax_error(std::string_view text, std::size_t num_read) {
  const std::size_t at = num_read == 0 ? 0 : num_read - 1;
  const auto line = 1 + std::ranges::count(text.substr(0, at), '\n');
  const std::string_view rest = text.substr(std::min(at, text.size()));
  const char* why = "";
  if (rest.find_first_not_of(" \t\r\n") == rest.npos) why = " (cut off?)";
  if (rest.starts_with('N') || rest.starts_with('I') || rest.starts_with("nan") || rest.starts_with("inf"))
    why = " (NaN and infinite numbers are not allowed)";
  return fmt::format("is not valid JSON: line {}{}", line, why);
}

/// Checks a text without building a value, which may take thirty times as much memory as the text. A parser would
/// silently take one of two values of the same key, and the parser with a callback, which sees the keys, looks through
/// a whole list at the end of each object in it.
class JsonCheck final : public nlohmann::json_sax<nlohmann::json> {
 public:
  JsonCheck(std::string_view text, std::size_t max_bytes) : text_(text), max_bytes_(max_bytes) {}
  /// What is wrong; empty if nothing is.
  [[nodiscard]] const std::string& fault() const { return fault_; }

  bool null() override { return add(kValueBytes); }
  bool boolean(bool /*value*/) override { return add(kValueBytes); }
  bool number_integer(number_integer_t /*value*/) override { return add(kValueBytes); }
  bool number_unsigned(number_unsigned_t /*value*/) override { return add(kValueBytes); }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return add(kValueBytes); }
  bool string(string_t& value) override { return add(kValueBytes + kBlockBytes + sizeof(string_t) + value.size()); }
  bool binary(binary_t& /*value*/) override { return add(kValueBytes); }
  bool start_object(std::size_t /*size*/) override { return start(sizeof(nlohmann::json::object_t)); }
  bool end_object() override { return end(); }
  bool start_array(std::size_t /*size*/) override { return start(sizeof(nlohmann::json::array_t)); }
  bool end_array() override { return end(); }
  bool key(string_t& name) override {
    constexpr std::size_t kLinkBytes = 32;  // of a node of std::map
    return add(kBlockBytes + kLinkBytes + sizeof(nlohmann::json::object_t::value_type) + name.size()) &&
           (keys_.back().insert(name).second || fail(fmt::format("has the key '{:.40}' twice in one object", name)));
  }
  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) override {
    constexpr int kOutOfRange = 406;
    return fail(error.id == kOutOfRange ? "is not valid JSON: a number is too large"
                                        : describe_syntax_error(text_, position));
  }

 private:
  static constexpr std::size_t kBlockBytes = 16;                          ///< What the heap needs for itself per block.
  static constexpr std::size_t kValueBytes = 2 * sizeof(nlohmann::json);  ///< A list that grows has room for more.

  bool add(std::size_t num_bytes) {
    num_bytes_ += num_bytes;
    return num_bytes_ <= max_bytes_ ||
           fail(fmt::format("has more values than fit into {} MB of memory", max_bytes_ >> 20U));
  }
  bool start(std::size_t num_bytes) {
    constexpr std::size_t kMaxNesting = 64;
    keys_.emplace_back();
    return add(kValueBytes + kBlockBytes + num_bytes) &&
           (keys_.size() <= kMaxNesting || fail(fmt::format("is nested more than {} deep", kMaxNesting)));
  }
  bool end() {
    keys_.pop_back();
    return true;
  }
  bool fail(std::string fault) {
    fault_ = std::move(fault);
    return false;
  }
  std::string_view text_;
  std::size_t max_bytes_;
  std::size_t num_bytes_ = 0;  ///< About what the values take in memory.
  std::string fault_;
  std::vector<std::set<std::string>> keys_;  ///< Of the lists and objects around the current place.
};

}  // namespace

Result<nlohmann::json> parse_json(std::string_view text, std::size_t max_bytes) {
  JsonCheck check(text, max_bytes);
  if (!nlohmann::json::sax_parse(text, &check)) return Error{check.fault()};
  return nlohmann::json::parse(text);
}

}  // namespace resight
