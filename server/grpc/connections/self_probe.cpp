#include "server/grpc/connections/self_probe.h"

#include <utility>

#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>

namespace geosis::server::rpc {
namespace {

constexpr std::chrono::seconds kPatience{5};
constexpr int kDeadAfter = 3;  // failures in a row

}  // namespace

SelfProbe::SelfProbe(std::string target, std::shared_ptr<grpc::ChannelCredentials> credentials,
                     std::chrono::milliseconds interval, std::function<bool()> may_be_full)
    : target_(std::move(target)),
      credentials_(std::move(credentials)),
      interval_(interval),
      may_be_full_(std::move(may_be_full)),
      thread_([this] { run(); }) {}

SelfProbe::~SelfProbe() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  stopped_.notify_all();
  thread_.join();
}

std::optional<std::string> SelfProbe::problem() const {
  const int failures = failures_;
  if (failures < kDeadAfter) return std::nullopt;
  return "the gRPC door has not answered its own " + std::to_string(failures) + " last questions for its health";
}

void SelfProbe::run() {
  std::unique_lock lock(mutex_);
  while (!stopped_.wait_for(lock, interval_, [this] { return is_stopping_; })) {
    lock.unlock();
    const bool is_well = ask();
    lock.lock();
    if (is_well)
      failures_ = 0;
    else if (!may_be_full_())
      ++failures_;
  }
}

/// Whether an answer comes, whatever it says: grpc.health.v1.Health/Check with an empty message asks for the whole
/// server.
bool SelfProbe::ask() const {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection of its own, each time
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  const auto channel = grpc::CreateCustomChannel(target_, credentials_, arguments);
  grpc::GenericStub stub(channel);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
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
  queue.Shutdown();
  while (queue.Next(&tag, &ok)) {
  }
  return ok && status.ok();
}

}  // namespace geosis::server::rpc
