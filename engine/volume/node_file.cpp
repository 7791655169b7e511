#include "engine/volume/node_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include <xxhash.h>

#include "engine/base/digest.h"
#include "engine/base/hexadecimal.h"
#include "engine/volume/brick_layout.h"
#include "engine/volume/file_header.h"
#include "engine/volume/mapped_file.h"
#include "engine/volume/new_file.h"
#include "engine/volume/write_behind.h"

namespace geosis {
namespace {

static_assert(std::endian::native == std::endian::little, "node files are copied as they are");
static_assert(sizeof(Vec3f) == 12 && sizeof(Vec3d) == 24, "three numbers and nothing else");

constexpr std::array<char, 8> kMagic = {'G', 'E', 'O', 'N', 'O', 'D', 'E', 'S'};
constexpr std::string_view kKind = "node";
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kTimes = 1, kMirrored = 2;
constexpr std::uint64_t kWriteBehind = std::uint64_t{8} << 20;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::array<std::int32_t, 3> shape{};
  std::uint32_t flags = 0;
  std::uint32_t reserved = 0;
  std::array<double, 3> origin{}, low{}, high{};
  std::int64_t folded_cells = 0;
  std::array<std::byte, 32> digest{};
  std::uint64_t file_bytes = 0;
  std::uint64_t body_checksum = 0;  // XXH3-64 of all that follows the header
  std::uint64_t checksum = 0;       // XXH3-64 of the header with this field zero
};
static_assert(sizeof(Header) == 168);

Error damaged(const std::string& what) {
  return damaged_file(kKind, what);
}

std::array<double, 3> numbers_of(Vec3d p) {
  return {p.x, p.y, p.z};
}
Vec3d point_of(const std::array<double, 3>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

/// The digest of a grid before its offsets: what kind of thing it is, its shape and its origin.
Sha256 begin_digest(GridShape shape, bool times, Vec3d origin) {
  Sha256 digest;
  digest.update("geosis grid 1\n" + std::to_string(shape.inlines) + " " + std::to_string(shape.crosslines) + " " +
                std::to_string(shape.samples) + "\n" + (times ? "times" : "lengths") + "\n");
  const std::array<double, 3> numbers = numbers_of(origin);
  digest.update(std::as_bytes(std::span(numbers)));
  return digest;
}

std::int64_t cells_of(GridShape shape) {
  return GridShape{shape.inlines - 1, shape.crosslines - 1, shape.samples - 1}.count();
}

NodeReport report_of(const Header& header, GridShape shape) {
  return {.mirrored = (header.flags & kMirrored) != 0,
          .folded_cells = header.folded_cells,
          .folded_share = static_cast<double>(header.folded_cells) / static_cast<double>(cells_of(shape))};
}

NodeSummary summary_of(const Header& header, GridShape shape) {
  return {.shape = shape,
          .times = (header.flags & kTimes) != 0,
          .digest = hexadecimal(header.digest),
          .report = report_of(header, shape),
          .low = point_of(header.low),
          .high = point_of(header.high),
          .bytes = header.file_bytes};
}

bool are_finite(std::span<const Vec3f> nodes) {
  return std::ranges::all_of(nodes,
                             [](Vec3f p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); });
}

Result<Header> read_header_of(GridShape shape, std::span<const std::byte> file) {
  const auto read = read_header<Header>(kKind, file);
  if (!read) return read;
  const Header& header = *read;
  if (GridShape{header.shape[0], header.shape[1], header.shape[2]} != shape)
    return damaged("belongs to a volume of another shape");
  for (const auto& point : {header.origin, header.low, header.high}) {
    if (!std::ranges::all_of(point, [](double number) { return std::isfinite(number); }))
      return damaged("its header has a number that is none");
  }
  if (header.folded_cells < 0 || header.folded_cells > cells_of(shape))
    return damaged(std::to_string(header.folded_cells) + " folded cells");
  return header;
}

}  // namespace

