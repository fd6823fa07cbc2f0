// SPDX-License-Identifier: Apache-2.0
#include "lab/access.h"

#include <optional>
#include <string>

#include <gmock/gmock.h>

namespace quintet::lab {
namespace {

class AccessTest : public ::testing::Test {
 protected:
  std::optional<HttpResponse> check(const HttpRequest& request, double now = 0, bool isOwnUser = true) {
    return access_.check(request, {now, [isOwnUser] { return isOwnUser; }});
  }
  unsigned status(const HttpRequest& request, double now = 0, bool isOwnUser = true) {
    const auto denied = check(request, now, isOwnUser);
    return denied ? denied->status : 200;
  }
  static HttpRequest get(const std::string& target, std::map<std::string, std::string> headers = {}) {
    headers.emplace("host", "localhost:8420");
    return {.method = "GET", .target = target, .headers = std::move(headers)};
  }
  Access access_{"secret", 8420, "Workshop"};
};

TEST_F(AccessTest, RedirectsTheUrlWithTheTokenAndSetsACookie) {
  const auto answer = check(get("/?token=secret"));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 303u);
  EXPECT_THAT(answer->headers, ::testing::Contains(::testing::Pair(
                                   "Set-Cookie", "quintet_lab_8420=secret; HttpOnly; SameSite=Strict; Path=/")));
  EXPECT_THAT(answer->headers, ::testing::Contains(::testing::Pair("Location", "/")));
}

TEST_F(AccessTest, ATicketIsValidOnce) {
  EXPECT_EQ(status(get("/?ticket=")), 403u);
  const std::string ticket = access_.issueTicket(0);
  EXPECT_EQ(ticket.find("secret"), ticket.npos);
  EXPECT_EQ(status(get("/?ticket=" + ticket + "0")), 403u);
  EXPECT_EQ(status(get("/api/files?ticket=" + ticket)), 403u);
  EXPECT_EQ(status(get("/?ticket=" + ticket), 0, false),
            403u);  // of a different user, who has read it in a list of processes
  const auto answer = check(get("/?ticket=" + ticket), kTicketSeconds);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 303u);
  EXPECT_THAT(answer->headers, ::testing::Contains(::testing::Pair(
                                   "Set-Cookie", "quintet_lab_8420=secret; HttpOnly; SameSite=Strict; Path=/")));
  EXPECT_EQ(status(get("/?ticket=" + ticket)), 403u);
  EXPECT_EQ(status(get("/?ticket=" + ticket, {{"cookie", "quintet_lab_8420=secret"}})), 200u);  // a reload
}

TEST_F(AccessTest, ATicketExpiresAndIsReplaced) {
  const std::string first = access_.issueTicket(10);
  EXPECT_EQ(status(get("/?ticket=" + first), 10 + kTicketSeconds + 1), 403u);
  const std::string second = access_.issueTicket(20);
  EXPECT_NE(first, second);
  EXPECT_EQ(status(get("/?ticket=" + first), 20), 403u);
  EXPECT_EQ(status(get("/?ticket=" + second), 20), 303u);
}

TEST_F(AccessTest, AcceptsTheCookieAndTheHeader) {
  EXPECT_EQ(status(get("/api/files", {{"cookie", "quintet_lab_8420=secret"}})), 200u);
  EXPECT_EQ(status(get("/api/files", {{"cookie", "a=b; quintet_lab_8420=secret; c=d"}})), 200u);
  EXPECT_EQ(status(get("/api/files", {{"authorization", "Bearer secret"}})), 200u);
}

TEST_F(AccessTest, RejectsMissingAndWrongTokens) {
  EXPECT_EQ(status(get("/")), 403u);
  EXPECT_EQ(status(get("/?token=")), 403u);
  EXPECT_EQ(status(get("/?token=secre")), 403u);
  EXPECT_EQ(status(get("/?token=secret1")), 403u);
  EXPECT_EQ(status(get("/lab.js")), 403u);
  EXPECT_EQ(status(get("/api/files?token=secret")), 403u);  // only the page has it in its URL
  EXPECT_EQ(status(get("/api/files", {{"cookie", "quintet_lab_8421=secret"}})), 403u);
  EXPECT_EQ(status(get("/api/files", {{"cookie", "xquintet_lab_8420=secret"}})), 403u);
  EXPECT_EQ(status(get("/api/files", {{"authorization", "Basic secret"}})), 403u);
}

TEST_F(AccessTest, RejectsNamesOfOtherMachines) {
  const auto withHost = [](const std::string& host) {
    return get("/api/files", {{"host", host}, {"authorization", "Bearer secret"}});
  };
  for (const char* host :
       {"localhost", "LOCALHOST:1", "127.0.0.1:8420", "[::1]:8420", "192.168.0.7:80", "workshop:8420"})
    EXPECT_EQ(status(withHost(host)), 200u) << host;
  for (const char* host : {"", "evil.example", "localhost.evil.example:8420", "127.0.0.1.evil.example", "[::1",
                           "[::1]x", "localhost:", "localhost:99999999", "localhost:80@evil.example"})
    EXPECT_EQ(status(withHost(host)), 421u) << host;
}

TEST_F(AccessTest, RejectsRequestsOfOtherSites) {
  const auto with = [](const std::string& name, const std::string& value) {
    return get("/ws", {{name, value}, {"authorization", "Bearer secret"}});
  };
  EXPECT_EQ(status(with("origin", "http://localhost:8420")), 200u);
  for (const char* origin : {"http://localhost:8421", "https://localhost:8420", "http://evil.example", "null",
                             "http://localhost:8420.evil.example"})
    EXPECT_EQ(status(with("origin", origin)), 403u) << origin;
  EXPECT_EQ(status(with("sec-fetch-site", "same-origin")), 200u);
  EXPECT_EQ(status(with("sec-fetch-site", "none")), 200u);
  EXPECT_EQ(status(with("sec-fetch-site", "cross-site")), 403u);
  EXPECT_EQ(status(with("sec-fetch-site", "same-site")), 403u);
}

TEST(RandomToken, HasManyDigitsAndDiffers) {
  const std::string token = randomToken();
  EXPECT_EQ(token.size(), 32u);
  EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), token.npos);
  EXPECT_NE(token, randomToken());
}

}  // namespace
}  // namespace quintet::lab
