// Writes small valid inputs for the fuzz targets: write_fuzz_seeds FOLDER -> FOLDER/fuzz_<target>/<name>.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

#include <geosis/v1/extraction.pb.h>
#include <geosis/v1/volume.pb.h>

#include "engine/missing/fill.h"
#include "engine/structure/grid_file.h"
#include "engine/volume/brick_file.h"
#include "engine/volume/brick_writer.h"
#include "engine/volume/formats/segy_write.h"
#include "engine/volume/node_file.h"
#include "server/documents/json_text.h"
#include "server/grpc/messages/message_codec.h"

namespace {

using geosis::GridShape;

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream out(path, std::ios::binary);
  out << bytes;
  return out.good();
}

void ramp(std::int32_t i, std::int32_t j, std::span<float> samples) {
  for (std::size_t k = 0; k < samples.size(); ++k) samples[k] = static_cast<float>(i + 2 * j) + static_cast<float>(k);
}

// The fuzz target takes its options from two bytes before the file.
bool write_segy_seed(const std::filesystem::path& folder) {
  geosis::SegySurvey survey;
  survey.shape = {3, 4, 2};
  survey.inline_axis = {10, 2};
  survey.crossline_axis = {20, 1};
  survey.geometry = geosis::AffineGeometry({1000, 2000, 0}, {25, 0, 0}, {0, 12.5, 0}, {0, 0, 4});
  geosis::NoProgress unwatched;
  const auto plain = folder / "survey.sgy";
  if (!geosis::write_segy(plain, survey, ramp, {}, unwatched)) return false;
  const bool written = write_file(folder / "survey", std::string(2, '\0') + read_file(plain));
  std::filesystem::remove(plain);
  return written;
}

bool write_raw_seed(const std::filesystem::path& folder) {
  const std::string options = {3, 4, 5, 0, 3, 0, 0, 0};  // 3 x 4 x 5 uint8
  return write_file(folder / "uint8", options + std::string(3 * 4 * 5, 'x'));
}

bool write_brick_seed(const std::filesystem::path& folder) {
  auto writer = geosis::BrickWriter::create({3, 2, 66}, folder / "bricks");
  if (!writer) return false;
  std::vector<float> samples(66);
  for (std::int32_t i = 0; i < 3; ++i)
    for (std::int32_t j = 0; j < 2; ++j) {
      ramp(i, j, samples);
      writer->put(i, j, 0, samples);
    }
  geosis::NoProgress unwatched;
  return std::move(*writer).finish(1, unwatched).has_value();
}

// Of the volume that the fuzz target knows.
bool write_fill_seed(const std::filesystem::path& folder) {
  std::vector<float> samples(3 * 2 * 66);
  for (std::size_t n = 0; n < samples.size(); ++n)
    samples[n] = n % 7 == 3 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(n);
  const auto volume = geosis::make_bricked_volume({3, 2, 66}, samples);
  geosis::NoProgress unwatched;
  return geosis::fill_missing(*volume, {.method = geosis::FillMethod::linear}, folder / "filled", 1, unwatched)
      .has_value();
}

/// A grid of 2 x 3 traces of 5 samples in 9 layers.
bool write_grid_seed(const std::filesystem::path& folder) {
  constexpr geosis::GridShape kShape = {2, 3, 5};
  const std::vector<std::int32_t> path = {0, 0, 1, 1, 2, 3, 3, 4, 4};
  geosis::StructuralGrid grid;
  grid.paths = geosis::LayerPaths(kShape, static_cast<std::int32_t>(path.size()));
  for (std::int32_t i = 0; i < kShape.inlines; ++i) {
    for (std::int32_t j = 0; j < kShape.crosslines; ++j) grid.paths.set(i, j, path);
  }
  grid.agreement.assign(12, 200);
  return geosis::write_grid_file(grid, folder / "nine_layers").has_value();
}

/// Nodes of a grid of 3 x 2 x 4, sample fastest.
std::vector<geosis::Vec3d> small_nodes() {
  std::vector<geosis::Vec3d> nodes;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 4; ++k) nodes.push_back({25.0 * i, 12.5 * j, 4.0 * k + i});
  return nodes;
}

bool write_node_seed(const std::filesystem::path& folder) {
  auto writer = geosis::NodeFileWriter::create({3, 2, 4}, false, folder / "nodes");
  return writer && writer->put(small_nodes()) && std::move(*writer).finish(1);
}

// The fuzz target takes the format from a byte before the file.
bool write_position_seed(const std::filesystem::path& folder) {
  const auto nodes = small_nodes();
  const std::string bytes(reinterpret_cast<const char*>(nodes.data()), nodes.size() * sizeof nodes.front());
  return write_file(folder / "doubles", "\2" + bytes);
}

std::string with_length(const google::protobuf::Message& message) {
  const std::string bytes = message.SerializeAsString();
  return std::string{static_cast<char>(bytes.size() >> 8), static_cast<char>(bytes.size())} + bytes;
}

