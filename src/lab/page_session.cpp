// SPDX-License-Identifier: Apache-2.0
#include "lab/page_session.h"

#include <array>
#include <chrono>
#include <csignal>
#include <optional>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

#include "base/error.h"
#include "lab/page_message.h"
#include "lab/private_folder.h"
#include "lab/session_events.h"

namespace quintet::lab {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;

constexpr std::chrono::milliseconds kTick{250}, kEndPoll{5};
constexpr std::size_t kMaxWaitingBytes = std::size_t{64} << 20;  // of messages that a page does not read
constexpr std::size_t kMaxWorkerBytes = std::size_t{8} << 20;    // of messages that a worker does not read

}  // namespace

PageSession::Worker::Worker(const asio::any_io_executor& executor, const WorkerProcess& started)
    : process(started.process), socket(executor, asio::local::stream_protocol(), started.socket) {}

PageSession::PageSession(beast::tcp_stream stream, Options options)
    : options_(std::move(options)),
      page_(std::move(stream)),
      timer_(page_.get_executor()),
      supervisor_({.timeout = options_.settings.defaults.timeout, .idleSeconds = options_.idleSeconds}) {}

PageSession::~PageSession() {
  if (worker_) ::kill(worker_->process, SIGKILL);
  if (options_.onEnd) options_.onEnd();
}

void PageSession::start(const Request& upgrade) {
  page_.next_layer().expires_never();  // the WebSocket has timeouts of its own
  page_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
  page_.read_message_max(kMaxPageMessage);
  page_.auto_fragment(false);
  page_.async_accept(upgrade, [self = shared_from_this()](const error_code& error) {
    if (error) return;
    if (!self->options_.accepted) {
      self->readPage();
      self->close(websocket::close_code::try_again_later);
      return;
    }
    self->perform(self->supervisor_.connected(self->clock_.seconds()));
    self->readPage();
    self->tick();
  });
}

void PageSession::stop() { close(websocket::close_code::going_away); }

// ---- The page

void PageSession::readPage() {
  page_.async_read(received_, [self = shared_from_this()](const error_code& error, std::size_t /*size*/) {
    if (error) return self->pageClosed();
    const std::string message = beast::buffers_to_string(self->received_.data());
    const bool binary = self->page_.got_binary();
    self->received_.consume(self->received_.size());
    if (self->closing_) return self->readPage();  // until the close frame of the page arrives
    if (binary || !commandName(message))
      self->close(websocket::close_code::policy_error);
    else
      self->handlePage(message);
    self->readPage();
  });
}

void PageSession::handlePage(const std::string& message) {
  // A worker can read only the files that the project had when it started.
  if (worker_ && worker_->files != options_.project->files().size())
    perform(supervisor_.pageSent(clock_.seconds(), R"({"do":"restart"})"));
  perform(supervisor_.pageSent(clock_.seconds(), message));
}

void PageSession::toPage(Message message) {
  if (closing_ || closed_) return;
  waitingBytes_ += message.data.size();
  waiting_.push_back(std::move(message));
  if (waitingBytes_ > kMaxWaitingBytes)
    return close(websocket::close_code::policy_error, "the page does not read its messages");
  if (waiting_.size() == 1) writePage();
}

void PageSession::writePage() {
  page_.binary(waiting_.front().binary);
  page_.async_write(
      asio::buffer(waiting_.front().data), [self = shared_from_this()](const error_code& error, std::size_t /*size*/) {
        if (error) return self->pageClosed();
        self->waitingBytes_ -= self->waiting_.front().data.size();
        self->waiting_.pop_front();
        if (!self->waiting_.empty())
          self->writePage();
        else if (self->closing_)
          self->page_.async_close(self->reason_, [self](const error_code& /*error*/) { self->pageClosed(); });
      });
}

void PageSession::close(websocket::close_code code, std::string_view reason) {
  if (closing_ || closed_) return;
  closing_ = true;
  reason_ = websocket::close_reason(code, beast::string_view(reason.data(), reason.size()));
  endWorker(true);
  if (waiting_.empty())
    return page_.async_close(reason_, [self = shared_from_this()](const error_code& /*error*/) { self->pageClosed(); });
  waiting_.resize(1);  // the message that is being written
}

void PageSession::pageClosed() {
  if (std::exchange(closed_, true)) return;
  timer_.cancel();
  endWorker(true);
  beast::get_lowest_layer(page_).close();
}

// ---- The worker

void PageSession::perform(const SessionSupervisor::Actions& actions) {
  if (actions.end) endWorker(actions.start);
  for (const std::string& message : actions.toPage) toPage({false, message});
  if (actions.start) startWorker();
  if (actions.hold) toWorker(FrameKind::control, controlJson({Control::hold, loadTime_}));
  for (const std::string& message : actions.toWorker) toWorker(FrameKind::text, message);
}

