// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/gltf_file.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <map>
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

std::int64_t num_components(std::string_view type) {
  if (type == "SCALAR") return 1;
  return type == "VEC2" ? 2 : type == "VEC3" ? 3 : 4;
}

struct BaseColor {
  const GltfJson& factor;
  const GltfJson& texture;
};
BaseColor base_color_of(const GltfJson& material) {
  const GltfJson& specular = member(member(material, "extensions"), "KHR_materials_pbrSpecularGlossiness");
  if (specular.is_object()) return {member(specular, "diffuseFactor"), member(specular, "diffuseTexture")};
  const GltfJson& metallic = member(material, "pbrMetallicRoughness");
  return {member(metallic, "baseColorFactor"), member(metallic, "baseColorTexture")};
}

/// Copies the used parts of a document. The first fault counts; what follows it does not matter.
class GltfParts {
 public:
  GltfParts(const GltfJson& document, GltfUvs& uvs) : document_(document), uvs_(uvs) {}

  Result<GltfJson> copy() {
    check_version();
    check_extensions();
    GltfJson parts = pick(document_, {"asset", "scene", "accessors", "bufferViews", "buffers"});
    check_buffer_views();
    copy_materials(parts);
    parts["meshes"] = copy_meshes();
    parts["nodes"] = copy_nodes();
    parts["scenes"] = copy_scenes();
    if (!added_accessors_.empty()) append_uvs(parts);
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
  }
  /// Extensions of materials change the shading alone, but the one that has another base colour, which is read.
  void check_extensions() {
    for (const GltfJson& required : list("extensionsRequired")) {
      const std::string name = as_text(required).value_or("");
      if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression")
        fail(fmt::format("is compressed ({}); save it without compression", name));
      else if (!name.starts_with("KHR_materials_") && name != "KHR_texture_transform" &&
               name != "KHR_lights_punctual" && name != "KHR_xmp_json_ld")
        fail(fmt::format("needs the extension {}, which is not read", name));
    }
  }

