#include "tests/server/grpc/door_fixture.h"

#include <grpcpp/create_channel.h>

namespace geosis::server::rpc::test {

void DoorTest::start(DoorOptions options, ReconstructFunction reconstruct) {
  service = std::make_unique<Service>(*store, std::move(reconstruct));
  options.listen = "127.0.0.1:0";
  auto started = Door::start(
      options, {.services_of =
                    [this](const std::string&) {
                      return Services{*store, service->volumes, service->extractions, service->queue, memory};
                    },
                .gate = gate,
                .uploads = uploads});
  ASSERT_TRUE(started) << started.error().message;
  door = *std::move(started);
  const auto channel = new_channel();
  volumes = v1::VolumeService::NewStub(channel);
  extractions = v1::ExtractionService::NewStub(channel);
}

void DoorTest::TearDown() {
  if (service) service->queue.stop();
  door.reset();
}

std::shared_ptr<grpc::Channel> DoorTest::new_channel() const {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return grpc::CreateCustomChannel(address(), grpc::InsecureChannelCredentials(), arguments);
}

v1::ImportOptions DoorTest::ball_import() {
  v1::ImportOptions import;
  import.set_format("raw");
  for (const auto set : {&v1::Dims::set_inlines, &v1::Dims::set_crosslines, &v1::Dims::set_samples}) {
    (import.mutable_dims()->*set)(20);
  }
  return import;
}

v1::UploadVolumeRequest DoorTest::ball_upload() {
  v1::UploadVolumeRequest first;
  *first.mutable_options()->mutable_import() = ball_import();
  return first;
}

std::string DoorTest::ball_bytes(double radius) {
  const auto bytes = ball_file(radius);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string DoorTest::upload_ball() {
  grpc::ClientContext context;
  v1::UploadVolumeResponse response;
  const auto writer = volumes->UploadVolume(&context, &response);
  writer->Write(ball_upload());
  v1::UploadVolumeRequest chunk;
  chunk.set_chunk(ball_bytes());
  writer->Write(chunk);
  writer->WritesDone();
  const auto status = writer->Finish();
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response.volume().id();
}

v1::Request DoorTest::ball_range() {
  v1::Request request;
  request.mutable_range()->set_low(0);
  return request;
}

v1::Extraction DoorTest::create(const std::string& volume) {
  grpc::ClientContext context;
  v1::CreateExtractionRequest request;
  request.set_volume(volume);
  *request.mutable_request() = ball_range();
  v1::Extraction extraction;
  const auto status = extractions->CreateExtraction(&context, request, &extraction);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return extraction;
}

}  // namespace geosis::server::rpc::test
