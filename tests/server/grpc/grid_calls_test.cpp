#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <geosis/v1/grid.grpc.pb.h>
#include <gtest/gtest.h>

#include "tests/server/grpc/door_fixture.h"

namespace geosis::server::rpc {
namespace {

/// Positions of the ball's nodes, 20 an axis, as float64.
std::string node_bytes() {
  std::vector<double> numbers;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      for (int k = 0; k < 20; ++k) numbers.insert(numbers.end(), {25.0 * i, 12.5 * j, 4.0 * k + i});
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)};
}

class GridCalls : public test::DoorTest {
 protected:
  void begin() {
    start();
    volume = upload_ball();
    grids = v1::GridService::NewStub(new_channel());
  }
  v1::UploadGridRequest options() const {
    v1::UploadGridRequest request;
    request.mutable_options()->set_volume(volume);
    request.mutable_options()->set_dtype("float64");
    return request;
  }
  static v1::UploadGridRequest chunk(const std::string& bytes) {
    v1::UploadGridRequest request;
    request.set_chunk(bytes);
    return request;
  }
  /// Options, then the bytes in two chunks.
  grpc::Status upload(const std::string& bytes, v1::AddGridResponse& response) {
    grpc::ClientContext context;
    const auto writer = grids->UploadGrid(&context, &response);
    writer->Write(options());
    writer->Write(chunk(bytes.substr(0, 1000)));
    writer->Write(chunk(bytes.substr(1000)));
    writer->WritesDone();
    return writer->Finish();
  }
  std::size_t stored() const { return service->volumes.grids().list(volume, 10, "")->at("grids").size(); }

  std::string volume;
  std::unique_ptr<v1::GridService::Stub> grids;
};

TEST_F(GridCalls, AnUploadIsAGridThatRequestsMayName) {
  begin();
  v1::AddGridResponse response;
  const auto status = upload(node_bytes(), response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(response.is_new());
  EXPECT_EQ(response.grid().kind(), "nodes");
  EXPECT_EQ(response.grid().box().max().x(), 475);
  v1::CreateExtractionRequest asked;
  asked.set_volume(volume);
  *asked.mutable_request() = ball_range();
  asked.mutable_request()->set_grid(response.grid().id());
  grpc::ClientContext context;
  v1::Extraction extraction;
  ASSERT_TRUE(extractions->CreateExtraction(&context, asked, &extraction).ok());
  v1::StreamLodsRequest levels;
  levels.set_id(extraction.id());
  grpc::ClientContext reading;
  const auto stream = extractions->StreamLods(&reading, levels);
  v1::LodChunk last;
  while (stream->Read(&last)) {
  }
  EXPECT_EQ(last.manifest().grid().chosen(), "curvilinear");
  EXPECT_EQ(last.manifest().grid().lattice_step(), 4.0 / 64);
}

TEST_F(GridCalls, UploadsThatBreakOffLeaveNothing) {
  begin();
  const std::string bytes = node_bytes();
  for (int n = 0; n < 10; ++n) {
    grpc::ClientContext context;
    v1::AddGridResponse response;
    const auto writer = grids->UploadGrid(&context, &response);
    writer->Write(options());
    writer->Write(chunk(n % 2 == 0 ? bytes : bytes.substr(0, 1000)));  // whole, but not said to be so
    context.TryCancel();
    EXPECT_FALSE(writer->Finish().ok());
  }
  EXPECT_TRUE(test::comes_true([&] { return uploads.has_room(); }));
  EXPECT_EQ(stored(), 0u);
}

TEST_F(GridCalls, MessagesOutOfOrderAndOptionsThatMakeNoSenseAreRefused) {
  begin();
  v1::UploadGridRequest odd = options();
  odd.mutable_options()->set_kind("cells");
  v1::UploadGridRequest digest = options();
  digest.mutable_options()->set_sha256("short");
  v1::UploadGridRequest big = options();
  big.mutable_options()->set_bytes(std::uint64_t{1} << 60);
  for (const v1::UploadGridRequest& first : {chunk("bytes"), odd, digest, big}) {
    grpc::ClientContext context;
    v1::AddGridResponse response;
    const auto writer = grids->UploadGrid(&context, &response);
    writer->Write(first);
    writer->Write(chunk(node_bytes()));
    writer->WritesDone();
    const auto status = writer->Finish();
    EXPECT_EQ(status.error_code(),
              first.options().bytes() > 0 ? grpc::StatusCode::RESOURCE_EXHAUSTED : grpc::StatusCode::INVALID_ARGUMENT)
        << status.error_message();
  }
  EXPECT_EQ(stored(), 0u);
}

}  // namespace
}  // namespace geosis::server::rpc
