// SPDX-License-Identifier: Apache-2.0
// A request and an answer of HTTP as plain data, so that everything but the sockets is independent of the web server's
// library and tested without a network.
#ifndef QUINTET_LAB_HTTP_MESSAGE_H
#define QUINTET_LAB_HTTP_MESSAGE_H

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace quintet::lab {

struct HttpRequest {
  std::string method;                          // "GET"
  std::string target;                          // "/api/files/a%20b?x=1", as it was sent
  std::map<std::string, std::string> headers;  // names in lower case; of repeated ones the last
  std::string body;

  // Empty if the header is missing.
  const std::string& header(const std::string& name) const {
    static const std::string kMissing;
    const auto found = headers.find(name);
    return found == headers.end() ? kMissing : found->second;
  }
};

struct HttpResponse {
  unsigned status = 200;
  std::string type = "application/json";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers = {};  // besides Content-Type and Content-Length
};

// The answer {"error": message} with further members, which are JSON texts: {"hash", "\"0f3c\""}.
HttpResponse errorResponse(unsigned status, const std::string& message,
                           const std::vector<std::pair<std::string, std::string>>& members = {});

}  // namespace quintet::lab
#endif
