#include "server/grpc/connections/connection_counts.h"

#include <algorithm>
#include <charconv>
#include <memory>
#include <string_view>
#include <utility>

#include <grpc/grpc.h>
#include <grpc/support/alloc.h>
#include <linux/tcp.h>  // knows more of tcp_info than the C library's
#include <netdb.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/ioctl.h>
#include <sys/socket.h>

namespace geosis::server::rpc {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kSocketsAtOnce = 256;

/// The document of a text of gRPC's; null where it has none.
Json document(char* text) {
  const std::unique_ptr<char, decltype(&gpr_free)> owner(text, &gpr_free);
  return text ? Json::parse(text, nullptr, false) : Json();
}

/// A member, or null: what a text is about may be gone by the time it is written.
const Json& in(const Json& object, const char* name) {
  static const Json nothing;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return found == object.end() ? nothing : *found;
}

std::uint64_t number_of(const std::string& text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// Protobuf's JSON: whole numbers are strings, and zeros are left out.
std::uint64_t number_in(const Json& object, const char* name) {
  const Json& text = in(object, name);
  return text.is_string() ? number_of(text.get_ref<const std::string&>()) : 0;
}

/// Counters are read one after the other while they move.
std::uint64_t difference(std::uint64_t begun, std::uint64_t over) {
  return begun > over ? begun - over : 0;
}

std::int64_t id_in(const Json& object, const char* name) {
  return static_cast<std::int64_t>(number_in(object, name));
}

/// Ids of all servers of this process.
std::vector<std::int64_t> servers() {
  std::vector<std::int64_t> ids;
  for (std::int64_t first = 0;;) {
    const Json page = document(grpc_channelz_get_servers(first));
    const Json& found = in(page, "server");
    for (const Json& server : found) {
      ids.push_back(id_in(in(server, "ref"), "serverId"));
      first = ids.back() + 1;
    }
    if (found.empty() || in(page, "end") == true) return ids;
  }
}

ConnectionCounts counts_of(std::string connection, std::int64_t socket) {
  const Json whole = document(grpc_channelz_get_socket(socket));
  const Json& data = in(in(whole, "socket"), "data");
  const std::uint64_t begun = number_in(data, "streamsStarted");
  const std::uint64_t over = number_in(data, "streamsSucceeded") + number_in(data, "streamsFailed");
  return {.connection = std::move(connection),
          .held = difference(begun, over),
          .begun = begun,
          .messages = number_in(data, "messagesReceived") + number_in(data, "messagesSent")};
}

/// "chttp2 ipv4:127.0.0.1:43682"
std::string connection_in(const Json& reference) {
  const Json& name = in(reference, "name");
  if (!name.is_string()) return {};
  const std::string& text = name.get_ref<const std::string&>();
  return text.substr(text.rfind(' ') + 1);
}

std::string escaped(std::string_view host) {
  std::string text;
  for (const char c : host) text += c == '%' ? std::string("%25") : std::string(1, c);  // before an interface's name
  return text;
}

}  // namespace

std::vector<ConnectionCounts> count_connections(const std::function<bool(const std::string& name)>& is_wanted) {
  std::vector<ConnectionCounts> all;
  for (const std::int64_t server : servers()) {
    for (std::int64_t first = 0;;) {
      const Json page = document(grpc_channelz_get_server_sockets(server, first, kSocketsAtOnce));
      const Json& sockets = in(page, "socketRef");
      for (const Json& socket : sockets) {
        const std::int64_t id = id_in(socket, "socketId");
        first = id + 1;
        std::string name = connection_in(socket);
        if (is_wanted(name)) all.push_back(counts_of(std::move(name), id));
      }
      if (sockets.empty() || in(page, "end") == true) break;
    }
  }
  return all;
}

std::string connection_name(int socket) {
  constexpr std::string_view kMapped = "::ffff:";
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  char host[NI_MAXHOST] = "", port[NI_MAXSERV] = "";
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&address), &length) != 0 ||
      ::getnameinfo(reinterpret_cast<const sockaddr*>(&address), length, host, sizeof host, port, sizeof port,
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return {};
  }
  const std::string_view name = host;
  if (address.ss_family == AF_INET) return std::string("ipv4:").append(name).append(":").append(port);
  if (IN6_IS_ADDR_V4MAPPED(&reinterpret_cast<const sockaddr_in6&>(address).sin6_addr)) {
    return std::string("ipv4:").append(name.substr(kMapped.size())).append(":").append(port);
  }
  return "ipv6:%5B" + escaped(name) + "%5D:" + port;
}

std::uint64_t bytes_read(int socket) {
  tcp_info info{};
  socklen_t length = sizeof info;
  int unread = 0;
  if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &length) != 0 || ::ioctl(socket, FIONREAD, &unread) != 0)
    return 0;
  return difference(info.tcpi_bytes_received, static_cast<std::uint64_t>(std::max(unread, 0)));
}

}  // namespace geosis::server::rpc
