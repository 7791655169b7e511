#include "server/app/extractions/level_export.h"

#include <gtest/gtest.h>

#include "engine/base/digest.h"
#include "engine/codec/level_codec.h"
#include "server/app/extractions/result_streams.h"
#include "server/store/memory_store.h"
#include "server/store/piece_sums.h"
#include "tests/server/app/service_fixture.h"

namespace geosis::server {
namespace {

using namespace std::chrono_literals;
using test::read_all;
using test::Service;

class LevelExportTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto extraction =
        *service.extractions.create(service.add_ball(), test::ball_request(), Priority::interactive);
    extraction->wait_for(30s);
    id = extraction->identity().id;
  }
  std::string file_of(int level, LevelFormat format) {
    auto file = service.extractions.level(id, level, format);
    EXPECT_TRUE(file) << file.error().message;
    const std::string text = read_all(*file->stream);
    EXPECT_EQ(text.size(), file->bytes);
    EXPECT_EQ(sha256_hex(std::as_bytes(std::span(text))), file->sha256);
    return text;
  }

  std::unique_ptr<BlobStore> store = std::move(*open_memory_store());
  Service service{*store};
  std::string id;
};

TEST_F(LevelExportTest, LevelOfOnePartIsThatPart) {
  const std::string whole = file_of(2, LevelFormat::drc);
  auto part = service.extractions.part(id, 2, 0);
  ASSERT_TRUE(part);
  EXPECT_EQ(whole, read_all(*part->stream));
}

TEST_F(LevelExportTest, OtherFormatsAreMadeOnceAndStayTheSame) {
  const std::string ply = file_of(3, LevelFormat::ply);
  EXPECT_TRUE(ply.starts_with("ply\n"));
  EXPECT_EQ(file_of(3, LevelFormat::ply), ply);
  EXPECT_TRUE(file_of(3, LevelFormat::obj).starts_with("v "));
  EXPECT_TRUE(file_of(3, LevelFormat::glb).starts_with("glTF"));
  EXPECT_TRUE(file_of(3, LevelFormat::stl).starts_with("origin 0 0 0 "));
}

TEST_F(LevelExportTest, SeveralPartsBecomeOneMesh) {
  // A level cut into small parts, as a big one is, put back together by the export.
  const auto bytes = service.extractions.part(id, 0, 0);
  ASSERT_TRUE(bytes);
  const std::string text = read_all(*bytes->stream);
  const auto decoded = decode_level({std::as_bytes(std::span(text))});
  ASSERT_TRUE(decoded);
  const auto cut = encode_level(decoded->mesh, {}, {.position_bits = 11, .max_part_triangles = 100});
  ASSERT_TRUE(cut);
  Json parts = Json::array();
  for (std::size_t n = 0; n < cut->parts.size(); ++n) parts.push_back(Json::object());
  ASSERT_GT(parts.size(), 3u);
  const Json manifest = {{"transform", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
                         {"levels", {{{"parts", parts}}}}};
  const auto staged = store->stage();
  ASSERT_TRUE(staged);
  NoProgress progress;
  const PartReader read = [&](int, int part) -> Result<std::vector<std::byte>> {
    return cut->parts[static_cast<std::size_t>(part)].bytes;
  };
  const auto described = export_level((*staged)->path(), manifest, 0, LevelFormat::drc, read, 1, progress);
  ASSERT_TRUE(described) << described.error().message;
  auto stream = file_stream((*staged)->path().string(), *sums_of_file((*staged)->path()), [] {});
  ASSERT_TRUE(stream);
  const std::string whole = read_all(**stream);
  const auto joined = decode_level({std::as_bytes(std::span(whole))});
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->mesh.positions.size(), decoded->mesh.positions.size());
  EXPECT_EQ(joined->mesh.triangles.size(), decoded->mesh.triangles.size());
}

}  // namespace
}  // namespace geosis::server
