// SPDX-License-Identifier: Apache-2.0
// The session of a page: forwards messages between its WebSocket and its worker process, and starts and ends the worker
// as the supervisor decides (session_supervisor.h). It lives until the WebSocket is closed and the worker has ended.
#ifndef QUINTET_LAB_PAGE_SESSION_H
#define QUINTET_LAB_PAGE_SESSION_H

#include <array>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "base/stopwatch.h"
#include "lab/frame_channel.h"
#include "lab/session_supervisor.h"
#include "lab/worker_control.h"
#include "lab/worker_process.h"

namespace quintet::lab {

class PageSession : public std::enable_shared_from_this<PageSession> {
 public:
  struct Options {
    std::filesystem::path worker;  // executable
    WorkerSettings settings;
    const ProjectFolder* project = nullptr;  // of `settings`; it can get more files
    double idleSeconds = 600;
    std::string memoryHint;       // ServerOptions::memoryHint
    bool accepted = true;         // false: too many sessions are open
    std::function<void()> onEnd;  // called once, after the WebSocket is closed and the worker has ended
  };
  using Request = boost::beast::http::request<boost::beast::http::string_body>;

  PageSession(boost::beast::tcp_stream stream, Options options);
  ~PageSession();

  void start(const Request& upgrade);
  // Closes the WebSocket ("going away") and ends the worker.
  void stop();

 private:
  // A running worker and what waits to be sent to it.
  struct Worker {
    Worker(const boost::asio::any_io_executor& executor, const WorkerProcess& process);
    pid_t process;
    boost::asio::local::stream_protocol::socket socket;
    FrameParser parser;
    std::array<char, 65536> buffer{};
    std::deque<std::string> waiting;
    std::size_t waitingBytes = 0;
    std::optional<std::string> hung;
    std::size_t files = 0;  // that the project had when the worker started
    bool replaced = false;  // its end is of no interest
  };
  struct Message {
    bool binary = false;
    std::string data;
  };

  void readPage();
  void handlePage(const std::string& message);
  void toPage(Message message);
  void writePage();
  void close(boost::beast::websocket::close_code code, std::string_view reason = {});
  void pageClosed();

  void perform(const SessionSupervisor::Actions& actions);
  void startWorker();
  void endWorker(bool replaced);
  void readWorker(const std::shared_ptr<Worker>& worker);
  void handleWorker(Worker& worker, const ChannelFrame& frame);
  void toWorker(FrameKind kind, const std::string& data);
  void writeWorker(const std::shared_ptr<Worker>& worker);
  void waitForEnd(const std::shared_ptr<Worker>& worker);
  void checkMemory();
  void tick();

  const Options options_;
  const Stopwatch clock_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> page_;
  boost::beast::flat_buffer received_;
  std::deque<Message> waiting_;  // the first one is being written
  std::size_t waitingBytes_ = 0;
  bool closing_ = false;  // a close frame follows the waiting messages
  bool closed_ = false;
  boost::beast::websocket::close_reason reason_;
  boost::asio::steady_timer timer_;
  SessionSupervisor supervisor_;
  std::string loadTime_;            // message of the last Control::loads
  std::shared_ptr<Worker> worker_;  // null if none runs
};

}  // namespace quintet::lab
#endif
