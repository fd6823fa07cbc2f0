// SPDX-License-Identifier: Apache-2.0
// A page without a browser: HTTP requests and a WebSocket as the protocol describes them
// (docs/design/lab-protocol.md), and the server as a process.
#ifndef QUINTET_TESTS_LAB_PAGE_CLIENT_H
#define QUINTET_TESTS_LAB_PAGE_CLIENT_H

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lab/image_message.h"

namespace quintet::test {

using Json = nlohmann::json;
using Headers = std::map<std::string, std::string>;

struct Reply {
  unsigned status = 0;  // 0: the server closed the connection without an answer
  Headers headers;      // names in lower case
  std::string body;
  Json json() const { return Json::parse(body, nullptr, false); }
};

// The server `quintet-lab` on a folder.
class LabProcess {
 public:
  // `opensBrowser`: without --no-open.
  explicit LabProcess(const std::filesystem::path& target, const std::vector<std::string>& options = {},
                      bool opensBrowser = false);
  ~LabProcess();  // ends it
  LabProcess(const LabProcess&) = delete;
  LabProcess& operator=(const LabProcess&) = delete;

  std::uint16_t port() const { return port_; }
  const std::string& token() const { return token_; }
  pid_t process() const { return process_; }
  std::vector<pid_t> workers() const;  // child processes, also those that have ended and were not waited for
  std::size_t memory() const;          // resident, bytes
  int stop();                          // SIGTERM; returns the exit status, 1000 + signal if a signal ended it

  // With the token, unless `headers` has other credentials ("cookie" or "authorization").
  Reply request(const std::string& method, const std::string& target, const std::string& body = {},
                Headers headers = {}) const;

 private:
  pid_t process_ = -1;
  std::uint16_t port_ = 0;
  std::string token_;
};

struct ReceivedImage {
  lab::ImageHeader header;
  std::string file;
};

// A WebSocket. All functions throw std::runtime_error if nothing arrives within `seconds`, and UsageError for an event that
// differs from its description (lab::labSchema()).
class PageClient {
 public:
  explicit PageClient(const LabProcess& server, const Headers& headers = {});
  ~PageClient();

  bool isOpen() const;  // false: the server has rejected the handshake
  void send(const Json& message);
  void sendText(const std::string& text);
  // The next event for which the function returns true. Images are confirmed on the way.
  Json waitFor(const std::function<bool(const Json&)>& matches, double seconds = 30);
  Json waitFor(const std::string& event, double seconds = 30);
  Json waitForWorker(const std::string& state, double seconds = 30);
  // The next image for which the function returns true; the next one without a function.
  ReceivedImage waitForImage(const std::function<bool(const lab::ImageHeader&)>& matches = {}, double seconds = 30);
  // The content of the file that an event `file` describes, read part by part.
  std::string readFile(const Json& file);
  // The close code of the server.
  unsigned waitForClose(double seconds = 10);
  std::string closeReason() const;  // of the server, after waitForClose()
  void close();

  const std::vector<Json>& events() const { return events_; }  // all so far

 private:
  struct Connection;
  // Returns false at the end of the stream.
  bool receive(double seconds);

  std::unique_ptr<Connection> connection_;
  std::vector<Json> events_;
  std::optional<ReceivedImage> image_;  // of the last receive()
  std::optional<std::string> part_;     // of a file, of the last receive()
  std::optional<Json> event_;           // of the last receive()
};

}  // namespace quintet::test
#endif
