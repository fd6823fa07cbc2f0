// SPDX-License-Identifier: Apache-2.0
// Who may send requests: only pages that this server delivered, in a browser that opened the URL with the token, or one with a
// ticket. Pages of other sites can reach a server of this machine, too; Host, Origin and a cookie for this site alone prevent
// that (docs/design/lab-protocol.md, "Access").
#ifndef QUINTET_LAB_ACCESS_H
#define QUINTET_LAB_ACCESS_H

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "lab/http_message.h"

namespace quintet::lab {

inline constexpr double kTicketSeconds = 60;  // for which a ticket is valid

// 32 random hexadecimal digits from the system. Throws Error if it has none.
std::string randomToken();

class Access {
 public:
  // `machine`: the host name of this machine; may be empty.
  Access(std::string token, std::uint16_t port, std::string machine);

  // A text for one request, which then gets the cookie. All users of this machine can read the arguments of the process that
  // starts a browser, so these contain no token. A new ticket replaces the one before. `now`: seconds on any clock.
  std::string issueTicket(double now);

  // Who sends a request, besides what it says.
  struct Caller {
    double now = 0;                   // on the clock of issueTicket()
    std::function<bool()> isOwnUser;  // whether a process of this user on this machine has sent it
  };
  // The answer to a request that must not be handled: an error, or the redirect of the URL with the token or a ticket, which
  // sets the cookie. Nothing if the request is allowed.
  std::optional<HttpResponse> check(const HttpRequest& request, const Caller& caller);

 private:
  HttpResponse login() const;
  bool isKnownHost(const std::string& host) const;
  bool hasToken(const HttpRequest& request) const;

  std::string token_, cookie_, machine_;
  std::string ticket_;  // empty: none is valid
  double ticketEnd_ = 0;
};

}  // namespace quintet::lab
#endif
