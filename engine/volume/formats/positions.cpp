#include "engine/volume/formats/positions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/volume/mapped_file.h"
#include "engine/volume/sample_box.h"

namespace geosis {
namespace {

constexpr std::size_t kNodesAtOnce = 1 << 15;
const Error kCancelled = {ErrorCode::cancelled, "reading node positions was cancelled"};

std::size_t traces_of(GridShape shape) {
  return static_cast<std::size_t>(shape.inlines) * static_cast<std::size_t>(shape.crosslines);
}

std::size_t bytes_per_number(const PositionFormat& format) {
  return format.is_double ? sizeof(double) : sizeof(float);
}

template <class Bits>
Bits swapped(Bits bits) {
  Bits result = 0;
  for (std::size_t byte = 0; byte < sizeof bits; ++byte, bits >>= 8) result = result << 8 | (bits & 0xff);
  return result;
}

template <class Number, class Bits>
double number_at(const std::byte* bytes, bool big_endian) {
  Bits bits;
  std::memcpy(&bits, bytes, sizeof bits);
  return static_cast<double>(std::bit_cast<Number>(big_endian ? swapped(bits) : bits));
}

/// The numbers of a source, one after the other.
class NumberReader {
 public:
  NumberReader(const ByteSource& source, const PositionFormat& format) : source_(source), format_(format) {}

  Result<void> read(std::span<double> numbers) {
    const std::size_t size = bytes_per_number(format_);
    bytes_.resize(numbers.size() * size);
    if (auto read = source_.read_at(position_, bytes_); !read) return read;
    position_ += bytes_.size();
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      const std::byte* at = bytes_.data() + n * size;
      numbers[n] = format_.is_double ? number_at<double, std::uint64_t>(at, format_.big_endian)
                                     : number_at<float, std::uint32_t>(at, format_.big_endian);
    }
    return {};
  }

 private:
  const ByteSource& source_;
  const PositionFormat format_;
  std::vector<std::byte> bytes_;
  std::uint64_t position_ = 0;
};

/// Where a reading is: reports, and asks whether to go on.
class Steps {
 public:
  Steps(std::uint64_t all, Progress& progress) : all_(all), progress_(progress) {}
  Result<void> go_on(std::uint64_t done) {
    if (progress_.cancelled()) return kCancelled;
    progress_.report("import", static_cast<double>(done) / static_cast<double>(all_));
    return {};
  }

 private:
  const std::uint64_t all_;
  Progress& progress_;
};

Result<void> move_nodes(NumberReader& reader, GridShape shape, NodeFileWriter& writer, Progress& progress) {
  const auto count = static_cast<std::uint64_t>(shape.count());
  Steps steps(count, progress);
  std::vector<double> numbers;
  std::vector<Vec3d> nodes;
  for (std::uint64_t first = 0; first < count; first += nodes.size()) {
    if (auto on = steps.go_on(first); !on) return on;
    nodes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(count - first, kNodesAtOnce)));
    numbers.resize(3 * nodes.size());
    if (auto read = reader.read(numbers); !read) return read;
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = {numbers[3 * n], numbers[3 * n + 1], numbers[3 * n + 2]};
    if (auto put = writer.put(nodes); !put) return put;
  }
  return {};
}

/// The pillars of all traces, on a file that has no name.
class Pillars {
 public:
  static Result<Pillars> read(NumberReader& reader, GridShape shape, const std::filesystem::path& folder) {
    auto file = folder.empty() ? MappedFile::create_unnamed(traces_of(shape) * sizeof(Pillar))
                               : MappedFile::create_unnamed(traces_of(shape) * sizeof(Pillar), folder);
    if (!file) return std::move(file).error();
    std::vector<double> numbers;
    for (std::size_t first = 0; first < traces_of(shape); first += numbers.size() / 6) {
      numbers.resize(6 * std::min(traces_of(shape) - first, kNodesAtOnce));
      if (auto read = reader.read(numbers); !read) return std::move(read).error();
      if (auto put = (*file)->write_at(first * sizeof(Pillar), std::as_bytes(std::span(numbers))); !put) {
        return std::move(put).error();
      }
    }
    return Pillars(*std::move(file));
  }

