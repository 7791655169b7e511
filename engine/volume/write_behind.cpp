#include "engine/volume/write_behind.h"

namespace geosis {

WriteBehind::WriteBehind(const MappedFile& file)
    : file_(file), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void WriteBehind::add(std::uint64_t offset, std::uint64_t bytes) {
  const std::scoped_lock lock(mutex_);
  parts_.push_back({offset, bytes});
  added_.notify_one();
}

void WriteBehind::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (added_.wait(lock, stop, [this] { return !parts_.empty(); }) && !stop.stop_requested()) {
    const Part part = parts_.front();
    parts_.pop_front();
    lock.unlock();
    file_.start_writing(part.offset, part.bytes);
    lock.lock();
  }
}

}  // namespace geosis
