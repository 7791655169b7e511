#include "engine/codec/draco_part.h"

#include <cmath>
#include <exception>
#include <memory>
#include <string>
#include <utility>

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include "engine/codec/attribute_arrays.h"

namespace geosis {
namespace {

constexpr int kFastest = 10;  // Draco speed

constexpr const char* kNameEntry = "name";
constexpr const char* kSeamName = "seam";
constexpr const char* kTransformEntry = "transform";

Error malformed(std::string message) {
  return {ErrorCode::malformed_input, std::move(message)};
}

template <class T>
int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, std::int8_t components,
                  draco::DataType data_type, std::span<const T> values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, components, data_type, false, sizeof(T), 0);
  const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(values.size()));
  mesh.attribute(id)->buffer()->Write(0, values.data(), values.size_bytes());
  return id;
}

int add_vectors(draco::Mesh& mesh, draco::GeometryAttribute::Type type, std::span<const Vec3f> vectors) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float), "vectors are written to Draco as they lie in memory");
  return add_attribute(mesh, type, 3, draco::DT_FLOAT32, vectors);
}

template <class T>
constexpr draco::DataType kDataType = draco::DT_INVALID;
template <>
constexpr draco::DataType kDataType<std::uint8_t> = draco::DT_UINT8;
template <>
constexpr draco::DataType kDataType<std::uint16_t> = draco::DT_UINT16;
template <>
constexpr draco::DataType kDataType<std::uint32_t> = draco::DT_UINT32;
template <>
constexpr draco::DataType kDataType<float> = draco::DT_FLOAT32;

draco::Status add_named(draco::Mesh& mesh, draco::ExpertEncoder& encoder, const NamedNumbers& named) {
  const int id = std::visit(
      [&]<class T>(std::span<const T> numbers) {
        return add_attribute(mesh, draco::GeometryAttribute::GENERIC, 1, kDataType<T>, numbers);
      },
      named.numbers);
  auto metadata = std::make_unique<draco::AttributeMetadata>();
  metadata->AddEntryString(kNameEntry, named.name);
  mesh.AddAttributeMetadata(id, std::move(metadata));
  return encoder.SetAttributePredictionScheme(id, draco::PREDICTION_DIFFERENCE);
}

void add_triangles(draco::Mesh& mesh, const std::vector<Triangle>& triangles) {
  mesh.SetNumFaces(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    draco::Mesh::Face face;
    for (int corner = 0; corner < 3; ++corner) {
      face[corner] = draco::PointIndex(static_cast<std::uint32_t>(triangles[t][corner]));
    }
    mesh.SetFace(draco::FaceIndex(t), face);
  }
}

void add_transform(draco::Mesh& mesh, const std::array<double, 16>& transform) {
  auto metadata = std::make_unique<draco::GeometryMetadata>();
  metadata->AddEntryDoubleArray(kTransformEntry, {transform.begin(), transform.end()});
  mesh.AddMetadata(std::move(metadata));
}

/// Quantisation to the lattice itself: origin 0, and a range that makes one quantum one step. Every float in Draco's
/// arithmetic is then a small integer times a power of two, so that nothing is rounded on either side.
void quantise_on_lattice(draco::ExpertEncoder& encoder, int position, int bits) {
  const float origin[3] = {0, 0, 0};
  encoder.SetAttributeExplicitQuantization(position, bits, 3, origin,
                                           static_cast<float>((1 << bits) - 1) * kLatticeStep);
}

Result<std::vector<std::byte>> encode_with_draco(const IndexedMesh& level, const std::vector<NamedNumbers>& named,
                                                 const std::vector<Vec3f>& normals, const EncodeOptions& options) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(level.positions.size()));
  add_transform(mesh, options.transform);
  const int position = add_vectors(mesh, draco::GeometryAttribute::POSITION, level.positions);
  add_triangles(mesh, level.triangles);

  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(options.speed, options.speed);
  if (options.speed < kFastest) {
    // Draco's own choice from speed 5 on is two bits a triangle whatever the mesh; valence coding takes about one.
    encoder.options().SetGlobalInt("edgebreaker_method", draco::MESH_EDGEBREAKER_VALENCE_ENCODING);
  }
  // Every attribute belongs to the vertex: one connectivity for all of them at every speed.
  encoder.options().SetGlobalBool("split_mesh_on_seams", true);
  quantise_on_lattice(encoder, position, options.position_bits);
  draco::Status status = encoder.SetAttributePredictionScheme(position, draco::PREDICTION_DIFFERENCE);
  for (const NamedNumbers& numbers : named) {
    if (status.ok()) status = add_named(mesh, encoder, numbers);
  }
  if (!normals.empty()) {
    encoder.SetAttributeQuantization(add_vectors(mesh, draco::GeometryAttribute::NORMAL, normals), kNormalBits);
  }
  draco::EncoderBuffer buffer;
  if (status.ok()) status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) return Error{ErrorCode::internal, "Draco cannot encode: " + status.error_msg_string()};
  const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

