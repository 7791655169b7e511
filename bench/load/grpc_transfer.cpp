// A bare gRPC server with our messages that does nothing, and a client that measures it or ours.
//
//     grpc_transfer bare                           prints its port; takes uploads, streams chunks of zeros, sends
//     chunks back grpc_transfer upload ADDRESS FILE I,J,K      uploads raw float32 samples in chunks of 256 KiB
//     grpc_transfer stream ADDRESS ID              reads all levels; of the bare server ID = number of bytes
//     grpc_transfer echo ADDRESS FILE              the file in chunks of 256 KiB to the bare server, and back again
//
// The client prints {"bytes": ..., "seconds": ..., "cpu_seconds": ...}.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include <geosis/v1/extraction.grpc.pb.h>
#include <geosis/v1/volume.grpc.pb.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <sys/resource.h>

namespace {

using namespace geosis;
using Clock = std::chrono::steady_clock;
constexpr std::size_t kChunk = 256 * 1024;

class Sink final : public grpc::ServerReadReactor<v1::UploadVolumeRequest> {
 public:
  Sink() { StartRead(&message_); }
  void OnReadDone(bool ok) override {
    if (ok)
      StartRead(&message_);
    else
      Finish(grpc::Status::OK);
  }
  void OnDone() override { delete this; }

 private:
  v1::UploadVolumeRequest message_;
};

class Spring final : public grpc::ServerWriteReactor<v1::LodChunk> {
 public:
  explicit Spring(std::size_t bytes) : left_(bytes) { write(); }
  void OnWriteDone(bool ok) override {
    if (ok)
      write();
    else
      Finish(grpc::Status::CANCELLED);
  }
  void OnDone() override { delete this; }

 private:
  void write() {
    if (left_ == 0) return Finish(grpc::Status::OK);
    const std::size_t count = std::min(left_, kChunk);
    message_.mutable_part()->mutable_data()->assign(count, '\0');
    left_ -= count;
    StartWrite(&message_);
  }

  v1::LodChunk message_;
  std::size_t left_;
};

/// Sends each chunk back before it takes the next one.
class Echo final : public grpc::ServerBidiReactor<v1::ExtractRequest, v1::LodChunk> {
 public:
  Echo() { StartRead(&message_); }
  void OnReadDone(bool ok) override {
    if (!ok) return Finish(grpc::Status::OK);
    answer_.mutable_part()->set_allocated_data(message_.release_chunk());
    StartWrite(&answer_);
  }
  void OnWriteDone(bool ok) override {
    if (ok)
      StartRead(&message_);
    else
      Finish(grpc::Status::CANCELLED);
  }
  void OnDone() override { delete this; }

