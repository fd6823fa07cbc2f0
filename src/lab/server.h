// SPDX-License-Identifier: Apache-2.0
// The server of the lab: accepts connections, checks who may send requests (access.h), answers them (api.h, page.h), and
// gives each WebSocket a session with a worker of its own (page_session.h). It has one thread, and never waits for a device
// or for a client.
#ifndef QUINTET_LAB_SERVER_H
#define QUINTET_LAB_SERVER_H

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "base/embedded.h"
#include "lab/api.h"
#include "lab/project_folder.h"

namespace quintet::lab {

struct ServerOptions {
  std::string address = "127.0.0.1";  // IP address to which it listens
  std::uint16_t port = 0;             // 0 means any free one
  std::string device;                 // of the workers: job::EngineOptions::device
  double idleSeconds = 600;           // after which an unused worker ends
  std::string token;                  // empty means a random one
  bool contained = true;              // workers are in a sandbox (sandbox.h)
  std::uint64_t memory = 0;           // bytes that a worker can use; 0: no limit
  std::string memoryHint;             // the end of the message about this limit, which names what raises it
  std::filesystem::path worker;       // executable that runs workers (worker_process.h)
  std::span<const EmbeddedFile> page;
  LabDefaults defaults;
};

class Server {
 public:
  // Listens. Throws UsageError for an invalid address, Error if the port is not available.
  Server(const ProjectFolder& project, ServerOptions options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;
  std::string url() const;  // with the token
  // For the arguments of a process that starts a browser: with a ticket (access.h), which replaces the one before. Before run().
  std::string urlForBrowser();
  // Who can reach the server, and what they need; empty if only this machine can.
  std::string exposure() const;

  // Works until SIGINT, SIGTERM, or stop() from another thread. All sessions and their workers have then ended.
  void run();
  void stop();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace quintet::lab
#endif