  Pillar operator[](std::size_t trace) const {
    Pillar pillar;
    std::memcpy(&pillar, file_->bytes().data() + trace * sizeof(Pillar), sizeof pillar);
    return pillar;
  }

 private:
  explicit Pillars(std::unique_ptr<MappedFile> file) : file_(std::move(file)) {}
  static_assert(sizeof(Pillar) == 6 * sizeof(double), "six numbers and nothing else");

  std::unique_ptr<MappedFile> file_;
};

Result<void> move_pillars(NumberReader& reader, GridShape shape, const std::filesystem::path& folder,
                          NodeFileWriter& writer, Progress& progress) {
  const auto pillars = Pillars::read(reader, shape, folder);
  if (!pillars) return pillars.error();
  const auto samples = static_cast<std::size_t>(shape.samples);
  const std::size_t traces_at_once = std::max<std::size_t>(kNodesAtOnce / samples, 1);
  Steps steps(traces_of(shape), progress);
  std::vector<double> depths;
  std::vector<Vec3d> nodes;
  for (std::size_t first = 0; first < traces_of(shape); first += traces_at_once) {
    if (auto on = steps.go_on(first); !on) return on;
    const std::size_t traces = std::min(traces_of(shape) - first, traces_at_once);
    depths.resize(traces * samples);
    if (auto read = reader.read(depths); !read) return read;
    nodes.clear();
    for (std::size_t n = 0; n < traces; ++n) {
      const Pillar pillar = (*pillars)[first + n];
      if (auto sound = check_pillar(shape, first + n, pillar); !sound) return sound;
      for (std::size_t k = 0; k < samples; ++k) nodes.push_back(point_on(pillar, depths[n * samples + k]));
    }
    if (auto put = writer.put(nodes); !put) return put;
  }
  return {};
}

const char* kind_of(const PositionFormat& format) {
  return format.kind == PositionFormat::Kind::nodes ? "nodes" : "pillars";
}

const char* type_of(const PositionFormat& format) {
  return format.is_double ? "float64" : "float32";
}

Error wrong_size(std::uint64_t bytes, GridShape shape, const PositionFormat& format) {
  std::string text = std::to_string(bytes) + " bytes; expected " + std::to_string(position_bytes(shape, format)) +
                     " for the " + std::to_string(shape.inlines) + " x " + std::to_string(shape.crosslines) + " x " +
                     std::to_string(shape.samples) + " nodes of the volume, as " + kind_of(format) + " of " +
                     type_of(format);
  for (const auto kind : {PositionFormat::Kind::nodes, PositionFormat::Kind::pillars}) {
    for (const bool is_double : {false, true}) {
      const PositionFormat other = {.kind = kind, .is_double = is_double};
      if (position_bytes(shape, other) != bytes) continue;
      text += std::string("; as ") + kind_of(other) + " of " + type_of(other) + " they would fit";
    }
  }
  return bad_positions(text);
}

Error about_coordinate(int axis, const Error& error) {
  constexpr const char* kNames[] = {"x: ", "y: ", "z: "};
  return {error.code, kNames[axis] + error.message};
}

Error missing_sample(GridIndex node) {
  return {ErrorCode::malformed_input, "node [" + std::to_string(node.i) + "," + std::to_string(node.j) + "," +
                                          std::to_string(node.k) + "] is missing in the volume that it is taken from"};
}

