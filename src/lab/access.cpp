// SPDX-License-Identifier: Apache-2.0
#include "lab/access.h"

#include <arpa/inet.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "lab/request_target.h"

namespace quintet::lab {
namespace {

// Takes the same time for all texts of this length.
bool areEqual(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

// "localhost:80" → "localhost", "[::1]:80" → "::1"; empty for anything else.
std::string nameOf(const std::string& host) {
  std::size_t end = host.find(':');
  std::string name;
  if (host.starts_with('[')) {
    const std::size_t bracket = host.find(']');
    if (bracket == host.npos) return {};
    name = host.substr(1, bracket - 1);
    end = bracket + 1 == host.size() ? host.npos : bracket + 1;
    if (end != host.npos && host[end] != ':') return {};
  } else {
    name = host.substr(0, end);
  }
  if (end != host.npos) {
    const std::string port = host.substr(end + 1);
    if (port.empty() || port.size() > 5 || port.find_first_not_of("0123456789") != port.npos) return {};
  }
  return lowerCase(name);
}

bool isAddress(const std::string& name) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return ::inet_pton(AF_INET, name.c_str(), bytes.data()) == 1 ||
         ::inet_pton(AF_INET6, name.c_str(), bytes.data()) == 1;
}

std::string cookieValue(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    std::string_view item = header.substr(0, header.find(';'));
    header.remove_prefix(std::min(header.size(), item.size() + 1));
    item.remove_prefix(std::min(item.size(), item.find_first_not_of(' ')));
    const std::size_t equals = item.find('=');
    if (equals != item.npos && item.substr(0, equals) == name) return std::string(item.substr(equals + 1));
  }
  return {};
}

}  // namespace

std::string randomToken() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error("the system has no random numbers for the token of the URL");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

Access::Access(std::string token, std::uint16_t port, std::string machine)
    : token_(std::move(token)), cookie_(fmt::format("quintet_lab_{}", port)), machine_(lowerCase(machine)) {}

// A foreign name that resolves to this machine (DNS rebinding) would make a page of that name a page of this
// server. Addresses cannot be rebound.
bool Access::isKnownHost(const std::string& host) const {
  const std::string name = nameOf(host);
  return name == "localhost" || isAddress(name) || (!machine_.empty() && name == machine_);
}

bool Access::hasToken(const HttpRequest& request) const {
  constexpr std::string_view kBearer = "Bearer ";
  const std::string& authorization = request.header("authorization");
  if (authorization.starts_with(kBearer) && areEqual(std::string_view(authorization).substr(kBearer.size()), token_))
    return true;
  return areEqual(cookieValue(request.header("cookie"), cookie_), token_);
}

std::string Access::issueTicket(double now) {
  ticket_ = randomToken();
  ticketEnd_ = now + kTicketSeconds;
  return ticket_;
}

HttpResponse Access::login() const {
  return {.status = 303,
          .type = "text/plain; charset=utf-8",
          .body = "",
          .headers = {{"Location", "/"},
                      {"Set-Cookie", fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/", cookie_, token_)}}};
}

std::optional<HttpResponse> Access::check(const HttpRequest& request, const Caller& caller) {
  const std::string& host = request.header("host");
  if (!isKnownHost(host))
    return errorResponse(421,
                         "unknown host name; open the URL that 'quintet lab' printed, or use the machine's address");
  const std::optional<RequestTarget> target = parseTarget(request.target);
  if (!target) return errorResponse(400, "the URL is not valid");
  const std::string& origin = request.header("origin");
  if (!origin.empty() && origin != "http://" + host)
    return errorResponse(403, "requests of other sites are not allowed");
  const std::string& site = request.header("sec-fetch-site");
  const bool opensPage = request.method == "GET" && target->path == "/";
  if (!opensPage && !site.empty() && site != "same-origin" && site != "none")
    return errorResponse(403, "requests of other sites are not allowed");
  const auto token = target->query.find("token");
  if (opensPage && token != target->query.end() && areEqual(token->second, token_)) return login();
  const auto ticket = target->query.find("ticket");
  if (opensPage && ticket != target->query.end() && !hasToken(request)) {
    if (ticket_.empty() || caller.now > ticketEnd_ || !areEqual(ticket->second, ticket_) || !caller.isOwnUser())
      return errorResponse(403, "this URL was valid once and for a minute; open the URL that 'quintet lab' printed");
    ticket_.clear();
    return login();
  }
  if (!hasToken(request))
    return errorResponse(403, "the token of the URL is missing or wrong; open the URL that 'quintet lab' printed");
  return {};
}

}  // namespace quintet::lab
