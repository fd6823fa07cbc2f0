// SPDX-License-Identifier: Apache-2.0
// Who may send requests: only pages that this server delivered, in a browser that opened the URL with the token. Pages
// of other sites can reach a server of this machine, too; Host, Origin and a cookie for this site alone prevent that
// (docs/design/lab-protocol.md, "Access").
#ifndef QUINTET_LAB_ACCESS_H
#define QUINTET_LAB_ACCESS_H

#include <cstdint>
#include <optional>
#include <string>

#include "lab/http_message.h"

namespace quintet::lab {

// 32 random hexadecimal digits from the system. Throws Error if it has none.
std::string randomToken();

class Access {
 public:
  // `machine`: the host name of this machine; may be empty.
  Access(std::string token, std::uint16_t port, std::string machine);

  // The answer to a request that must not be handled: an error, or the redirect of the URL with the token, which sets the
  // cookie. Nothing if the request is allowed.
  std::optional<HttpResponse> check(const HttpRequest& request) const;

 private:
  bool isKnownHost(const std::string& host) const;
  bool hasToken(const HttpRequest& request) const;

  std::string token_, cookie_, machine_;
};

}  // namespace quintet::lab
#endif