/// The attribute's value at each point; Draco shares values between points when it likes.
template <class T>
std::vector<T> read_attribute(const draco::PointAttribute& attribute, std::uint32_t points) {
  std::vector<T> values(points);
  for (std::uint32_t p = 0; p < points; ++p) {
    attribute.GetMappedValue(draco::PointIndex(p), &values[p]);
  }
  return values;
}

bool holds(const draco::PointAttribute* attribute, int components, draco::DataType type, std::size_t bytes) {
  return attribute != nullptr && attribute->num_components() == components && attribute->data_type() == type &&
         attribute->byte_stride() == static_cast<std::int64_t>(bytes);
}

Result<std::vector<Vec3f>> read_positions(const draco::Mesh& mesh) {
  const draco::PointAttribute* attribute = mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (!holds(attribute, 3, draco::DT_FLOAT32, sizeof(Vec3f))) {
    return malformed("the Draco mesh has no positions of three float32");
  }
  auto positions = read_attribute<Vec3f>(*attribute, mesh.num_points());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3f p = positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      return malformed("the Draco mesh has a position that is not finite at point " + std::to_string(v));
    }
  }
  return positions;
}

Result<std::vector<Vec3f>> read_normals(const draco::Mesh& mesh) {
  const draco::PointAttribute* attribute = mesh.GetNamedAttribute(draco::GeometryAttribute::NORMAL);
  if (attribute == nullptr) return std::vector<Vec3f>{};
  if (!holds(attribute, 3, draco::DT_FLOAT32, sizeof(Vec3f))) {
    return malformed("the Draco mesh has normals that are not three float32");
  }
  return read_attribute<Vec3f>(*attribute, mesh.num_points());
}

/// Leaves the values empty when the mesh has nothing of that name.
template <class T>
Result<void> read_named(const draco::Mesh& mesh, const char* name, std::vector<T>& values) {
  const int id = mesh.GetAttributeIdByMetadataEntry(kNameEntry, name);
  if (id < 0) return {};
  const draco::PointAttribute* attribute = mesh.attribute(id);
  if (!holds(attribute, 1, kDataType<T>, sizeof(T))) {
    return malformed(std::string("the Draco mesh has another type of attribute under the name ") + name);
  }
  values = read_attribute<T>(*attribute, mesh.num_points());
  return {};
}

Result<std::vector<Triangle>> read_triangles(const draco::Mesh& mesh) {
  std::vector<Triangle> triangles(mesh.num_faces());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(t));
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t point = face[corner].value();
      if (point >= mesh.num_points()) {
        return malformed("Draco triangle " + std::to_string(t) + ": point " + std::to_string(point) + " of " +
                         std::to_string(mesh.num_points()));
      }
      triangles[t][corner] = static_cast<std::int32_t>(point);
    }
  }
  return triangles;
}

Result<MeshPart> decode_with_draco(std::span<const std::byte> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  draco::Mesh mesh;
  if (const draco::Status status = decoder.DecodeBufferToGeometry(&buffer, &mesh); !status.ok()) {
    return malformed("Draco cannot decode: " + status.error_msg_string());
  }
  auto positions = read_positions(mesh);
  if (!positions) return std::move(positions).error();
  auto triangles = read_triangles(mesh);
  if (!triangles) return std::move(triangles).error();
  MeshPart part{{*std::move(positions), *std::move(triangles)}, {}, {}};
  if (auto read = read_named(mesh, kSeamName, part.seams); !read) return std::move(read).error();
  auto read = visit_numbers([&](const char* name, auto array) {  //
    return read_named(mesh, name, part.attributes.*array);
  });
  if (!read) return std::move(read).error();
  auto normals = read_normals(mesh);
  if (!normals) return std::move(normals).error();
  part.attributes.normal = *std::move(normals);
  return part;
}

}  // namespace

Result<std::vector<std::byte>> encode_mesh(const IndexedMesh& mesh, const std::vector<NamedNumbers>& named,
                                           const std::vector<Vec3f>& normals, const EncodeOptions& options) {
  try {
    return encode_with_draco(mesh, named, normals, options);
  } catch (const std::exception& failure) {
    return Error{ErrorCode::internal, std::string("Draco cannot encode: ") + failure.what()};
  }
}

Result<EncodedPart> encode_part(const MeshPart& part, const EncodeOptions& options) {
  std::vector<NamedNumbers> named;
  if (!part.seams.empty()) named.push_back({kSeamName, std::span(part.seams)});
  for_each_number([&](const char* name, auto array) {
    if (!(part.attributes.*array).empty()) named.push_back({name, std::span(part.attributes.*array)});
  });
  auto bytes = encode_mesh(part.mesh, named, part.attributes.normal, options);
  if (!bytes) return std::move(bytes).error();
  return EncodedPart{*std::move(bytes), static_cast<std::int64_t>(part.mesh.triangles.size())};
}

Result<MeshPart> decode_part(std::span<const std::byte> bytes) {
  try {
    return decode_with_draco(bytes);
  } catch (const std::exception& failure) {
    return malformed(std::string("Draco cannot decode: ") + failure.what());
  }
}

}  // namespace geosis