  std::int64_t buffer_bytes(const GltfJson& index) {
    const GltfJson& buffer = element("buffers", index);
    if (!buffer.is_object()) fail("a part of a buffer lies in no buffer");
    const std::int64_t stated = count(buffer, "byteLength", 0);
    const bool is_binary_part = index == 0 && member(buffer, "uri").is_null();
    return is_binary_part ? std::min(stated, static_cast<std::int64_t>(uvs_.binary().size())) : stated;
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
                                           std::initializer_list<GltfNumberType> components) {
    const GltfJson& accessor = element("accessors", index);
    const std::string type = as_text(member(accessor, "type")).value_or("");
    const auto* component = std::ranges::find(components, as_integer(member(accessor, "componentType")).value_or(0),
                                              &GltfNumberType::number);
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

  /// The accessor of these texture coordinates as Assimp reads them.
  GltfJson convert_uvs(const GltfJson& index, const GltfJson& transform) {
    const GltfJson& accessor = element("accessors", index);
    const bool is_float = member(accessor, "componentType") == kGltfFloat.number;
    if (is_float && transform.is_null()) return index;
    if (!is_float && member(accessor, "normalized") != true)
      fail("texture coordinates are whole numbers that are not normalized");
    const auto [it, is_new] = converted_uvs_.try_emplace({as_integer(index).value_or(0), transform.dump()}, 0);
    if (is_new) {
      it->second = list("accessors").size() + added_accessors_.size();
      add_uvs(accessor, transform);
    }
    return it->second;
  }
  void add_uvs(const GltfJson& accessor, const GltfJson& transform) {
    const GltfJson& view = element("bufferViews", member(accessor, "bufferView"));
    const GltfJson& type = member(accessor, "componentType");
    GltfUvSource source;
    if (type == kGltfUint8.number) source.type = kGltfUint8;
    if (type == kGltfUint16.number) source.type = kGltfUint16;
    source.buffer = static_cast<std::size_t>(count(view, "buffer", 0));
    source.begin = count(view, "byteOffset", 0) + count(accessor, "byteOffset", 0);
    source.stride = count(view, "byteStride", 2 * source.type.bytes);
    source.num = count(accessor, "count", 0);
    const std::size_t offset = uvs_.converted().size();
    if (static_cast<double>(offset) / sizeof(Eigen::Vector2f) + static_cast<double>(source.num) > kMaxVertices)
      fail(fmt::format("it has more than {} texture coordinates to convert", kMaxVertices));
    if (!fault_.empty()) return;
    if (const auto done = uvs_.convert(source, transform); !done) fail(done.error().message);
    added_accessors_.push_back({{"bufferView", list("bufferViews").size()},
                                {"byteOffset", offset},
                                {"componentType", kGltfFloat.number},
                                {"count", source.num},
                                {"type", "VEC2"}});
  }
  /// Their buffer lies behind those of the document.
  void append_uvs(GltfJson& parts) {
    const std::size_t bytes = uvs_.converted().size();
    for (GltfJson& accessor : added_accessors_) parts["accessors"].push_back(std::move(accessor));
    parts["bufferViews"].push_back({{"buffer", list("buffers").size()}, {"byteLength", bytes}});
    parts["buffers"].push_back({{"uri", kGltfUvFile}, {"byteLength", bytes}});
  }

  /// Each material with a texture of its own, and that with the image that it names.
  void copy_materials(GltfJson& parts) {
    parts["images"] = list("images");
    parts["images"].push_back({{"uri", kNoGltfImage}});
    for (const GltfJson& material : list("materials")) {
      const auto& [factor, texture] = base_color_of(material);
      GltfJson surface = GltfJson::object();
      if (!factor.is_null()) surface["baseColorFactor"] = factor;
      if (!texture.is_null()) {
        surface["baseColorTexture"]["index"] = parts["textures"].size();
        parts["textures"].push_back({{"source", image_of(texture)}});
      }
      parts["materials"].push_back({{"name", kGltfMaterial}, {"pbrMetallicRoughness", std::move(surface)}});
    }
  }
  std::size_t image_of(const GltfJson& texture) {
    const GltfJson& source = member(element("textures", member(texture, "index")), "source");
    const GltfJson& image = element("images", source);
    const bool is_named = member(image, "uri").is_string() || !member(image, "bufferView").is_null();
    return is_named ? source.get<std::size_t>() : list("images").size();
  }

  /// None for points and lines, and for less than a triangle.
  std::optional<GltfJson> copy_primitive(const GltfJson& primitive, double& num_vertices) {
    constexpr std::int64_t kTriangles = 4;
    constexpr std::int64_t kTriangleFan = 6;
    const std::int64_t mode = count(primitive, "mode", kTriangles);
    if (mode < kTriangles || mode > kTriangleFan) return std::nullopt;
    const GltfJson& attributes = member(primitive, "attributes");
    const auto num_points = num_elements(member(attributes, "POSITION"), {"VEC3"}, {kGltfFloat});
    if (!num_points) fail("a primitive has no positions of floating-point numbers");
    GltfJson used = pick(attributes, {"POSITION"});
    const auto use = [&](const char* name, std::optional<std::int64_t> num) {
      if (num && num == num_points) used[name] = member(attributes, name);
    };
    use("NORMAL", num_elements(member(attributes, "NORMAL"), {"VEC3"}, {kGltfFloat}));
    const GltfJson& texture = base_color_of(element("materials", member(primitive, "material"))).texture;
    const GltfJson& transform = member(member(texture, "extensions"), "KHR_texture_transform");
    const std::int64_t uv_set = count(transform, "texCoord", count(texture, "texCoord", 0));
    const GltfJson& uvs = member(attributes, fmt::format("TEXCOORD_{}", uv_set));
    const auto num_uvs = num_elements(uvs, {"VEC2"}, {kGltfFloat, kGltfUint8, kGltfUint16});
    if (num_uvs && num_uvs == num_points) used["TEXCOORD_0"] = convert_uvs(uvs, transform);
    use("COLOR_0",
        num_elements(member(attributes, "COLOR_0"), {"VEC3", "VEC4"}, {kGltfFloat, kGltfUint8, kGltfUint16}));
    std::optional<std::int64_t> num_corners = num_points;
    if (const GltfJson& indices = member(primitive, "indices"); !indices.is_null())
      num_corners = num_elements(indices, {"SCALAR"}, {kGltfUint8, kGltfUint16, kGltfUint32});
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
  GltfUvs& uvs_;
  std::string fault_;
  std::vector<double> mesh_vertices_;                                 ///< Per mesh.
  std::vector<std::optional<std::size_t>> parents_;                   ///< Per node.
  double num_vertices_ = 0;                                           ///< Of all nodes.
  std::vector<GltfJson> added_accessors_;                             ///< Of converted texture coordinates.
  std::map<std::pair<int, std::string>, std::size_t> converted_uvs_;  ///< By accessor and transform.
};

Result<NormalizedGltf> normalize_document(std::string_view text, std::string_view binary, const FindFile& find) {
  const auto document = parse_json(text);
  if (!document) return document.error();
  if (!document->is_object()) return Error{"is not a glTF file (no JSON object)"};
  GltfUvs uvs(*document, binary, find);
  const auto parts = GltfParts(*document, uvs).copy();
  if (!parts) return parts.error();
  return NormalizedGltf{parts->dump(), std::move(uvs.converted())};
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

Result<NormalizedGltf> normalize_gltf(std::string_view text, const FindFile& find) {
  return normalize_document(text, {}, find);
}

Result<NormalizedGltf> normalize_glb(std::string_view bytes, const FindFile& find) {
  const auto chunks = split_glb(bytes);
  if (!chunks) return chunks.error();
  auto normalized = normalize_document(chunks->text, chunks->binary, find);
  if (!normalized) return normalized;
  std::string& text = normalized->bytes;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string result = "glTF";
  append_number(result, 2);
  append_number(result, 12 + 8 + text.size() + (chunks->binary.empty() ? 0 : 8 + chunks->binary.size()));
  append_number(result, text.size());
  result += "JSON" + text;
  if (!chunks->binary.empty()) {
    append_number(result, chunks->binary.size());
    result.append("BIN\0", 4);
    result += chunks->binary;
  }
  text = std::move(result);
  return normalized;
}

}  // namespace resight::io