/// One coordinate of all nodes of a box, from the samples of a volume.
Result<void> take_coordinate(const BrickedVolume& volume, const GridBox& box, int axis, std::span<Vec3d> nodes) {
  const auto samples = read_box(volume, box);
  if (!samples) return about_coordinate(axis, samples.error());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const float sample = samples->value[n];
    if (std::isnan(sample)) {
      const auto trace = static_cast<std::int32_t>(n / static_cast<std::size_t>(samples->shape.samples));
      const auto k = static_cast<std::int32_t>(n % static_cast<std::size_t>(samples->shape.samples));
      return about_coordinate(axis, missing_sample({box.first.i, box.first.j + trace, box.first.k + k}));
    }
    nodes[n][axis] = static_cast<double>(sample);
  }
  return {};
}

/// Nodes of a box of traces of one inline where the geometry puts them.
void place_box(const GridGeometry& geometry, const GridBox& box, std::vector<Vec3d>& nodes) {
  nodes.clear();
  for (std::int32_t j = box.first.j; j <= box.last.j; ++j) {
    for (std::int32_t k = 0; k <= box.last.k; ++k) {
      nodes.push_back(geometry.map({static_cast<double>(box.first.i), static_cast<double>(j), static_cast<double>(k)}));
    }
  }
}

Result<void> put_box(const CoordinateVolumes& coordinates, const GridBox& box, std::vector<Vec3d>& nodes,
                     NodeFileWriter& writer) {
  place_box(coordinates.otherwise, box, nodes);
  for (int axis = 0; axis < 3; ++axis) {
    const BrickedVolume* volume = coordinates.volumes[static_cast<std::size_t>(axis)];
    if (volume == nullptr) continue;
    if (auto taken = take_coordinate(*volume, box, axis, nodes); !taken) return taken;
  }
  return writer.put(nodes);
}

}  // namespace

std::uint64_t position_bytes(GridShape shape, const PositionFormat& format) {
  const auto nodes = static_cast<std::uint64_t>(shape.count());
  const std::uint64_t numbers =
      format.kind == PositionFormat::Kind::nodes ? 3 * nodes : nodes + 6 * static_cast<std::uint64_t>(traces_of(shape));
  return numbers * bytes_per_number(format);
}

Result<NodeGrid> import_positions(const ByteSource& source, GridShape shape, const PositionFormat& format,
                                  const std::optional<std::filesystem::path>& node_file, int threads,
                                  Progress& progress) {
  if (source.size() != position_bytes(shape, format)) return wrong_size(source.size(), shape, format);
  auto writer = NodeFileWriter::create(shape, false, node_file);
  if (!writer) return std::move(writer).error();
  NumberReader reader(source, format);
  auto moved = format.kind == PositionFormat::Kind::nodes
                   ? move_nodes(reader, shape, *writer, progress)
                   : move_pillars(reader, shape, node_file ? node_file->parent_path() : std::filesystem::path(),
                                  *writer, progress);
  if (!moved) return std::move(moved).error();
  return std::move(*writer).finish(threads);
}

Result<NodeGrid> place_nodes(const CoordinateVolumes& coordinates, GridShape shape,
                             const std::optional<std::filesystem::path>& node_file, int threads, Progress& progress) {
  auto writer = NodeFileWriter::create(shape, coordinates.times && coordinates.volumes[2] == nullptr, node_file);
  if (!writer) return std::move(writer).error();
  const auto traces_at_once = std::max<std::int32_t>(static_cast<std::int32_t>(kNodesAtOnce) / shape.samples, 1);
  Steps steps(static_cast<std::uint64_t>(shape.inlines), progress);
  std::vector<Vec3d> nodes;
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    if (auto on = steps.go_on(static_cast<std::uint64_t>(i)); !on) return std::move(on).error();
    for (std::int32_t j = 0; j < shape.crosslines; j += traces_at_once) {
      const std::int32_t last = std::min(j + traces_at_once, shape.crosslines) - 1;
      const GridBox box = {{i, j, 0}, {i, last, shape.samples - 1}};
      if (auto put = put_box(coordinates, box, nodes, *writer); !put) return std::move(put).error();
    }
  }
  return std::move(*writer).finish(threads);
}

}  // namespace geosis