/// The first byte of each says which message follows.
bool write_grpc_seeds(const std::filesystem::path& folder, const std::string& request) {
  geosis::v1::CreateExtractionRequest create;
  create.set_volume("a");
  create.set_priority(geosis::v1::PRIORITY_BATCH);
  geosis::server::rpc::set_message(*create.mutable_request(), *geosis::server::parse_json(request));
  geosis::v1::UploadVolumeRequest options, chunk;
  const auto import = geosis::server::parse_json(
      R"({"format": "raw", "byte_order": "little", "null_value": -999, "dims": [2, 3, 4], "dtype": "int16", "order": "ijk",
      "origin": [0, 1, 2], "spacing": [25, 25, 4]})");
  geosis::server::rpc::set_message(*options.mutable_options()->mutable_import(), *import);
  options.mutable_options()->set_sha256(std::string(32, 'x'));
  options.mutable_options()->set_bytes(6);
  chunk.set_chunk("abc");
  geosis::v1::ExtractRequest extract, last;
  *extract.mutable_options()->mutable_request() = create.request();
  *extract.mutable_options()->mutable_import() = options.options().import();
  last.set_chunk("survey");
  geosis::v1::StreamLodsRequest stream;
  stream.set_id("a");
  stream.set_from_level(2);
  return write_file(folder / "upload",
                    std::string(1, '\0') + with_length(options) + with_length(chunk) + with_length(chunk)) &&
         write_file(folder / "extract", "\1" + with_length(extract) + with_length(last)) &&
         write_file(folder / "create", "\2" + create.SerializeAsString()) &&
         write_file(folder / "stream", "\3" + stream.SerializeAsString());
}

// What clients send. The targets of chunks and forms take the size of pieces from a byte before them.
bool write_text_seeds(const std::filesystem::path& folder) {
  const std::string request =
      R"({"range": [0.5, null], "mode": "exact", "missing": {"method": "rbf", "kernel": "polyharmonic", "steer": "auto",
      "max_distance": 4}, "grid": "given", "space": "world", "velocity": 2000, "cap": true, "region": {"inline": [0, 7],
      "crossline": [0, 18], "sample": [0, 26]}, "bodies": {"min_voxels": 3, "largest": 2, "seeds": [[1, 2, 3]]}, "levels":
      [{"ratio": 1}, {"max_error": 2.0, "error_cap": 1, "drop": {"max_voxels": 1, "max_error": 0}}, {"max_cost": 4}],
      "simplify": {"strategy": "greedy", "placement": "optimal", "seed": 1}, "codec": {"position_bits": 14, "normals": true,
      "speed": 3}, "attributes": ["reliability", "body"], "attribute_volume": null, "preview": false})";
  const std::string form =
      "--b\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n{\"format\": \"raw\"}\r\n"
      "--b\r\nContent-Disposition: form-data; name=\"file\"; filename=\"a.sgy\"\r\n\r\n\r\n--a\r\n--b--\r\n";
  return write_file(folder / "fuzz_request" / "whole", request) &&
         write_grpc_seeds(folder / "fuzz_grpc_messages", request) &&
         write_file(folder / "fuzz_http_head" / "post",
                    "POST /v1/volumes?name=a HTTP/1.1\r\nHost: a:80\r\nTransfer-Encoding: chunked\r\n"
                    "Expect: 100-continue\r\nConnection: keep-alive, close\r\n\r\n") &&
         write_file(folder / "fuzz_http_head" / "get", "GET / HTTP/1.1\r\nHost: [::1]\r\nContent-Length: 0\r\n\r\n") &&
         write_file(folder / "fuzz_http_chunks" / "two", "\3A;a=\"b\"\r\n0123456789\r\n1\r\nx\r\n0\r\nA: b\r\n\r\n") &&
         write_file(folder / "fuzz_http_target" / "level", "/v1/extractions/a%2Db/lods/12.glb?x=1+2&y=%c3%a4") &&
         write_file(folder / "fuzz_http_form" / "two", "\5" + form);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: write_fuzz_seeds FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  std::error_code failed;
  for (const char* target : {"fuzz_import_segy", "fuzz_import_raw", "fuzz_brick_file", "fuzz_fill_file",
                             "fuzz_grid_file", "fuzz_node_file", "fuzz_positions", "fuzz_request", "fuzz_http_head",
                             "fuzz_http_chunks", "fuzz_http_target", "fuzz_http_form", "fuzz_grpc_messages"})
    std::filesystem::create_directories(folder / target, failed);
  const bool written = !failed && write_segy_seed(folder / "fuzz_import_segy") &&
                       write_raw_seed(folder / "fuzz_import_raw") && write_brick_seed(folder / "fuzz_brick_file") &&
                       write_fill_seed(folder / "fuzz_fill_file") && write_grid_seed(folder / "fuzz_grid_file") &&
                       write_node_seed(folder / "fuzz_node_file") && write_position_seed(folder / "fuzz_positions") &&
                       write_text_seeds(folder);
  return written ? 0 : 1;
}
