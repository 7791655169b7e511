// Preloaded into the server: accept4() fails in every way that the manual names, again and again, before it works.

#include <atomic>
#include <cerrno>
#include <iterator>

#include <dlfcn.h>
#include <sys/socket.h>

extern "C" int accept4(int listener, sockaddr* address, socklen_t* length, int flags) {
  static constexpr int kFailures[] = {ECONNABORTED, EMFILE,       ENFILE,     ENOBUFS,  ENOMEM,
                                      EPROTO,       EPERM,        EINTR,      ENETDOWN, ENOPROTOOPT,
                                      EHOSTDOWN,    EHOSTUNREACH, EOPNOTSUPP, ETIMEDOUT};
  static std::atomic<unsigned> calls = 0;
  const unsigned call = calls++;
  if (call % 2 == 0) {
    errno = kFailures[call / 2 % std::size(kFailures)];
    return -1;
  }
  using Accept = int (*)(int, sockaddr*, socklen_t*, int);
  static const auto next = reinterpret_cast<Accept>(dlsym(RTLD_NEXT, "accept4"));
  return next(listener, address, length, flags);
}
