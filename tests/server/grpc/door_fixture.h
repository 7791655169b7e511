#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <geosis/v1/extraction.grpc.pb.h>
#include <geosis/v1/volume.grpc.pb.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <gtest/gtest.h>

#include "server/grpc/door.h"
#include "server/store/memory_store.h"
#include "tests/server/app/service_fixture.h"

namespace geosis::server::rpc::test {

using namespace server::test;

/// Lets everybody in and remembers what he is told.
class OpenGate final : public CallGate {
 public:
  Result<std::string> admit(const CallHead& head) override {
    if (head.authorization == "nobody") return Error{ErrorCode::unauthenticated, "nobody knows nobody"};
    return std::string("default");
  }
  void answered(const AnsweredCall& answered) override {
    const std::lock_guard lock(mutex_);
    all_.push_back(answered);
  }
  int retry_after_seconds() const override { return 9; }
  std::vector<AnsweredCall> all() const {
    const std::lock_guard lock(mutex_);
    return all_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<AnsweredCall> all_;
};

/// A door on a free port over a store in memory, and a client's stubs.
class DoorTest : public testing::Test {
 protected:
  /// reconstruct   what extractions compute with.
  void start(DoorOptions options = {}, ReconstructFunction reconstruct = geosis::reconstruct);
  void TearDown() override;

  /// A chunk of an upload; the options of a ball's first.
  static v1::UploadVolumeRequest ball_upload();
  static v1::ImportOptions ball_import();
  static std::string ball_bytes(double radius = 7);
  /// Uploads a ball over the wire; its id.
  std::string upload_ball();
  static v1::Request ball_range();
  v1::Extraction create(const std::string& volume);

  std::string address() const { return "127.0.0.1:" + std::to_string(door->port()); }
  std::shared_ptr<grpc::Channel> new_channel() const;

  std::unique_ptr<BlobStore> store = std::move(*open_memory_store());
  std::unique_ptr<Service> service;
  MemoryBudget memory{std::uint64_t{1} << 30};
  OpenGate gate;
  Gate gate_of_work;  ///< for gated_after(): outlives what waits at it
  Slots uploads{4};
  std::unique_ptr<Door> door;
  std::unique_ptr<v1::VolumeService::Stub> volumes;
  std::unique_ptr<v1::ExtractionService::Stub> extractions;
};

}  // namespace geosis::server::rpc::test
