#include "tests/server/app/service_fixture.h"

#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>

#include <gtest/gtest.h>

namespace geosis::server::test {

std::vector<std::byte> ball_file(double radius) {
  std::vector<float> samples;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      for (int k = 0; k < 20; ++k) {
        samples.push_back(static_cast<float>(
            radius - std::sqrt((i - 9.6) * (i - 9.6) + (j - 9.4) * (j - 9.4) + (k - 9.7) * (k - 9.7))));
      }
    }
  }
  std::vector<std::byte> bytes(samples.size() * sizeof(float));
  std::memcpy(bytes.data(), samples.data(), bytes.size());
  return bytes;
}

UploadOptions ball_options() {
  UploadOptions options;
  options.import.format = FileFormat::raw;
  options.import.dims = GridShape{20, 20, 20};
  options.name = "ball";
  return options;
}

Json ball_request() {
  return {{"range", {0, nullptr}}};
}

std::string Service::add_ball(double radius) {
  const auto bytes = ball_file(radius);
  NoProgress progress;
  std::vector<GridCandidate> candidates;
  const auto added = volumes.add(*memory_source(bytes), ball_options(), progress, candidates);
  EXPECT_TRUE(added) << added.error().message;
  return added ? added->document.at("id").get<std::string>() : "";
}

std::string read_all(ByteStream& stream) {
  std::mutex mutex;
  std::condition_variable rung;
  bool is_ready = true;
  stream.on_ready([&] {
    const std::lock_guard lock(mutex);
    is_ready = true;
    rung.notify_one();
  });
  std::string text;
  std::byte piece[1000];
  for (;;) {
    const auto pulled = stream.pull(piece);
    if (!pulled) return text + "{" + name_of(pulled.error().code) + "}";
    if (pulled->state == ByteStream::Pulled::State::end) break;
    text.append(reinterpret_cast<const char*>(piece), pulled->count);
    if (pulled->state != ByteStream::Pulled::State::wait) continue;
    std::unique_lock lock(mutex);
    if (!rung.wait_for(lock, std::chrono::seconds(30), [&] { return is_ready; })) return text + "{no bell}";
    is_ready = false;
  }
  stream.on_ready({});
  return text;
}

}  // namespace geosis::server::test