 private:
  v1::ExtractRequest message_;
  v1::LodChunk answer_;
};

class BareVolumes final : public v1::VolumeService::CallbackService {
  grpc::ServerReadReactor<v1::UploadVolumeRequest>* UploadVolume(grpc::CallbackServerContext*,
                                                                 v1::UploadVolumeResponse*) override {
    return new Sink;
  }
};

class BareExtractions final : public v1::ExtractionService::CallbackService {
  grpc::ServerWriteReactor<v1::LodChunk>* StreamLods(grpc::CallbackServerContext*,
                                                     const v1::StreamLodsRequest* request) override {
    return new Spring(std::strtoull(request->id().c_str(), nullptr, 10));
  }
  grpc::ServerBidiReactor<v1::ExtractRequest, v1::LodChunk>* Extract(grpc::CallbackServerContext*) override {
    return new Echo;
  }
};

int serve() {
  BareVolumes volumes;
  BareExtractions extractions;
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&volumes);
  builder.RegisterService(&extractions);
  const auto server = builder.BuildAndStart();
  std::printf("127.0.0.1:%d\n", port);
  std::fflush(stdout);
  server->Wait();
  return 0;
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](timeval t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

struct Start {
  Clock::time_point time = Clock::now();
  double cpu = cpu_seconds();
};

int report(const grpc::Status& status, std::size_t bytes, const Start& start) {
  if (!status.ok()) {
    std::fprintf(stderr, "%d: %s\n", int{status.error_code()}, status.error_message().c_str());
    return 1;
  }
  std::printf("{\"bytes\": %zu, \"seconds\": %.6f, \"cpu_seconds\": %.6f}\n", bytes,
              std::chrono::duration<double>(Clock::now() - start.time).count(), cpu_seconds() - start.cpu);
  return 0;
}

std::string read_file(const char* path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::string bytes(static_cast<std::size_t>(file.tellg()), '\0');
  file.seekg(0).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

std::shared_ptr<grpc::Channel> connect(const std::string& address) {
  const auto channel = grpc::CreateChannel(address, grpc::InsecureChannelCredentials());
  channel->WaitForConnected(std::chrono::system_clock::now() + std::chrono::seconds(10));
  return channel;
}

int upload(const std::string& address, const char* path, const char* dims) {
  const std::string bytes = read_file(path);
  v1::UploadVolumeRequest message;
  auto& import = *message.mutable_options()->mutable_import();
  import.set_format("raw");
  int counts[3] = {};
  std::sscanf(dims, "%d,%d,%d", &counts[0], &counts[1], &counts[2]);
  import.mutable_dims()->set_inlines(counts[0]);
  import.mutable_dims()->set_crosslines(counts[1]);
  import.mutable_dims()->set_samples(counts[2]);
  const auto channel = connect(address);
  const Start start;
  const auto stub = v1::VolumeService::NewStub(channel);
  grpc::ClientContext context;
  v1::UploadVolumeResponse response;
  const auto writer = stub->UploadVolume(&context, &response);
  bool is_open = writer->Write(message);
  for (std::size_t at = 0; is_open && at < bytes.size(); at += kChunk) {
    message.set_chunk(bytes.data() + at, std::min(kChunk, bytes.size() - at));
    is_open = writer->Write(message);
  }
  writer->WritesDone();
  return report(writer->Finish(), bytes.size(), start);
}

int stream(const std::string& address, const char* id) {
  const auto channel = connect(address);
  const Start start;
  const auto stub = v1::ExtractionService::NewStub(channel);
  grpc::ClientContext context;
  v1::StreamLodsRequest request;
  request.set_id(id);
  const auto reader = stub->StreamLods(&context, request);
  std::size_t bytes = 0;
  for (v1::LodChunk chunk; reader->Read(&chunk);) bytes += chunk.part().data().size();
  return report(reader->Finish(), bytes, start);
}

int echo(const std::string& address, const char* path) {
  const std::string bytes = read_file(path);
  const auto channel = connect(address);
  const Start start;
  const auto stub = v1::ExtractionService::NewStub(channel);
  grpc::ClientContext context;
  const auto both = stub->Extract(&context);
  std::thread writer([&] {
    v1::ExtractRequest message;
    bool is_open = true;
    for (std::size_t at = 0; is_open && at < bytes.size(); at += kChunk) {
      message.set_chunk(bytes.data() + at, std::min(kChunk, bytes.size() - at));
      is_open = both->Write(message);
    }
    both->WritesDone();
  });
  std::size_t back = 0;
  for (v1::LodChunk chunk; both->Read(&chunk);) back += chunk.part().data().size();
  writer.join();
  return report(both->Finish(), back, start);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "bare") return serve();
  if (what == "upload" && argc == 5) return upload(argv[2], argv[3], argv[4]);
  if (what == "stream" && argc == 4) return stream(argv[2], argv[3]);
  if (what == "echo" && argc == 4) return echo(argv[2], argv[3]);
  std::fprintf(stderr,
               "usage: grpc_transfer bare | upload ADDRESS FILE I,J,K | stream ADDRESS ID | echo ADDRESS FILE\n");
  return 2;
}
