// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/gltf_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <set>
#include <vector>

#include "resight/io/internal/json.hpp"

namespace resight::io {
namespace {

using GltfJson = nlohmann::json;

constexpr int kMaxNodeDepth = 256;        // Assimp recurses.
constexpr double kMaxVertices = 1 << 24;  // of all nodes: many nodes can show one mesh.

GltfJson pick(const GltfJson& object, std::initializer_list<const char*> keys) {
  GltfJson picked = GltfJson::object();
  for (const char* key : keys)
    if (const GltfJson& value = member(object, key); !value.is_null()) picked[key] = value;
  return picked;
}

struct ComponentType {
  int number;
  std::int64_t bytes;
};
constexpr ComponentType kUint8{5121, 1};
constexpr ComponentType kUint16{5123, 2};
constexpr ComponentType kUint32{5125, 4};
constexpr ComponentType kFloat{5126, 4};

std::int64_t num_components(std::string_view type) {
  if (type == "SCALAR") return 1;
  return type == "VEC2" ? 2 : type == "VEC3" ? 3 : 4;
}

/// Copies the used parts of a document. The first fault counts; what follows it does not matter.
class GltfParts {
 public:
  /// `binary_bytes`: size of the part of a GLB file that is the first buffer; none for a text file.
  GltfParts(const GltfJson& document, std::optional<std::int64_t> binary_bytes)
      : document_(document), binary_bytes_(binary_bytes) {}

  Result<GltfJson> copy() {
    check_version();
    GltfJson parts = pick(document_, {"asset", "scene", "materials", "textures", "images", "samplers", "accessors",
                                      "bufferViews", "buffers", "extensionsUsed"});
    check_buffer_views();
    parts["meshes"] = copy_meshes();
    parts["nodes"] = copy_nodes();
    parts["scenes"] = copy_scenes();
    if (num_vertices_ > kMaxVertices) fail(fmt::format("its nodes show more than {} vertices", kMaxVertices));
    if (!fault_.empty()) return Error{fault_};
    return parts;
  }

 private:
  void fail(const std::string& what) {
    if (fault_.empty()) fault_ = what;
  }
  [[nodiscard]] const GltfJson& list(const char* key) const {
    static const GltfJson kNone = GltfJson::array();
    const GltfJson& value = member(document_, key);
    return value.is_array() ? value : kNone;
  }
  /// Null if there is no such element.
  [[nodiscard]] const GltfJson& element(const char* key, const GltfJson& index) const {
    static const GltfJson kNull;
    const auto number = as_integer(index);
    const GltfJson& all = list(key);
    return number && *number >= 0 && static_cast<std::size_t>(*number) < all.size()
               ? all[static_cast<std::size_t>(*number)]
               : kNull;
  }
  /// A whole number of at least 0, or the default if it is missing.
  std::int64_t count(const GltfJson& object, const char* key, std::int64_t missing) {
    constexpr double kLargest = 1e12;
    const GltfJson& value = member(object, key);
    if (value.is_null()) return missing;
    const auto number = as_number(value);
    if (number && *number >= 0 && *number <= kLargest && *number == std::floor(*number))
      return static_cast<std::int64_t>(*number);
    fail(fmt::format("'{}' is no whole number of 0 or more", key));
    return 0;
  }

  void check_version() {
    const GltfJson& version = member(member(document_, "asset"), "version");
    if (!version.is_string() || !version.get<std::string>().starts_with("2."))
      fail("is not glTF 2.0 (no such version in 'asset')");
    for (const GltfJson& name : list("extensionsRequired"))
      if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression")
        fail(fmt::format("is compressed ({}); save it without compression", name.get<std::string>()));
  }

  std::int64_t buffer_bytes(const GltfJson& index) {
    const GltfJson& buffer = element("buffers", index);
    if (!buffer.is_object()) fail("a part of a buffer lies in no buffer");
    const std::int64_t stated = count(buffer, "byteLength", 0);
    const bool is_binary_part = index == 0 && member(buffer, "uri").is_null();
    return is_binary_part ? std::min(stated, binary_bytes_.value_or(0)) : stated;
  }
  void check_buffer_views() {
    for (const GltfJson& view : list("bufferViews")) {
      const std::int64_t end = count(view, "byteOffset", 0) + count(view, "byteLength", 0);
      if (end > buffer_bytes(member(view, "buffer"))) fail("a part of a buffer ends beyond the buffer (cut off?)");
      if (!member(member(view, "extensions"), "EXT_meshopt_compression").is_null()) fail("is compressed (meshopt)");
    }
  }

