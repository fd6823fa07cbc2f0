// SPDX-License-Identifier: Apache-2.0
#include "lab/peer.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <sstream>

#include <fmt/format.h>

namespace quintet::lab {

namespace ip = boost::asio::ip;

// The kernel writes addresses as words of 32 bits in the order of this machine.
std::string procNetAddress(const ip::tcp::endpoint& end) {
  std::string text;
  const auto append = [&](std::span<const unsigned char> bytes) {
    for (std::size_t i = 0; i < bytes.size(); i += sizeof(std::uint32_t)) {
      std::uint32_t word = 0;
      std::memcpy(&word, &bytes[i], sizeof word);
      text += fmt::format("{:08X}", word);
    }
  };
  if (end.address().is_v4())
    append(end.address().to_v4().to_bytes());
  else
    append(end.address().to_v6().to_bytes());
  return fmt::format("{}:{:04X}", text, end.port());
}

// "  0: 0100007F:1F90 0100007F:C350 01 00000000:00000000 00:00000000 00000000  1000 …": the eighth field is the user.
std::optional<uid_t> userInProcNet(std::string_view table, std::string_view own, std::string_view other) {
  std::istringstream lines{std::string(table)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::string slot, local, remote, state, queues, timer, retries;
    uid_t user = 0;
    if (fields >> slot >> local >> remote >> state >> queues >> timer >> retries >> user && local == own &&
        remote == other)
      return user;
  }
  return {};
}

std::optional<uid_t> userOfSocket(const ip::tcp::endpoint& own, const ip::tcp::endpoint& other) {
  // A server that listens to :: sees clients of IPv4 as such addresses.
  const auto unmapped = [](const ip::tcp::endpoint& end) {
    return end.address().is_v6() && end.address().to_v6().is_v4_mapped()
               ? ip::tcp::endpoint(ip::make_address_v4(ip::v4_mapped, end.address().to_v6()), end.port())
               : end;
  };
  const ip::tcp::endpoint local = unmapped(own), remote = unmapped(other);
  std::ifstream file(local.address().is_v4() ? "/proc/net/tcp" : "/proc/net/tcp6");
  const std::string table{std::istreambuf_iterator<char>(file), {}};
  return userInProcNet(table, procNetAddress(local), procNetAddress(remote));
}

}  // namespace quintet::lab
