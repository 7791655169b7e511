#include "engine/codec/glb.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "engine/codec/check_level.h"
#include "engine/codec/cut_parts.h"
#include "engine/codec/draco_part.h"
#include "engine/codec/gltf_matrices.h"
#include "engine/codec/json_writer.h"

namespace geosis {
namespace {

// glTF's numbers for types of components and for triangles (Khronos, glTF 2.0, sections 3.6.2.2 and 3.7.2.1).
constexpr int kUnsignedByte = 5121, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kTriangleMode = 4;
constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";

constexpr std::uint32_t kLargestExactFloat = 1u << 24;

/// The arrays of a level in the types that glTF allows.
struct GltfNumbers {
  std::vector<std::uint16_t> short_bodies;
  std::vector<float> float_bodies;
  std::vector<float> values;
};

/// One accessor, and the Draco attribute that fills it.
struct GltfAttribute {
  const char* name;
  int component_type;
  int draco_id;
  bool normalized = false;
  const char* type = "SCALAR";
};

/// The compressed mesh and what the JSON says about it.
struct GltfMesh {
  std::vector<std::byte> bytes;
  std::vector<GltfAttribute> attributes;
  std::size_t vertices = 0, triangles = 0;
  Vec3f lowest, highest;
};

Matrix3 linear_part(const std::array<double, 16>& m) {
  return {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
}

bool mirrors(const Matrix3& m) {
  return dot(Vec3d{m[0], m[1], m[2]}, cross(Vec3d{m[3], m[4], m[5]}, Vec3d{m[6], m[7], m[8]})) < 0;
}

/// Rows x, -z, -y. Adding 0 makes -0 a plain 0.
Matrix3 towards_y_up(const Matrix3& m) {
  return {m[0], m[1], m[2], 0 - m[6], 0 - m[7], 0 - m[8], 0 - m[3], 0 - m[4], 0 - m[5]};
}

Result<GltfNumbers> convert(const VertexAttributes& attributes) {
  GltfNumbers numbers;
  const auto& bodies = attributes.body;
  const std::uint32_t largest = bodies.empty() ? 0 : *std::max_element(bodies.begin(), bodies.end());
  if (largest > kLargestExactFloat) {
    return Error{ErrorCode::limit_exceeded,
                 "body " + std::to_string(largest) + "; GLB holds bodies up to " + std::to_string(kLargestExactFloat)};
  }
  if (largest <= std::numeric_limits<std::uint16_t>::max()) {
    for (const std::uint32_t body : bodies) numbers.short_bodies.push_back(static_cast<std::uint16_t>(body));
  } else {
    for (const std::uint32_t body : bodies) numbers.float_bodies.push_back(static_cast<float>(body));
  }
  for (const float value : attributes.value) numbers.values.push_back(std::isfinite(value) ? value : kGlbMissingValue);
  return numbers;
}

/// The vertices that the triangles use; triangles counter-clockwise in index coordinates, as glTF wants them before the
/// node's matrix.
MeshPart prepare(const IndexedMesh& mesh, const VertexAttributes& attributes, const std::array<double, 16>& transform) {
  MeshPart whole = cut_part(mesh, attributes, plan_parts(mesh, std::numeric_limits<std::int32_t>::max()), 0);
  if (mirrors(linear_part(transform))) {
    for (Triangle& triangle : whole.mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  return whole;
}

/// Draco may store a vertex more than once: number and bounds of the vertices are those that a reader decodes.
Result<void> measure(GltfMesh& gltf) {
  const auto decoded = decode_part(gltf.bytes);
  if (!decoded) return decoded.error();
  const auto& positions = decoded->mesh.positions;
  gltf.vertices = positions.size();
  gltf.triangles = decoded->mesh.triangles.size();
  gltf.lowest = gltf.highest = positions.front();
  for (const Vec3f p : positions) {
    for (int axis = 0; axis < 3; ++axis) {
      gltf.lowest[axis] = std::min(gltf.lowest[axis], p[axis]);
      gltf.highest[axis] = std::max(gltf.highest[axis], p[axis]);
    }
  }
  return {};
}

Result<GltfMesh> compress(const MeshPart& part, const EncodeOptions& options) {
  const auto numbers = convert(part.attributes);
  if (!numbers) return numbers.error();
  GltfMesh gltf;
  std::vector<NamedNumbers> named;
  const auto add = [&](const char* name, int component_type, auto values, bool normalized = false) {
    if (values.empty()) return;
    named.push_back({name, values});
    gltf.attributes.push_back({name, component_type, static_cast<int>(named.size()), normalized});
  };
  gltf.attributes.push_back({"POSITION", kFloat, 0, false, "VEC3"});
  add("_RELIABILITY", kUnsignedByte, std::span(part.attributes.reliability), true);
  add("_BODY", kUnsignedShort, std::span(numbers->short_bodies));
  add("_BODY", kFloat, std::span(numbers->float_bodies));
  add("_VALUE", kFloat, std::span(numbers->values));
  add("_AGREEMENT", kUnsignedByte, std::span(part.attributes.agreement), true);
  if (!part.attributes.normal.empty()) {
    gltf.attributes.push_back({"NORMAL", kFloat, static_cast<int>(named.size()) + 1, false, "VEC3"});
  }
  auto bytes = encode_mesh(part.mesh, named, part.attributes.normal, options);
  if (!bytes) return std::move(bytes).error();
  gltf.bytes = *std::move(bytes);
  if (auto measured = measure(gltf); !measured) return measured.error();
  return gltf;
}

/// glTF stores matrices column after column.
void write_matrix(JsonWriter& json, const Matrix3& m) {
  json.key("matrix").list(
      std::array<double, 16>{m[0], m[3], m[6], 0, m[1], m[4], m[7], 0, m[2], m[5], m[8], 0, 0, 0, 0, 1});
}

void write_nodes(JsonWriter& json, const std::array<double, 16>& transform) {
  const GltfMatrices matrices = split_for_gltf(towards_y_up(linear_part(transform)));
  const bool shear = matrices.inner != Matrix3{1, 0, 0, 0, 1, 0, 0, 0, 1};
  json.key("nodes").begin('[').begin('{');
  write_matrix(json, matrices.outer);
  json.key("extras").begin('{');
  json.key("origin").list(std::array<double, 3>{transform[3], transform[7], transform[11]});
  json.key("transform").list(transform).end('}');
  if (shear) {
    json.key("children").list(std::array<int, 1>{1}).end('}').begin('{');
    write_matrix(json, matrices.inner);
  }
  json.key("mesh").value(0).end('}').end(']');
}

void write_primitive(JsonWriter& json, const GltfMesh& gltf) {
  const auto& attributes = gltf.attributes;
  json.begin('{').key("mode").value(kTriangleMode).key("material").value(0);
  json.key("attributes").begin('{');
  for (std::size_t a = 0; a < attributes.size(); ++a) json.key(attributes[a].name).value(a);
  json.end('}').key("indices").value(attributes.size());
  json.key("extensions").begin('{').key(kDracoExtension).begin('{');
  json.key("bufferView").value(0).key("attributes").begin('{');
  for (const GltfAttribute& attribute : attributes) json.key(attribute.name).value(attribute.draco_id);
  json.end('}').end('}').end('}');
  const auto is_value = [](const GltfAttribute& attribute) { return std::string_view(attribute.name) == "_VALUE"; };
  if (std::any_of(attributes.begin(), attributes.end(), is_value)) {
    json.key("extras").begin('{').key("missing_value").value(double{kGlbMissingValue}).end('}');
  }
  json.end('}');
}

void write_accessors(JsonWriter& json, const GltfMesh& gltf) {
  json.key("accessors").begin('[');
  for (const GltfAttribute& attribute : gltf.attributes) {
    json.begin('{').key("componentType").value(attribute.component_type);
    json.key("count").value(gltf.vertices).key("type").value(attribute.type);
    if (attribute.normalized) json.key("normalized").value(true);
    if (attribute.draco_id == 0) {
      const Vec3d low = to_double(gltf.lowest), high = to_double(gltf.highest);
      json.key("min").list(std::array{low.x, low.y, low.z});
      json.key("max").list(std::array{high.x, high.y, high.z});
    }
    json.end('}');
  }
  json.begin('{').key("componentType").value(kUnsignedInt).key("count").value(3 * gltf.triangles);
  json.key("type").value("SCALAR").end('}').end(']');
}

std::string describe(const GltfMesh& gltf, const std::array<double, 16>& transform) {
  JsonWriter json;
  json.begin('{').key("asset").begin('{').key("version").value("2.0").key("generator").value("Geosis").end('}');
  for (const char* uses : {"extensionsUsed", "extensionsRequired"}) {
    json.key(uses).begin('[').value(kDracoExtension).end(']');
  }
  json.key("scene").value(0).key("scenes").begin('[').begin('{');
  json.key("nodes").list(std::array<int, 1>{0}).end('}').end(']');
  write_nodes(json, transform);
  json.key("meshes").begin('[').begin('{').key("primitives").begin('[');
  write_primitive(json, gltf);
  json.end(']').end('}').end(']');
  // Sandstone, dull: what a viewer shows before anybody chooses a colour.
  json.key("materials").begin('[').begin('{').key("pbrMetallicRoughness").begin('{');
  json.key("baseColorFactor").list(std::array{0.8, 0.62, 0.38, 1.0});
  json.key("metallicFactor").value(0).key("roughnessFactor").value(0.75).end('}');
  json.key("doubleSided").value(false).end('}').end(']');
  write_accessors(json, gltf);
  for (const char* holder : {"bufferViews", "buffers"}) {
    json.key(holder).begin('[').begin('{').key("byteLength").value(gltf.bytes.size());
    if (std::string_view(holder) == "bufferViews") json.key("buffer").value(0);
    json.end('}').end(']');
  }
  return json.end('}').text();
}

void write_word(std::ostream& stream, std::size_t word) {
  for (int shift = 0; shift < 32; shift += 8) stream.put(static_cast<char>(word >> shift & 0xff));
}

std::size_t padded(std::size_t bytes) {
  return (bytes + 3) / 4 * 4;
}

/// A chunk's length, its type in four letters and its content, filled up to whole words.
void write_chunk(std::ostream& stream, std::string_view type, std::span<const std::byte> content, char filler) {
  write_word(stream, padded(content.size()));
  stream.write(type.data(), 4);
  stream.write(reinterpret_cast<const char*>(content.data()), static_cast<std::streamsize>(content.size()));
  for (std::size_t at = content.size(); at < padded(content.size()); ++at) stream.put(filler);
}

}  // namespace

Result<void> write_glb(std::ostream& stream, const IndexedMesh& mesh, const VertexAttributes& attributes,
                       const EncodeOptions& options) {
  if (auto encodable = check_level(mesh, attributes, options); !encodable) return encodable;
  const auto gltf = compress(prepare(mesh, attributes, options.transform), options);
  if (!gltf) return gltf.error();
  const std::string json = describe(*gltf, options.transform);
  const std::size_t length = 12 + 8 + padded(json.size()) + 8 + padded(gltf->bytes.size());
  if (length > std::numeric_limits<std::uint32_t>::max()) {
    return Error{ErrorCode::limit_exceeded, "a GLB of " + std::to_string(length) + " bytes; at most 4294967295"};
  }
  stream.write("glTF", 4);
  write_word(stream, 2);
  write_word(stream, length);
  write_chunk(stream, "JSON", std::as_bytes(std::span(json)), ' ');
  write_chunk(stream, std::string_view("BIN\0", 4), gltf->bytes, '\0');
  if (stream) return {};
  return Error{ErrorCode::unavailable, "the output stream failed while a GLB was written"};
}

}  // namespace geosis