void PageSession::startWorker() {
  try {
    worker_ = std::make_shared<Worker>(page_.get_executor(),
                                       startWorkerProcess(options_.worker, options_.settings.contained));
  } catch (const std::exception& error) {
    perform(supervisor_.workerMissing(error.what()));
    return;
  }
  WorkerSettings settings = options_.settings;
  settings.files.assign(options_.project->files().begin(), options_.project->files().end());
  worker_->files = settings.files.size();
  settings.process = worker_->process;
  toWorker(FrameKind::control, settingsJson(settings));
  readWorker(worker_);
}

void PageSession::endWorker(bool replaced) {
  if (!worker_) return;
  worker_->replaced = worker_->replaced || replaced;
  ::kill(worker_->process, SIGKILL);  // it owns nothing that it would have to finish
  if (replaced) worker_.reset();      // waitForEnd() keeps it
}

void PageSession::readWorker(const std::shared_ptr<Worker>& worker) {
  worker->socket.async_read_some(asio::buffer(worker->buffer),
                                 [self = shared_from_this(), worker](const error_code& error, std::size_t size) {
                                   if (error) return self->waitForEnd(worker);
                                   try {
                                     worker->parser.add({worker->buffer.data(), size});
                                     while (const std::optional<ChannelFrame> frame = worker->parser.next())
                                       self->handleWorker(*worker, *frame);
                                   } catch (const Error&) {  // it is broken
                                     ::kill(worker->process, SIGKILL);
                                     return self->waitForEnd(worker);
                                   }
                                   self->readWorker(worker);
                                 });
}

void PageSession::handleWorker(Worker& worker, const ChannelFrame& frame) {
  if (worker.replaced) return;
  const double now = clock_.seconds();
  if (frame.kind == FrameKind::control) {
    const ControlMessage message = parseControl(frame.data);
    if (message.control == Control::hung) worker.hung = message.message;
    if (message.control == Control::loads) loadTime_ = message.message;
    supervisor_.workerAlive(now);
    return;
  }
  if (frame.kind == FrameKind::text) supervisor_.workerSent(now, frame.data);
  toPage({frame.kind == FrameKind::binary, frame.data});
}

void PageSession::toWorker(FrameKind kind, const std::string& data) {
  if (!worker_) return;
  worker_->waiting.push_back(frameBytes(kind, data));
  worker_->waitingBytes += worker_->waiting.back().size();
  if (worker_->waitingBytes > kMaxWorkerBytes)
    return close(websocket::close_code::policy_error, "the page sends more messages than its worker can read");
  if (worker_->waiting.size() == 1) writeWorker(worker_);
}

void PageSession::writeWorker(const std::shared_ptr<Worker>& worker) {
  asio::async_write(worker->socket, asio::buffer(worker->waiting.front()),
                    [self = shared_from_this(), worker](const error_code& error, std::size_t /*size*/) {
                      if (error) return;  // the reader notices the end, too
                      worker->waitingBytes -= worker->waiting.front().size();
                      worker->waiting.pop_front();
                      if (!worker->waiting.empty()) self->writeWorker(worker);
                    });
}

// The socket is closed a moment before the process has ended.
void PageSession::waitForEnd(const std::shared_ptr<Worker>& worker) {
  std::optional<WorkerEnd> end = takeWorkerEnd(worker->process);
  if (!end) {
    auto timer = std::make_shared<asio::steady_timer>(page_.get_executor(), kEndPoll);
    timer->async_wait(
        [self = shared_from_this(), worker, timer](const error_code& /*error*/) { self->waitForEnd(worker); });
    return;
  }
  removePrivateFolders(worker->process);
  if (worker_ == worker) worker_.reset();
  if (worker->replaced || closed_) return;
  end->hung = worker->hung;
  perform(supervisor_.workerEnded(clock_.seconds(), *end));
}

// Beside the limit of the kernel, which is that of allocated memory, and less exact.
void PageSession::checkMemory() {
  const std::uint64_t limit = options_.settings.memory;
  if (worker_ && limit > 0 && workerMemory(worker_->process) > limit)
    perform(supervisor_.workerExceeded(limit, options_.memoryHint));
}

void PageSession::tick() {
  timer_.expires_after(kTick);
  timer_.async_wait([self = shared_from_this()](const error_code& error) {
    if (error || self->closed_) return;
    self->perform(self->supervisor_.tick(self->clock_.seconds()));
    self->checkMemory();
    self->tick();
  });
}

}  // namespace quintet::lab
