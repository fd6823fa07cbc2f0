// SPDX-License-Identifier: Apache-2.0
#include "lab/peer.h"

#include <unistd.h>

#include <gmock/gmock.h>
#include <boost/asio/io_context.hpp>

namespace quintet::lab {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

TEST(Peer, ReadsTheTableOfTheKernel) {
  constexpr const char* kTable =
      "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode\n"
      "   0: 0100007F:1F90 00000000:0000 0A 00000000:00000000 00:00000000 00000000     7        0 1 1 0\n"
      "   1: 0100007F:C350 0100007F:1F90 01 00000000:00000000 00:00000000 00000000  1000        0 2 1 0\n";
  EXPECT_EQ(userInProcNet(kTable, "0100007F:C350", "0100007F:1F90"), 1000u);
  EXPECT_FALSE(userInProcNet(kTable, "0100007F:1F90", "0100007F:C350"));
  EXPECT_EQ(procNetAddress({asio::ip::make_address("127.0.0.1"), 8080}), "0100007F:1F90");
  EXPECT_EQ(procNetAddress({asio::ip::make_address("::1"), 8080}), "00000000000000000000000001000000:1F90");
}

TEST(Peer, FindsTheUserOfAConnection) {
  asio::io_context context;
  for (const char* address : {"127.0.0.1", "::"}) {  // the second one accepts IPv4, too
    boost::system::error_code error;
    tcp::acceptor acceptor(context);
    const tcp::endpoint any(asio::ip::make_address(address), 0);
    acceptor.open(any.protocol(), error);
    if (error) continue;  // no IPv6
    acceptor.bind(any);
    acceptor.listen();
    tcp::socket client(context), server(context);
    client.connect({asio::ip::make_address("127.0.0.1"), acceptor.local_endpoint().port()});
    acceptor.accept(server);
    EXPECT_EQ(userOfSocket(server.remote_endpoint(), server.local_endpoint()), ::getuid()) << address;
    EXPECT_FALSE(userOfSocket({asio::ip::make_address("127.0.0.1"), 1}, server.local_endpoint()));
  }
}

}  // namespace
}  // namespace quintet::lab
