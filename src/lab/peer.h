// SPDX-License-Identifier: Apache-2.0
// Which user of this machine has opened a TCP connection to it.
#ifndef QUINTET_LAB_PEER_H
#define QUINTET_LAB_PEER_H

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/ip/tcp.hpp>

namespace quintet::lab {

// The user of the socket whose own end is `own` and whose other end is `other`; nothing if no process of this machine has
// such a socket.
std::optional<uid_t> userOfSocket(const boost::asio::ip::tcp::endpoint& own,
                                  const boost::asio::ip::tcp::endpoint& other);

// "0100007F:1F90": an end of a connection as the files tcp and tcp6 of /proc/net write it.
std::string procNetAddress(const boost::asio::ip::tcp::endpoint& end);
// As userOfSocket(), in the text of such a file.
std::optional<uid_t> userInProcNet(std::string_view table, std::string_view own, std::string_view other);

}  // namespace quintet::lab
#endif
