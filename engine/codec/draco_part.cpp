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

constexpr const char* kNameEntry = "name";
constexpr const char* kSeamName = "seam";
constexpr const char* kTransformEntry = "transform";

Error malformed(std::string message) {
  return {ErrorCode::malformed_input, std::move(message)};
}

template <class T>
int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, std::int8_t components,
                  draco::DataType data_type, const std::vector<T>& values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, components, data_type, false, sizeof(T), 0);
  const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(values.size()));
  mesh.attribute(id)->buffer()->Write(0, values.data(), values.size() * sizeof(T));
  return id;
}

int add_positions(draco::Mesh& mesh, const std::vector<Vec3f>& positions) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float), "positions are written to Draco as they lie in memory");
  return add_attribute(mesh, draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, positions);
}

template <class T>
constexpr draco::DataType kDataType = draco::DT_INVALID;
template <>
constexpr draco::DataType kDataType<std::uint8_t> = draco::DT_UINT8;
template <>
constexpr draco::DataType kDataType<std::uint32_t> = draco::DT_UINT32;
template <>
constexpr draco::DataType kDataType<float> = draco::DT_FLOAT32;

/// One number a vertex under a name; nothing when there are no values. Draco predicts integers and copies float32 bit
/// by bit, for it is not asked to quantise them.
template <class T>
draco::Status add_named(draco::Mesh& mesh, draco::ExpertEncoder& encoder, const char* name,
                        const std::vector<T>& values) {
  if (values.empty()) return draco::OkStatus();
  const int id = add_attribute(mesh, draco::GeometryAttribute::GENERIC, 1, kDataType<T>, values);
  auto metadata = std::make_unique<draco::AttributeMetadata>();
  metadata->AddEntryString(kNameEntry, name);
  mesh.AddAttributeMetadata(id, std::move(metadata));
  return encoder.SetAttributePredictionScheme(id, draco::PREDICTION_DIFFERENCE);
}

draco::Status add_everything_named(draco::Mesh& mesh, draco::ExpertEncoder& encoder, const MeshPart& part) {
  draco::Status status = add_named(mesh, encoder, kSeamName, part.seams);
  for_each_array([&](const char* name, auto array) {
    if (status.ok()) status = add_named(mesh, encoder, name, part.attributes.*array);
  });
  return status;
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

Result<EncodedPart> encode_with_draco(const MeshPart& part, const EncodeOptions& options) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(part.mesh.positions.size()));
  add_transform(mesh, options.transform);
  const int position = add_positions(mesh, part.mesh.positions);
  add_triangles(mesh, part.mesh.triangles);

  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(options.speed, options.speed);
  // Every attribute belongs to the vertex: one connectivity for all of them at every speed.
  encoder.options().SetGlobalBool("split_mesh_on_seams", true);
  quantise_on_lattice(encoder, position, options.position_bits);
  draco::Status status = encoder.SetAttributePredictionScheme(position, draco::PREDICTION_DIFFERENCE);
  if (status.ok()) status = add_everything_named(mesh, encoder, part);
  draco::EncoderBuffer buffer;
  if (status.ok()) status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) return Error{ErrorCode::internal, "Draco cannot encode: " + status.error_msg_string()};
  const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
  return EncodedPart{{bytes.begin(), bytes.end()}, static_cast<std::int64_t>(part.mesh.triangles.size())};
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
  auto read = visit_arrays([&](const char* name, auto array) {  //
    return read_named(mesh, name, part.attributes.*array);
  });
  if (!read) return std::move(read).error();
  return part;
}

}  // namespace

Result<EncodedPart> encode_part(const MeshPart& part, const EncodeOptions& options) {
  try {
    return encode_with_draco(part, options);
  } catch (const std::exception& failure) {
    return Error{ErrorCode::internal, std::string("Draco cannot encode: ") + failure.what()};
  }
}

Result<MeshPart> decode_part(std::span<const std::byte> bytes) {
  try {
    return decode_with_draco(bytes);
  } catch (const std::exception& failure) {
    return malformed(std::string("Draco cannot decode: ") + failure.what());
  }
}

}  // namespace geosis