  /// Number of elements of an accessor; none if it has another type.
  std::optional<std::int64_t> num_elements(const GltfJson& index, std::initializer_list<std::string_view> types,
                                           std::initializer_list<ComponentType> components) {
    const GltfJson& accessor = element("accessors", index);
    const std::string type = as_text(member(accessor, "type")).value_or("");
    const auto* component = std::ranges::find(components, as_integer(member(accessor, "componentType")).value_or(0),
                                              &ComponentType::number);
    if (std::ranges::find(types, type) == types.end() || component == components.end()) return std::nullopt;
    check_accessor(accessor, num_components(type) * component->bytes);
    return count(accessor, "count", 0);
  }
  void check_accessor(const GltfJson& accessor, std::int64_t element_bytes) {
    if (!member(accessor, "sparse").is_null()) fail("holds sparse data, which are not read");
    const GltfJson& view = element("bufferViews", member(accessor, "bufferView"));
    if (!view.is_object()) return fail("an accessor has no data");
    const std::int64_t stride = count(view, "byteStride", element_bytes);
    const std::int64_t num = count(accessor, "count", 0);
    constexpr std::int64_t kMaxStride = 252;
    if (stride < element_bytes || stride > std::max(kMaxStride, element_bytes)) return fail("a stride is out of range");
    // The numbers are at most 1e12 and the stride 252, so that nothing overflows.
    const std::int64_t end = count(accessor, "byteOffset", 0) + (num - 1) * stride + element_bytes;
    if (num > 0 && end > count(view, "byteLength", 0)) fail("an accessor ends beyond its part of the buffer");
  }

  /// None for points and lines, and for less than a triangle.
  std::optional<GltfJson> copy_primitive(const GltfJson& primitive, double& num_vertices) {
    constexpr std::int64_t kTriangles = 4;
    constexpr std::int64_t kTriangleFan = 6;
    const std::int64_t mode = count(primitive, "mode", kTriangles);
    if (mode < kTriangles || mode > kTriangleFan) return std::nullopt;
    const GltfJson& attributes = member(primitive, "attributes");
    const auto num_points = num_elements(member(attributes, "POSITION"), {"VEC3"}, {kFloat});
    if (!num_points) fail("a primitive has no positions of floating-point numbers");
    GltfJson used = pick(attributes, {"POSITION"});
    const auto use = [&](const char* name, std::optional<std::int64_t> num) {
      if (num && num == num_points) used[name] = member(attributes, name);
    };
    use("NORMAL", num_elements(member(attributes, "NORMAL"), {"VEC3"}, {kFloat}));
    use("TEXCOORD_0", num_elements(member(attributes, "TEXCOORD_0"), {"VEC2"}, {kFloat}));
    use("COLOR_0", num_elements(member(attributes, "COLOR_0"), {"VEC3", "VEC4"}, {kFloat, kUint8, kUint16}));
    std::optional<std::int64_t> num_corners = num_points;
    if (const GltfJson& indices = member(primitive, "indices"); !indices.is_null())
      num_corners = num_elements(indices, {"SCALAR"}, {kUint8, kUint16, kUint32});
    if (!num_corners) fail("indices are no whole numbers");
    if (num_corners.value_or(0) < 3) return std::nullopt;
    num_vertices += static_cast<double>(std::max(num_corners.value_or(0), num_points.value_or(0)));
    GltfJson copied = pick(primitive, {"indices", "material", "mode"});
    copied["attributes"] = std::move(used);
    return copied;
  }
  GltfJson copy_meshes() {
    GltfJson meshes = GltfJson::array();
    for (const GltfJson& mesh : list("meshes")) {
      GltfJson primitives = GltfJson::array();
      mesh_vertices_.push_back(0);
      const GltfJson& all = member(mesh, "primitives");
      if (all.is_array())
        for (const GltfJson& primitive : all)
          if (auto copied = copy_primitive(primitive, mesh_vertices_.back())) primitives.push_back(*std::move(copied));
      meshes.push_back({{"primitives", std::move(primitives)}});
    }
    return meshes;
  }

