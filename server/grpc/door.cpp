#include "server/grpc/door.h"

#include <mutex>
#include <utility>

#include <google/protobuf/stubs/logging.h>
#include <grpc/support/log.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include "server/grpc/calls/call.h"
#include "server/grpc/connections/acceptor.h"
#include "server/grpc/connections/door_tls.h"
#include "server/grpc/connections/flood_reports.h"
#include "server/grpc/connections/hand_over.h"
#include "server/grpc/connections/self_probe.h"
#include "server/grpc/services/extraction_service.h"
#include "server/grpc/services/grid_service.h"
#include "server/grpc/services/volume_service.h"

namespace geosis::server::rpc {
namespace {

constexpr int kLargestMessage = 4 << 20;  // received: a chunk of a file
constexpr int kMinute = 60'000;
constexpr int kLargestMetadata = 16 * 1024;
constexpr std::size_t kMemory = std::size_t{256} << 20;  // beyond, gRPC reads more slowly
constexpr std::size_t kLanes = 8;                        // each costs 14 us of every hand-over
constexpr std::chrono::milliseconds kLanePatience{1000};
constexpr int kReflectionThreads = 8;  // its service is the one that holds a thread for each call
constexpr std::uint64_t kUploadRate = 16 * 1024;

/// A probe's way in: addresses that stand for all of a machine's are asked at loopback.
std::string probe_target(const std::string& listen, std::uint16_t port) {
  const std::string host = listen.substr(0, listen.rfind(':'));
  const std::string way = host == "0.0.0.0" ? "127.0.0.1" : host == "[::]" ? "[::1]" : host;
  return "dns:///" + way + ":" + std::to_string(port);
}

std::mutex say_mutex;
std::function<void(const std::string&)> say_line;  // one for the process, as gRPC's log is

void write_line(gpr_log_func_args* line) {
  const std::lock_guard lock(say_mutex);
  if (say_line) say_line(line->message);
}

void tell_to(std::function<void(const std::string&)> say) {
  const std::lock_guard lock(say_mutex);
  say_line = std::move(say);
  gpr_set_log_function(write_line);
}

/// What gRPC sets up once for a process.
void set_up_process() {
  static const bool is_done = [] {
    grpc::EnableDefaultHealthCheckService(true);
    google::protobuf::SetLogHandler(nullptr);  // a client's bytes are no news for stderr
    grpc::reflection::InitProtoReflectionServerBuilderPlugin();
    return true;
  }();
  static_cast<void>(is_done);
}

void set_limits(grpc::ServerBuilder& builder, const DoorOptions& options) {
  builder.SetMaxReceiveMessageSize(kLargestMessage);
  builder.SetMaxSendMessageSize(-1);  // a survey's text header or a list of a thousand volumes is as large as it is
  builder.SetResourceQuota(grpc::ResourceQuota("geosis").Resize(kMemory).SetMaxThreads(kReflectionThreads));
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, options.streams_per_connection);
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, kLargestMetadata);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, static_cast<int>(options.patience.count()));
  // A peer that is gone without a word is noticed; one that asks all the time is told to go.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kMinute);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kMinute / 3);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kMinute / 6);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, 10 * kMinute);
  // Connections go round behind a balancer; what runs on an old one has an hour, as long as a job may take.
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_MS, 60 * kMinute);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_GRACE_MS, 60 * kMinute);
}

/// A client may send a message that is three times too large and is told so.
FloodGuard flood_guard(const DoorOptions& options, std::size_t uploads) {
  const auto open = static_cast<std::uint64_t>(options.streams_per_connection);
  return FloodGuard({.open_calls = open,
                     .leftover_calls = {.of_one = 15 * open, .of_all = 32 * open},
                     .loose_bytes = {.of_one = 2 * kLargestMessage, .of_all = 12 * kLargestMessage},
                     .message_bytes = kLargestMessage,
                     .most_messages = uploads,
                     .head_bytes = 2 * kLargestMetadata,
                     .unlooked_bytes = 16 * 1024,
                     .patience = 100});
}

/// A way into a server that is not built yet. gRPC lets one socket in at a time by each.
HandOver::Lane add_lane(grpc::ServerBuilder& builder, const std::shared_ptr<grpc::ServerCredentials>& credentials) {
  using Connections = grpc::ServerBuilder::experimental_type::ExternalConnectionType;
  std::shared_ptr<grpc::experimental::ExternalConnectionAcceptor> taker =
      builder.experimental().AddExternalConnectionAcceptor(Connections::FROM_FD, credentials);
  return [taker](Descriptor socket) {
    grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
    connection.fd = socket.release();
    taker->HandleNewConnection(&connection);
  };
}

}  // namespace

