#include "server/http/connections/mailbox.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <sys/eventfd.h>

namespace geosis::server::http {

Result<std::shared_ptr<Mailbox>> Mailbox::open() {
  Descriptor event(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (!event.is_open()) return Error{ErrorCode::unavailable, std::string("eventfd: ") + std::strerror(errno)};
  return std::shared_ptr<Mailbox>(new Mailbox(std::move(event)));
}

void Mailbox::post(Letter letter) {
  bool is_first = false;
  {
    const std::lock_guard lock(mutex_);
    if (is_closed_) return;
    is_first = letters_.empty();
    letters_.push_back(std::move(letter));
  }
  if (is_first) wake();
}

void Mailbox::wake() {
  const std::uint64_t one = 1;
  // The only failure is a counter that is full: then the loop is awake anyway.
  [[maybe_unused]] const auto written = ::write(event_.number(), &one, sizeof one);
}

std::vector<Letter> Mailbox::take() {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto taken = ::read(event_.number(), &count, sizeof count);
  const std::lock_guard lock(mutex_);
  return std::exchange(letters_, {});
}

void Mailbox::close() {
  std::vector<Letter> unread;  // declared first, so destroyed after the lock: a stream's end runs code of others
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  unread.swap(letters_);
}

}  // namespace geosis::server::http
