// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/mesh_files.hpp"

#include <assimp/MemoryIOWrapper.h>

#include <algorithm>

#include "resight/io/internal/gltf_file.hpp"
#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

/// Keeps the bytes alive as long as Assimp reads them.
class MeshStream final : public Assimp::MemoryIOStream {
 public:
  explicit MeshStream(std::shared_ptr<const std::string> bytes)
      : MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()), bytes_(std::move(bytes)) {}

 private:
  std::shared_ptr<const std::string> bytes_;
};

/// The mark that editors of Windows put before UTF-8. It would hide the first statement.
std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view trim_start(std::string_view line) {
  while (!line.empty() && is_blank(line[0])) line.remove_prefix(1);
  return line;
}

// Assimp joins only faces.
std::string join_continued_lines(std::string text) {
  if (text.find("\\\n") == text.npos && text.find("\\\r") == text.npos) return text;
  std::string result;
  result.reserve(text.size());
  for (std::string_view rest = text; !rest.empty();) {
    std::string_view line = cut_line(rest);
    const bool goes_on = line.ends_with('\\') && !trim_start(line).starts_with('#');
    if (goes_on) line.remove_suffix(1);
    result += line;
    result += goes_on ? ' ' : '\n';
  }
  return result;
}

}  // namespace

Result<void> check_obj(std::string_view text) {
  text = without_mark(text);
  constexpr int kMaxParts = 4096;
  constexpr std::size_t kMaxCorners = 1024;
  int num_parts = 0;
  std::size_t num_words = 0;  // of the statement, which may go on in the next line
  bool goes_on = false;
  bool is_face = false;
  while (!text.empty()) {
    const std::string_view line = trim_start(cut_line(text));
    if (!goes_on) {
      const std::string_view keyword = line.substr(0, line.find_first_of(" \t"));
      is_face = keyword == "f";
      num_words = 0;
      if (keyword == "o" || keyword == "g" || keyword == "usemtl" || keyword == "mtllib") ++num_parts;
    }
    goes_on = line.ends_with('\\');
    if (is_face) num_words += split_tokens(line).size();
    if (num_words > kMaxCorners + 1) return Error{"has a face of more than 1024 corners"};
    if (num_parts > kMaxParts) return Error{"has more than 4096 groups, objects and changes of material"};
  }
  return {};
}

std::string normalize_obj(std::string text) {
  text.erase(0, text.size() - without_mark(text).size());
  text = join_continued_lines(std::move(text));
  if (text.find(" .") == text.npos && text.find("\t.") == text.npos) return text;
  std::string result;
  result.reserve(text.size() + text.size() / 8);
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = cut_line(rest);
    const bool is_vertex = trim_start(line).starts_with('v');
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (is_vertex && line[i] == '.' && i > 0 && is_blank(line[i - 1])) result += '0';
      result += line[i];
    }
    result += '\n';
  }
  return result;
}

std::string normalize_mtl(std::string_view text) {
  text = without_mark(text);
  std::string result = "# materials and their textures\n";  // Assimp refuses files of less than 16 bytes.
  bool has_material = false;
  while (!text.empty()) {
    const std::string_view line = trim_start(cut_line(text));
    const std::string keyword = to_lower(line.substr(0, line.find_first_of(" \t")));
    has_material = has_material || keyword == "newmtl";
    if (!has_material || (keyword != "newmtl" && keyword != "kd" && keyword != "map_kd")) continue;
    result += line;
    result += '\n';
  }
  return result;
}

Result<std::unique_ptr<MeshFiles>> MeshFiles::open(const fs::path& mesh) {
  auto bytes = read_file(mesh, kMaxBinaryBytes);
  if (!bytes) return bytes.error();
  const std::string extension = extension_of(mesh);
  if (extension == "glb") bytes = normalize_glb(*bytes);
  if (extension == "gltf") bytes = normalize_gltf(*bytes);
  if (extension == "obj") {
    if (const auto checked = check_obj(*bytes); !checked) return file_error(mesh, checked.error().message);
    bytes = normalize_obj(*std::move(bytes));
  }
  if (!bytes) return file_error(mesh, bytes.error().message);
  return std::unique_ptr<MeshFiles>(new MeshFiles(mesh, *std::move(bytes)));
}

MeshFiles::MeshFiles(fs::path mesh, std::string bytes) : mesh_(std::move(mesh)), is_obj_(extension_of(mesh_) == "obj") {
  files_[mesh_.filename().string()] = std::make_shared<const std::string>(std::move(bytes));
}

std::vector<std::string> MeshFiles::places_of(std::string name) const {
  std::ranges::replace(name, '\\', '/');
  std::vector<std::string> places = {name, name.substr(name.rfind('/') + 1)};
  if (is_obj_) places.push_back(mesh_.stem().string() + ".mtl");
  return places;
}

MeshFiles::Bytes MeshFiles::read(const std::string& name) const {
  std::string failure;
  for (const std::string& place : places_of(name)) {
    const auto file = path_below(mesh_.parent_path(), place);
    auto bytes = file ? read_file(*file, bytes_left_) : Result<std::string>(file.error());
    if (bytes) {
      bytes_left_ -= bytes->size();
      return std::make_shared<const std::string>(is_obj_ ? normalize_mtl(*bytes) : *std::move(bytes));
    }
    if (failure.empty()) failure = bytes.error().message;
  }
  if (failure_.empty()) failure_ = failure;
  return std::make_shared<const std::string>(is_obj_ ? normalize_mtl("") : "");
}

MeshFiles::Bytes MeshFiles::find(const std::string& name) const {
  const auto [it, is_new] = files_.try_emplace(name);
  if (is_new) it->second = read(name);
  return it->second;
}

Assimp::IOStream* MeshFiles::Open(const char* name, const char* mode) {
  if (mode == nullptr || mode[0] != 'r') return nullptr;
  return new MeshStream(find(name));
}

void MeshFiles::Close(Assimp::IOStream* stream) { delete stream; }

}  // namespace resight::io