class Door::Running {
 public:
  Running(const DoorOptions& options, const Parts& parts)
      : pool_(options.handler_threads, options.queued_calls),
        uploads_(parts.uploads),
        room_{.services_of = parts.services_of,
              .gate = parts.gate,
              .pool = pool_,
              .uploads = uploads_,
              .upload_bytes = options.upload_bytes,
              .upload_bytes_per_second = kUploadRate,
              .patience = options.patience,
              .reader_patience = options.reader_patience},
        volumes_(room_),
        extractions_(room_),
        grids_(room_),
        floods_(
            [&gate = parts.gate](std::size_t count, const std::string& last) { gate.ended_for_flooding(count, last); },
            parts.give_back) {
    set_up_process();
    tell_to(parts.say);
  }
  ~Running() { stop(); }

  Result<void> start(const DoorOptions& options) {
    auto secured = door_credentials(options.certificates);
    if (!secured) return std::move(secured).error();
    auto listener = Listener::open(options.listen);
    if (!listener) return std::move(listener).error();
    grpc::ServerBuilder builder;
    set_limits(builder, options);
    builder.RegisterService(&volumes_);
    builder.RegisterService(&extractions_);
    builder.RegisterService(&grids_);
    std::vector<HandOver::Lane> lanes;
    for (std::size_t n = 0; n < kLanes; ++n) lanes.push_back(add_lane(builder, secured->server));
    server_ = builder.BuildAndStart();
    if (!server_) return Error{ErrorCode::internal, "gRPC did not start"};
    set_serving(true);
    certificates_ = std::move(secured->files);
    hand_over_ = std::make_unique<HandOver>(std::move(lanes), kLanePatience);
    acceptor_ = std::make_unique<Acceptor>(
        *std::move(listener), Acceptor::Limits{options.connections, options.connections_per_peer},
        Acceptor::Hand{
            [this] { return hand_over_->has_room(); },
            [this](Descriptor socket, const std::string& name) { hand_over_->hand(std::move(socket), name); }},
        [this, guard = flood_guard(options, uploads_.most())](const auto& open) mutable {
          auto verdict = guard.look(open, calls());
          if (auto stuck = hand_over_->stuck()) verdict.harmful.push_back(*std::move(stuck));
          floods_.note(verdict.harmful, FloodReports::Clock::now());
          return verdict;
        },
        [this] {
          room_.open.end_late_ones();
          floods_.tick(FloodReports::Clock::now());
          if (certificates_) certificates_->renew();
        });
    probe_ = std::make_unique<SelfProbe>(probe_target(options.listen, acceptor_->port()), secured->own_client,
                                         options.probe_interval, [this] { return acceptor_->may_be_full(); });
    return {};
  }

  std::uint16_t port() const { return acceptor_->port(); }
  std::size_t connections() const { return acceptor_->connections(); }
  std::size_t calls() const { return room_.open.count(); }
  std::optional<std::string> not_alive() const { return is_draining_ ? std::nullopt : probe_->problem(); }

  void set_serving(bool is_serving) {
    grpc::HealthCheckServiceInterface* const health = server_->GetHealthCheckService();
    health->SetServingStatus(is_serving);
    for (const char* service : {"geosis.v1.VolumeService", "geosis.v1.ExtractionService", "geosis.v1.GridService"}) {
      health->SetServingStatus(service, is_serving);
    }
  }

  void drain(std::chrono::milliseconds grace) {
    if (is_draining_.exchange(true)) return;
    const auto end = std::chrono::system_clock::now() + grace;
    set_serving(false);
    if (acceptor_) acceptor_->stop();
    if (hand_over_) hand_over_->stop();
    server_->Shutdown(end);
  }

  void stop() {
    probe_.reset();
    if (server_) drain(std::chrono::milliseconds(0));
    uploads_.join_all();
    pool_.stop();
  }

 private:
  HandlerPool pool_;
  UploadThreads uploads_;
  CallRoom room_;
  VolumeServiceDoor volumes_;
  ExtractionServiceDoor extractions_;
  GridServiceDoor grids_;
  std::unique_ptr<MirroredCertificates> certificates_;
  std::unique_ptr<grpc::Server> server_;
  std::atomic<bool> is_draining_{false};
  FloodReports floods_;  // of the acceptor's thread
  std::unique_ptr<HandOver> hand_over_;
  std::unique_ptr<Acceptor> acceptor_;
  std::unique_ptr<SelfProbe> probe_;
};

Result<std::unique_ptr<Door>> Door::start(const DoorOptions& options, const Parts& parts) {
  auto running = std::make_unique<Running>(options, parts);
  if (auto started = running->start(options); !started) return std::move(started).error();
  return std::unique_ptr<Door>(new Door(std::move(running)));
}

Door::Door(std::unique_ptr<Running> running) : running_(std::move(running)) {}
Door::~Door() = default;

std::uint16_t Door::port() const {
  return running_->port();
}
std::size_t Door::connections() const {
  return running_->connections();
}
std::size_t Door::calls() const {
  return running_->calls();
}
std::optional<std::string> Door::not_alive() const {
  return running_->not_alive();
}
void Door::set_not_serving() {
  running_->set_serving(false);
}
void Door::drain(std::chrono::milliseconds grace) {
  running_->drain(grace);
}
void Door::stop() {
  running_->stop();
}

}  // namespace geosis::server::rpc
