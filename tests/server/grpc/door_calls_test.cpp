#include <atomic>
#include <string>
#include <thread>

#include "tests/server/grpc/door_fixture.h"

// What a client's leaving, his deadline and his silence do.

namespace geosis::server::rpc {
namespace {

using namespace std::chrono_literals;

/// Stops at a gate after the coarsest level, and tells what its progress said when it went on.
struct Watched {
  test::Gate gate;
  std::atomic<bool> was_cancelled{false};

  ReconstructFunction function() {
    return [this](const ReconstructInput& input, const ReconstructOptions& options, Progress& progress,
                  StageTimings* timings, const LevelSink& sink) {
      auto done = test::gated_after(4, gate)(input, options, progress, timings, sink);
      was_cancelled = progress.cancelled();
      return done;
    };
  }
};

class DoorCalls : public test::DoorTest {
 protected:
  /// Sends the ball and reads the first chunk of the answer.
  using Extracting = grpc::ClientReaderWriter<v1::ExtractRequest, v1::LodChunk>;
  std::unique_ptr<Extracting> extract_first(grpc::ClientContext& context) {
    auto stream = extractions->Extract(&context);
    v1::ExtractRequest message;
    *message.mutable_options()->mutable_import() = ball_import();
    *message.mutable_options()->mutable_request() = ball_range();
    stream->Write(message);
    message.set_chunk(ball_bytes());
    stream->Write(message);
    stream->WritesDone();
    v1::LodChunk chunk;
    EXPECT_TRUE(stream->Read(&chunk));
    EXPECT_EQ(chunk.part().level(), 4);
    return stream;
  }
};

TEST_F(DoorCalls, CancelOfAOneShotReachesTheEngine) {
  Watched watched;
  start({}, watched.function());
  grpc::ClientContext context;
  const auto stream = extract_first(context);
  const auto begun = std::chrono::steady_clock::now();
  context.TryCancel();
  EXPECT_TRUE(test::comes_true([&] { return watched.was_cancelled.load(); }));
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 1s);
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(test::comes_true([&] { return gate.all().size() == 1; }));
  EXPECT_FALSE(gate.all()[0].is_complete);
}

TEST_F(DoorCalls, DeadlineOfAOneShotReachesTheEngine) {
  Watched watched;
  start({}, watched.function());
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + 700ms);
  const auto stream = extract_first(context);
  v1::LodChunk chunk;
  while (stream->Read(&chunk)) {
  }
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_TRUE(test::comes_true([&] { return watched.was_cancelled.load(); }));
}

TEST_F(DoorCalls, ARecordedExtractionOutlivesItsReaders) {
  Watched watched;
  start({}, watched.function());
  const std::string id = create(upload_ball()).id();
  grpc::ClientContext context;
  v1::StreamLodsRequest request;
  request.set_id(id);
  const auto stream = extractions->StreamLods(&context, request);
  v1::LodChunk chunk;
  ASSERT_TRUE(stream->Read(&chunk));  // the coarsest level, before the finer ones are made
  context.TryCancel();
  stream->Finish();
  watched.gate.open();
  grpc::ClientContext again;
  const auto whole = extractions->StreamLods(&again, request);
  int levels = 0;
  while (whole->Read(&chunk)) levels += chunk.part().is_last();
  EXPECT_TRUE(whole->Finish().ok());
  EXPECT_EQ(levels, 5);
  EXPECT_FALSE(watched.was_cancelled);
}

TEST_F(DoorCalls, LevelsFromOneOnLeaveTheCoarserOnesOut) {
  start();
  v1::StreamLodsRequest request;
  request.set_id(create(upload_ball()).id());
  request.set_from_level(1);
  grpc::ClientContext context;
  const auto stream = extractions->StreamLods(&context, request);
  std::string levels;
  for (v1::LodChunk chunk; stream->Read(&chunk);) {
    levels += chunk.has_manifest() ? "m" : std::to_string(chunk.part().level());
  }
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_EQ(levels, "10m");
}

