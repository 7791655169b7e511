#include "server/grpc/held_calls.h"

#include <charconv>
#include <cstdlib>
#include <memory>
#include <string_view>

#include <grpc/grpc.h>
#include <grpc/support/alloc.h>
#include <netdb.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
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

/// Protobuf's JSON: whole numbers are strings, and zeros are left out.
std::uint64_t number_in(const Json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_string()) return 0;
  const std::string& text = found->get_ref<const std::string&>();
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// Counters are read one after the other while they move.
std::uint64_t difference(std::uint64_t begun, std::uint64_t over) {
  return begun > over ? begun - over : 0;
}

std::int64_t id_in(const Json& object, const char* name) {
  return static_cast<std::int64_t>(number_in(object, name));
}

template <class Visit>
void visit_servers(Visit visit) {
  for (std::int64_t first = 0;;) {
    const Json page = document(grpc_channelz_get_servers(first));
    const Json servers = page.value("server", Json::array());
    for (const Json& server : servers) {
      first = id_in(server.value("ref", Json::object()), "serverId") + 1;
      visit(server, first - 1);
    }
    if (servers.empty() || page.value("end", false)) return;
  }
}

std::uint64_t held_by_socket(std::int64_t id) {
  const Json socket = document(grpc_channelz_get_socket(id));
  const Json data = socket.value("socket", Json::object()).value("data", Json::object());
  return difference(number_in(data, "streamsStarted"),
                    number_in(data, "streamsSucceeded") + number_in(data, "streamsFailed"));
}

/// "chttp2 ipv4:127.0.0.1:43682"
std::string connection_in(const Json& reference) {
  const std::string name = reference.value("name", "");
  return name.substr(name.rfind(' ') + 1);
}

std::string escaped(std::string_view host) {
  std::string text;
  for (const char c : host) text += c == '%' ? std::string("%25") : std::string(1, c);  // before an interface's name
  return text;
}

}  // namespace

std::uint64_t held_calls() {
  std::uint64_t count = 0;
  visit_servers([&](const Json& server, std::int64_t) {
    const Json data = server.value("data", Json::object());
    count +=
        difference(number_in(data, "callsStarted"), number_in(data, "callsSucceeded") + number_in(data, "callsFailed"));
  });
  return count;
}

std::vector<HeldCalls> held_calls_by_connection() {
  std::vector<HeldCalls> all;
  visit_servers([&](const Json&, std::int64_t server) {
    for (std::int64_t first = 0;;) {
      const Json page = document(grpc_channelz_get_server_sockets(server, first, kSocketsAtOnce));
      const Json sockets = page.value("socketRef", Json::array());
      for (const Json& socket : sockets) {
        const std::int64_t id = id_in(socket, "socketId");
        all.push_back({connection_in(socket), held_by_socket(id)});
        first = id + 1;
      }
      if (sockets.empty() || page.value("end", false)) return;
    }
  });
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

}  // namespace geosis::server::rpc