  /// The nodes are trees that are not too deep.
  GltfJson copy_nodes() {
    const std::size_t num_nodes = list("nodes").size();
    parents_.assign(num_nodes, std::nullopt);
    GltfJson nodes = GltfJson::array();
    for (std::size_t n = 0; n < num_nodes; ++n) {
      const GltfJson& node = list("nodes")[n];
      nodes.push_back(pick(node, {"mesh", "children", "matrix", "translation", "rotation", "scale"}));
      const std::int64_t mesh = count(node, "mesh", 0);
      if (node.contains("mesh") && mesh < static_cast<std::int64_t>(mesh_vertices_.size()))
        num_vertices_ += mesh_vertices_[static_cast<std::size_t>(mesh)];
      for (const std::size_t child : node_list(member(node, "children"))) {
        if (parents_[child]) fail("a node has two parents");
        parents_[child] = n;
      }
    }
    for (std::size_t n = 0; n < num_nodes; ++n) {
      int depth = 0;
      for (auto parent = parents_[n]; parent && depth <= kMaxNodeDepth; parent = parents_[*parent]) ++depth;
      if (depth > kMaxNodeDepth) fail(fmt::format("its nodes are nested more than {} deep", kMaxNodeDepth));
    }
    return nodes;
  }
  /// Indices of nodes, each once.
  std::vector<std::size_t> node_list(const GltfJson& indices) {
    std::vector<std::size_t> nodes;
    if (!indices.is_array()) return nodes;
    std::set<std::size_t> seen;
    for (const GltfJson& index : indices) {
      if (!element("nodes", index).is_object())
        fail("a node does not exist");
      else if (const auto node = index.get<std::size_t>(); !seen.insert(node).second)
        fail("a node is listed twice");
      else
        nodes.push_back(node);
    }
    return nodes;
  }
  GltfJson copy_scenes() {
    GltfJson scenes = GltfJson::array();
    for (const GltfJson& scene : list("scenes")) {
      for (const std::size_t root : node_list(member(scene, "nodes")))
        if (parents_[root]) fail("a node of a scene has a parent");
      scenes.push_back(pick(scene, {"nodes"}));
    }
    return scenes;
  }

  const GltfJson& document_;
  std::optional<std::int64_t> binary_bytes_;
  std::string fault_;
  std::vector<double> mesh_vertices_;                ///< Per mesh.
  std::vector<std::optional<std::size_t>> parents_;  ///< Per node.
  double num_vertices_ = 0;                          ///< Of all nodes.
};

Result<std::string> normalize_document(std::string_view text, std::optional<std::int64_t> binary_bytes) {
  const auto document = parse_json(text);
  if (!document) return document.error();
  if (!document->is_object()) return Error{"is not a glTF file (no JSON object)"};
  const auto parts = GltfParts(*document, binary_bytes).copy();
  if (!parts) return parts.error();
  return parts->dump();
}

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.data() + at, sizeof(number));
  return number;
}
void append_number(std::string& bytes, std::size_t number) {
  const auto value = static_cast<std::uint32_t>(number);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// The chunks of a GLB file.
struct GlbChunks {
  std::string_view text;
  std::string_view binary;
};

Result<GlbChunks> split_glb(std::string_view bytes) {
  constexpr std::size_t kHeaderBytes = 12;
  constexpr std::size_t kChunkHeaderBytes = 8;
  if (!bytes.starts_with("glTF") || bytes.size() < kHeaderBytes + kChunkHeaderBytes)
    return Error{"is not a GLB file (no header)"};
  if (const std::uint32_t version = number_at(bytes, 4); version != 2)
    return Error{fmt::format("is GLB of version {}; only version 2 is read (export it again)", version)};
  GlbChunks chunks;
  for (std::size_t at = kHeaderBytes; bytes.size() - at >= kChunkHeaderBytes;) {
    const std::uint32_t length = number_at(bytes, at);
    const std::string_view type = bytes.substr(at + 4, 4);
    at += kChunkHeaderBytes;
    if (length > bytes.size() - at) return Error{"is cut off: a chunk is longer than the file"};
    if (type == "JSON" && chunks.text.empty()) chunks.text = bytes.substr(at, length);
    if (type == std::string_view("BIN\0", 4) && chunks.binary.empty()) chunks.binary = bytes.substr(at, length);
    at += length;
  }
  return chunks;
}

}  // namespace

Result<std::string> normalize_gltf(std::string_view text) { return normalize_document(text, std::nullopt); }

Result<std::string> normalize_glb(std::string_view bytes) {
  const auto chunks = split_glb(bytes);
  if (!chunks) return chunks.error();
  auto text = normalize_document(chunks->text, static_cast<std::int64_t>(chunks->binary.size()));
  if (!text) return text;
  text->resize((text->size() + 3) / 4 * 4, ' ');
  std::string result = "glTF";
  append_number(result, 2);
  append_number(result, 12 + 8 + text->size() + (chunks->binary.empty() ? 0 : 8 + chunks->binary.size()));
  append_number(result, text->size());
  result += "JSON" + *text;
  if (chunks->binary.empty()) return result;
  append_number(result, chunks->binary.size());
  result.append("BIN\0", 4);
  result += chunks->binary;
  return result;
}

}  // namespace resight::io