struct NodeFileWriter::State {
  State(NodeOffsets nodes, NewFile made, bool is_times)
      : offsets(nodes), file(std::move(made)), times(is_times), behind(file.file()), checksum(XXH3_createState()) {
    XXH3_64bits_reset(checksum);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { XXH3_freeState(checksum); }

  NodeOffsets offsets;
  NewFile file;
  bool times;
  WriteBehind behind;
  XXH3_state_t* checksum;
  std::optional<Sha256> digest;  // once the origin is known
  std::vector<Vec3f> piece;
  std::uint64_t written = sizeof(Header), handed_on = 0;
};

NodeFileWriter::NodeFileWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
NodeFileWriter::NodeFileWriter(NodeFileWriter&&) noexcept = default;
NodeFileWriter::~NodeFileWriter() = default;

Result<NodeFileWriter> NodeFileWriter::create(GridShape shape, bool times,
                                              const std::optional<std::filesystem::path>& path) {
  if (auto sound = check_axes(shape); !sound) return std::move(sound).error();
  auto offsets = NodeOffsets::begin(shape);
  if (!offsets) return std::move(offsets).error();
  auto file = NewFile::create(path, sizeof(Header) + static_cast<std::uint64_t>(shape.count()) * sizeof(Vec3f));
  if (!file) return std::move(file).error();
  return NodeFileWriter(std::make_unique<State>(*offsets, *std::move(file), times));
}

Result<void> NodeFileWriter::put(std::span<const Vec3d> nodes) {
  State& state = *state_;
  state.piece.clear();
  if (auto added = state.offsets.add(nodes, state.piece); !added) return added;
  if (!state.digest) state.digest = begin_digest(state.offsets.shape(), state.times, state.offsets.origin());
  const auto bytes = std::as_bytes(std::span(state.piece));
  state.digest->update(bytes);
  XXH3_64bits_update(state.checksum, bytes.data(), bytes.size());
  if (auto written = state.file.write_at(state.written, bytes); !written) return written;
  state.written += bytes.size();
  if (state.written - state.handed_on < kWriteBehind) return {};
  state.behind.add(state.handed_on, state.written - state.handed_on);
  state.handed_on = state.written;
  return {};
}

Result<NodeGrid> NodeFileWriter::finish(int threads) && {
  const std::unique_ptr<State> state = std::move(state_);
  const NodeOffsets& offsets = state->offsets;
  const GridShape shape = offsets.shape();
  if (auto whole = offsets.end(); !whole) return std::move(whole).error();
  const auto* nodes = reinterpret_cast<const Vec3f*>(state->file.writable().data() + sizeof(Header));
  const auto report = look_at_cells(shape, {nodes, static_cast<std::size_t>(shape.count())}, threads);
  if (!report) return report.error();
  Header header;
  header.shape = {shape.inlines, shape.crosslines, shape.samples};
  header.flags = (state->times ? kTimes : 0) | (report->mirrored ? kMirrored : 0);
  header.origin = numbers_of(offsets.origin());
  header.low = numbers_of(offsets.low());
  header.high = numbers_of(offsets.high());
  header.folded_cells = report->folded_cells;
  header.digest = std::move(*state->digest).bytes();
  header.file_bytes = state->written;
  header.body_checksum = XXH3_64bits_digest(state->checksum);
  header.checksum = header_checksum(header);
  std::memcpy(state->file.writable().data(), &header, sizeof header);
  auto published = std::move(state->file).publish();
  if (!published) return std::move(published).error();
  const std::shared_ptr<MappedFile> file = *std::move(published);
  return NodeGrid{
      CurvilinearGeometry(shape, offsets.origin(), {nodes, static_cast<std::size_t>(shape.count())}, file, *report),
      summary_of(header, shape)};
}

Result<NodeGrid> read_node_file(GridShape shape, std::span<const std::byte> file, std::shared_ptr<const void> owner) {
  const auto header = read_header_of(shape, file);
  if (!header) return header.error();
  const std::span<const std::byte> body = file.subspan(sizeof(Header));
  const auto expected = static_cast<std::uint64_t>(shape.count()) * sizeof(Vec3f);
  if (body.size() != expected) {
    return damaged(std::to_string(body.size()) + " bytes behind its header; expected " + std::to_string(expected));
  }
  if (XXH3_64bits(body.data(), body.size()) != header->body_checksum) return damaged("it fails its checksum");
  const std::span nodes(reinterpret_cast<const Vec3f*>(body.data()), body.size() / sizeof(Vec3f));
  if (!are_finite(nodes)) return damaged("a position is not finite");
  return NodeGrid{
      CurvilinearGeometry(shape, point_of(header->origin), nodes, std::move(owner), report_of(*header, shape)),
      summary_of(*header, shape)};
}

Result<NodeGrid> open_node_file(GridShape shape, const std::filesystem::path& path) {
  auto opened = MappedFile::open(path);
  if (!opened) return std::move(opened).error();
  const std::shared_ptr<MappedFile> file = *std::move(opened);
  return read_node_file(shape, file->bytes(), file);
}

}  // namespace geosis