TEST_F(DoorCalls, UploadsThatBreakOffLeaveNothing) {
  start();
  for (int n = 0; n < 20; ++n) {
    grpc::ClientContext context;
    v1::UploadVolumeResponse response;
    const auto writer = volumes->UploadVolume(&context, &response);
    writer->Write(ball_upload());
    v1::UploadVolumeRequest chunk;
    const std::string bytes = ball_bytes();
    chunk.set_chunk(n % 2 == 0 ? bytes : bytes.substr(0, 1000));  // whole, but not said to be so
    writer->Write(chunk);
    context.TryCancel();
    EXPECT_FALSE(writer->Finish().ok());
  }
  EXPECT_TRUE(test::comes_true([&] { return gate.all().size() == 20; }));
  EXPECT_TRUE(service->volumes.list(10, "")->at("volumes").empty());
  EXPECT_TRUE(test::comes_true([&] { return uploads.has_room(); }));
}

TEST_F(DoorCalls, SilentAndSlowUploadsAreEnded) {
  start({.patience = 300ms});
  for (const bool sends_some : {false, true}) {
    grpc::ClientContext context;
    v1::UploadVolumeResponse response;
    const auto writer = volumes->UploadVolume(&context, &response);
    writer->Write(ball_upload());
    v1::UploadVolumeRequest chunk;
    chunk.set_chunk("some");
    if (sends_some) writer->Write(chunk);
    const auto status = writer->Finish();  // without WritesDone: the server ends it
    const auto expected = sends_some ? grpc::StatusCode::DEADLINE_EXCEEDED : grpc::StatusCode::CANCELLED;
    EXPECT_EQ(status.error_code(), expected) << status.error_message();
  }
}

TEST_F(DoorCalls, OnePeersUploadsLeaveTheLastQuarterOfThreads) {
  start();
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  std::vector<std::unique_ptr<v1::UploadVolumeResponse>> responses;
  std::vector<std::unique_ptr<grpc::ClientWriter<v1::UploadVolumeRequest>>> writers;
  v1::UploadVolumeRequest chunk;
  chunk.set_chunk("some");
  for (int n = 0; n < 5; ++n) {
    contexts.push_back(std::make_unique<grpc::ClientContext>());
    responses.push_back(std::make_unique<v1::UploadVolumeResponse>());
    writers.push_back(volumes->UploadVolume(contexts.back().get(), responses.back().get()));
    writers.back()->Write(ball_upload());
    writers.back()->Write(chunk);
  }
  // Three of the five have a thread, whichever came first; the others were refused.
  EXPECT_TRUE(test::comes_true([&] { return gate.all().size() == 2; }));
  EXPECT_TRUE(uploads.has_room());
  for (const auto& call : gate.all()) EXPECT_EQ(call.status, static_cast<int>(grpc::StatusCode::UNAVAILABLE));
  for (const auto& context : contexts) context->TryCancel();
  for (const auto& writer : writers) EXPECT_FALSE(writer->Finish().ok());
}

TEST_F(DoorCalls, MessagesOutOfOrderAreRefused) {
  start();
  v1::UploadVolumeRequest chunk;
  chunk.set_chunk("some");
  for (const auto& messages : {std::vector{chunk},
                               std::vector{v1::UploadVolumeRequest()},
                               {},
                               std::vector{ball_upload(), ball_upload()},
                               std::vector{ball_upload(), chunk, ball_upload()}}) {
    grpc::ClientContext context;
    v1::UploadVolumeResponse response;
    const auto writer = volumes->UploadVolume(&context, &response);
    for (const auto& message : messages) writer->Write(message);
    writer->WritesDone();
    EXPECT_EQ(writer->Finish().error_code(), grpc::StatusCode::INVALID_ARGUMENT) << messages.size();
  }
}

TEST_F(DoorCalls, AMessageThatIsTooLargeEndsItsCall) {
  start();
  grpc::ClientContext context;
  v1::UploadVolumeResponse response;
  const auto writer = volumes->UploadVolume(&context, &response);
  writer->Write(ball_upload());
  v1::UploadVolumeRequest chunk;
  chunk.set_chunk(std::string(5 << 20, 'x'));
  writer->Write(chunk);
  writer->WritesDone();
  EXPECT_EQ(writer->Finish().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  upload_ball();
}

}  // namespace
}  // namespace geosis::server::rpc
