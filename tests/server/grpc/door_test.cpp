#include "server/grpc/door.h"

#include <fstream>
#include <string>
#include <thread>

#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>

#include "server/net/pem.h"
#include "tests/server/grpc/door_fixture.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server::rpc {
namespace {

using namespace std::chrono_literals;

class DoorTest : public test::DoorTest {
 protected:
  /// What grpc.health.v1 says of the server: 1 = SERVING, 2 = NOT_SERVING; -1 = no answer.
  static int health(const std::shared_ptr<grpc::Channel>& channel) {
    grpc::GenericStub stub(channel);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + 5s);
    const grpc::Slice nothing("");
    const grpc::ByteBuffer request(&nothing, 1);
    grpc::ByteBuffer response;
    grpc::CompletionQueue queue;
    const auto call = stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check", request, &queue);
    call->StartCall();
    grpc::Status status;
    call->Finish(&response, &status, nullptr);
    void* tag = nullptr;
    bool ok = false;
    queue.Next(&tag, &ok);
    grpc::Slice bytes;
    if (!status.ok() || !response.DumpToSingleSlice(&bytes).ok() || bytes.size() != 2) return -1;
    return bytes.begin()[1];  // field 1, a varint
  }

  grpc::Status get(const std::string& id, grpc::ClientContext& context) const {
    v1::GetVolumeRequest request;
    request.set_id(id);
    v1::Volume volume;
    return volumes->GetVolume(&context, request, &volume);
  }
};

TEST_F(DoorTest, RefusesAddressesThatAreTakenOrNone) {
  start();
  const Door::Parts parts{.services_of = {}, .gate = gate, .uploads = uploads};
  EXPECT_EQ(Door::start({.listen = address()}, parts).error().code, ErrorCode::unavailable);
  EXPECT_EQ(Door::start({.listen = "127.0.0.1"}, parts).error().code, ErrorCode::invalid_argument);
}

TEST_F(DoorTest, TellsTheGateOfEachCall) {
  start();
  // The gate is told a moment after the client.
  const auto have_been_told = [&](std::size_t calls) {
    return test::comes_true([&] { return gate.all().size() == calls && door->calls() == 0; });
  };
  const std::string volume = upload_ball();
  ASSERT_TRUE(have_been_told(1));
  grpc::ClientContext known, unknown, refused;
  known.AddMetadata("x-request-id", "mine-7");
  EXPECT_TRUE(get(volume, known).ok());
  EXPECT_EQ(known.GetServerInitialMetadata().find("x-request-id")->second, "mine-7");
  ASSERT_TRUE(have_been_told(2));
  EXPECT_EQ(get("nobody", unknown).error_code(), grpc::StatusCode::NOT_FOUND);
  ASSERT_TRUE(have_been_told(3));
  refused.AddMetadata("authorization", "nobody");
  EXPECT_EQ(get(volume, refused).error_code(), grpc::StatusCode::UNAUTHENTICATED);
  ASSERT_TRUE(have_been_told(4));
  const auto calls = gate.all();
  EXPECT_EQ(calls[0].method, "geosis.v1.VolumeService/UploadVolume");
  EXPECT_GT(calls[0].bytes_in, ball_bytes().size());
  EXPECT_EQ(calls[1].request_id, "mine-7");
  EXPECT_GT(calls[1].bytes_out, 100u);
  EXPECT_EQ(calls[1].status + calls[2].status * 100 + calls[3].status * 10'000, 0 + 500 + 160'000);
  EXPECT_EQ(door->connections(), 1u);
}

TEST_F(DoorTest, TooManyCallsForItsHandlersAreUnavailable) {
  start({.queued_calls = 0});
  grpc::ClientContext context;
  const auto status = get("any", context);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_FALSE(status.error_details().empty());
}

TEST_F(DoorTest, DrainsWhatRunsAndTakesNothingNew) {
  start({}, test::gated_after(4, gate_of_work));
  v1::StreamLodsRequest request;
  request.set_id(create(upload_ball()).id());
  grpc::ClientContext context;
  const auto stream = extractions->StreamLods(&context, request);
  v1::LodChunk chunk;
  ASSERT_TRUE(stream->Read(&chunk));
  EXPECT_EQ(health(new_channel()), 1);
  std::thread draining([&] { door->drain(20s); });
  EXPECT_TRUE(test::comes_true([&] { return health(new_channel()) == -1; }));
  gate_of_work.open();
  int levels = 1;
  while (stream->Read(&chunk)) levels += chunk.part().is_last();
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_EQ(levels, 5);
  draining.join();
  EXPECT_FALSE(door->not_alive());
}

TEST_F(DoorTest, WhatRunsLongerThanTheGraceIsCancelled) {
  start({}, test::gated_after(4, gate_of_work));
  v1::StreamLodsRequest request;
  request.set_id(create(upload_ball()).id());
  grpc::ClientContext context;
  const auto stream = extractions->StreamLods(&context, request);
  v1::LodChunk chunk;
  ASSERT_TRUE(stream->Read(&chunk));
  door->drain(50ms);
  EXPECT_FALSE(stream->Finish().ok());
}

TEST_F(DoorTest, StaysAliveByItsOwnProbe) {
  start({.probe_interval = 20ms});
  std::this_thread::sleep_for(300ms);
  EXPECT_FALSE(door->not_alive());
}

TEST_F(DoorTest, AsksItselfThoughItAsksOthersForCertificates) {
  const geosis::test::TemporaryFolder folder;
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder.path() / name) << text;
    return (folder.path() / name).string();
  };
  const SignedKey own = *make_signed_key("door"), authority = *make_signed_key("authority");
  const auto certificates =
      *TlsCertificates::read({.certificate = write("door.pem", own.certificate),
                              .key = write("door.key", own.key),
                              .client_authorities = write("authority.pem", authority.certificate)},
                             [](const std::optional<Error>&) {});
  start({.certificates = certificates.get(), .probe_interval = 20ms});
  std::this_thread::sleep_for(300ms);
  EXPECT_FALSE(door->not_alive());

  const auto ask = [&](const SignedKey& identity) {
    const grpc::SslCredentialsOptions options{own.certificate, identity.key, identity.certificate};
    return health(grpc::CreateChannel(address(), grpc::SslCredentials(options)));
  };
  EXPECT_EQ(ask(authority), 1);
  EXPECT_EQ(ask(own), -1);
  EXPECT_EQ(health(new_channel()), -1);
  door->stop();  // it looks at the certificates
}

TEST_F(DoorTest, ConnectionsThatAreTooManyAreRefused) {
  start({.connections = 2, .connections_per_peer = 2, .probe_interval = 1h});
  const auto first = new_channel(), second = new_channel(), third = new_channel();
  EXPECT_EQ(health(first), 1);
  EXPECT_EQ(health(second), 1);
  EXPECT_EQ(health(third), -1);
  EXPECT_EQ(health(first), 1);
}

}  // namespace
}  // namespace geosis::server::rpc
