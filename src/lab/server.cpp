// SPDX-License-Identifier: Apache-2.0
#include "lab/server.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <list>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "base/error.h"
#include "base/stopwatch.h"
#include "lab/access.h"
#include "lab/page.h"
#include "lab/page_session.h"
#include "lab/peer.h"
#include "lab/request_target.h"

namespace quintet::lab {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::uint32_t kMaxHeader = 16 * 1024;        // bytes
constexpr std::chrono::seconds kFirstHeaderTime{5};    // for the first header of a connection
constexpr std::chrono::seconds kRequestTime{30};       // for a request, and between two
constexpr std::chrono::milliseconds kAnswerPoll{5};    // between looks at a process that makes an answer
constexpr std::chrono::seconds kStopTime{2};           // for the goodbye to the pages
constexpr std::chrono::milliseconds kAcceptPause{50};  // after an error, such as too many open files
// Without those of sessions. A browser opens at most six to one address.
constexpr std::size_t kMaxConnections = 256, kMaxConnectionsPerAddress = 64;

std::string machineName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

template <class Fields>
HttpRequest toRequest(const http::header<true, Fields>& header) {
  HttpRequest request;
  request.method = std::string(header.method_string());
  request.target = std::string(header.target());
  for (const auto& field : header) {
    std::string name(field.name_string());
    for (char& c : name)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    request.headers[name] = std::string(field.value());
  }
  return request;
}

class Connection;

// What connections share.
struct Site {
  Access access;
  const Page page;
  const Api api;
  const ServerOptions& options;
  const ProjectFolder& project;
  std::set<PageSession*> sessions;
  std::list<Connection*> connections;  // that serve requests, the oldest first
  Stopwatch clock;
};

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, Site& site) : stream_(std::move(socket)), site_(site) {
    error_code ignored;
    peer_ = stream_.socket().remote_endpoint(ignored);
    site_.connections.push_back(this);
  }
  ~Connection() { leaveSite(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  asio::ip::address address() const { return peer_.address(); }
  bool isTrusted() const { return trusted_; }  // it has sent a request with the token

  // It no longer counts, and its operations end.
  void close() {
    leaveSite();
    stream_.close();
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeader);
    parser_->body_limit(kMaxUploadBytes);
    stream_.expires_after(trusted_ ? kRequestTime : kFirstHeaderTime);
    http::async_read_header(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](const error_code& error, std::size_t /*size*/) { self->headerRead(error); });
  }

 private:
  // Everything that can be rejected without the body is.
  void headerRead(const error_code& error) {
    if (error == http::error::end_of_stream) return shutDown();
    if (error == http::error::body_limit) return reject(errorResponse(413, "the request is too large"));
    if (error == http::error::header_limit) return reject(errorResponse(431, "the header of the request is too large"));
    if (error) {
      if (error.category() == http::make_error_code(http::error::bad_method).category())
        return reject(errorResponse(400, "the request is not valid HTTP"));
      return;
    }
    request_ = toRequest(parser_->get().base());
    if (std::optional<HttpResponse> denied =
            site_.access.check(request_, {site_.clock.seconds(), [this] { return isOwnUser(); }})) {
      if (parser_->is_done()) return write(std::move(*denied));
      return reject(std::move(*denied));
    }
    trusted_ = true;
    stream_.expires_after(kRequestTime);
    if (beast::websocket::is_upgrade(parser_->get())) return upgrade();
    const std::uint64_t limit = maxBodyBytes(request_.method, request_.target);
    const boost::optional<std::uint64_t> length = parser_->content_length();
    if (length && *length > limit)
      return reject(errorResponse(413, fmt::format("the request has more than {} bytes", limit)));
    parser_->body_limit(limit);
    if (parser_->get()[http::field::expect] == "100-continue") return acceptBody();
    readBody();
  }

  bool isOwnUser() {
    error_code error;
    const tcp::endpoint server = stream_.socket().local_endpoint(error);
    return !error && userOfSocket(peer_, server) == ::getuid();
  }

  void leaveSite() { std::erase(site_.connections, this); }

  void acceptBody() {
    continue_.emplace(http::status::continue_, 11);
    http::async_write(stream_, *continue_, [self = shared_from_this()](const error_code& error, std::size_t /*size*/) {
      if (!error) self->readBody();
    });
  }

  void readBody() {
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](const error_code& error, std::size_t /*size*/) {
                       if (error == http::error::body_limit)
                         return self->reject(errorResponse(413, "the request is too large"));
                       if (error) return;
                       self->request_.body = std::move(self->parser_->get().body());
                       self->answer();
                     });
  }

  void answer() {
    const std::optional<RequestTarget> target = parseTarget(request_.target);
    if (target->path.starts_with("/api/")) {
      nonce_.clear();
      Api::Answer answer = site_.api.handle(request_);
      if (auto* response = std::get_if<HttpResponse>(&answer)) return write(std::move(*response));
      stream_.expires_never();  // the answer has a time limit of its own
      return awaitAnswer(std::get<std::unique_ptr<PendingAnswer>>(std::move(answer)));
    }
    nonce_ = randomToken();
    if (target->path == "/ws") return write(errorResponse(426, "this address is that of the WebSocket"));
    if (request_.method != "GET") {
      HttpResponse response = errorResponse(405, fmt::format("the method {} is not supported here", request_.method));
      response.headers.emplace_back("Allow", "GET");
      return write(std::move(response));
    }
    write(site_.page.get(target->path, request_.header("if-none-match"), nonce_));
  }

  // Other connections are served in the meantime.
  void awaitAnswer(std::shared_ptr<PendingAnswer> answer) {
    if (std::optional<HttpResponse> response = answer->poll()) return write(std::move(*response));
    answerTimer_.expires_after(kAnswerPoll);
    answerTimer_.async_wait([self = shared_from_this(), answer = std::move(answer)](const error_code& error) {
      if (!error) self->awaitAnswer(answer);
    });
  }

  void upgrade() {
    if (parseTarget(request_.target)->path != "/ws") return reject(errorResponse(404, "this page does not exist"));
    PageSession::Options options;
    options.worker = site_.options.worker;
    options.settings.folder = site_.project.root().string();
    options.settings.device = site_.options.device;
    options.settings.contained = site_.options.contained;
    options.settings.memory = site_.options.memory;
    options.settings.defaults = site_.options.defaults;
    options.project = &site_.project;
    options.idleSeconds = site_.options.idleSeconds;
    options.memoryHint = site_.options.memoryHint;
    const bool accepted = site_.sessions.size() < site_.options.defaults.maxSessions;
    options.accepted = accepted;
    auto key = std::make_shared<PageSession*>(nullptr);
    options.onEnd = [&site = site_, key] { site.sessions.erase(*key); };
    const auto session = std::make_shared<PageSession>(std::move(stream_), std::move(options));
    *key = session.get();
    if (accepted) site_.sessions.insert(session.get());
    leaveSite();
    session->start(parser_->release());
  }

  // Answers and closes the connection, because the body is not read.
  void reject(HttpResponse response) {
    closes_ = true;
    write(std::move(response));
  }

  void write(HttpResponse response) {
    addSecurityHeaders(response, request_.header("host"), nonce_);
    closes_ = closes_ || !parser_->get().keep_alive();
    response_.emplace(static_cast<http::status>(response.status), 11);
    response_->set(http::field::server, "quintet-lab");
    response_->set(http::field::content_type, response.type);
    for (const auto& [name, value] : response.headers) response_->insert(name, value);
    response_->keep_alive(!closes_);
    response_->body() = std::move(response.body);
    response_->prepare_payload();
    stream_.expires_after(kRequestTime);
    http::async_write(stream_, *response_, [self = shared_from_this()](const error_code& error, std::size_t /*size*/) {
      if (error) return;
      if (self->closes_) return self->shutDown();
      self->response_.reset();
      self->read();
    });
  }

  void shutDown() {
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    // Closing a socket with unread data would discard the answer.
    drain();
  }

  void drain() {
    stream_.expires_after(std::chrono::seconds(2));
    stream_.async_read_some(buffer_.prepare(65536),
                            [self = shared_from_this()](const error_code& error, std::size_t /*size*/) {
                              if (!error && (self->drained_ += 65536) < kMaxDrained) self->drain();
                            });
  }

  static constexpr std::size_t kMaxDrained = std::size_t{16} << 20;

  beast::tcp_stream stream_;
  tcp::endpoint peer_;
  bool trusted_ = false;
  asio::steady_timer answerTimer_{stream_.get_executor()};
  Site& site_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::response<http::string_body>> response_;
  std::optional<http::response<http::empty_body>> continue_;
  HttpRequest request_;
  std::string nonce_ = "none";
  bool closes_ = false;
  std::size_t drained_ = 0;
};

}  // namespace

class Server::Implementation {
 public:
  Implementation(const ProjectFolder& project, ServerOptions options)
      : options_(std::move(options)),
        token_(options_.token.empty() ? randomToken() : options_.token),
        acceptor_(context_),
        port_(listen()),
        signals_(context_, SIGINT, SIGTERM),
        stopTimer_(context_) {
    site_.emplace(Site{.access = Access(token_, port_, machineName()),
                       .page = Page(options_.page),
                       .api = Api(project, options_.defaults),
                       .options = options_,
                       .project = project,
                       .sessions = {},
                       .connections = {},
                       .clock = {}});
  }

  std::uint16_t port() const { return port_; }

  std::string url() const { return address() + "/?token=" + token_; }
  std::string urlForBrowser() { return address() + "/?ticket=" + site_->access.issueTicket(site_->clock.seconds()); }

  std::string exposure() const {
    const asio::ip::address bound = asio::ip::make_address(options_.address);
    if (bound.is_loopback()) return {};
    return fmt::format(
        "all machines that reach {}, port {}, can connect; a person who has the URL, or reads it on the network (HTTP "
        "is not encrypted), can read and change the files of the project and run shaders",
        bound.is_unspecified() ? "an address of this machine" : options_.address, port_);
  }

  void run() {
    signals_.async_wait([this](const error_code& error, int /*signal*/) {
      if (!error) beginStop();
    });
    accept();
    context_.run();
  }

  void stop() {
    asio::post(context_, [this] { beginStop(); });
  }

 private:
  std::string address() const {
    const asio::ip::address bound = asio::ip::make_address(options_.address);
    std::string host = bound.is_unspecified() ? machineName() : options_.address;
    if (host.empty()) host = "localhost";
    if (host.find(':') != host.npos) host = fmt::format("[{}]", host);
    return fmt::format("http://{}:{}", host, port_);
  }

  std::uint16_t listen() {
    error_code error;
    const asio::ip::address address = asio::ip::make_address(options_.address, error);
    if (error) throw UsageError(fmt::format("'{}' is not an IP address", options_.address));
    const tcp::endpoint endpoint(address, options_.port);
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(tcp::acceptor::max_listen_connections, error);
    if (error)
      throw Error(fmt::format("cannot listen on {} port {}: {}", options_.address, options_.port, error.message()));
    return acceptor_.local_endpoint().port();
  }

  void accept() {
    acceptor_.async_accept([this](const error_code& error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) return acceptLater();
      error_code ignored;
      const asio::ip::address address = socket.remote_endpoint(ignored).address();
      if (makeRoom(address)) {
        socket.set_option(tcp::no_delay(true), ignored);  // an image does not wait for the confirmation of its header
        std::make_shared<Connection>(std::move(socket), *site_)->read();
      }
      accept();
    });
  }

  void acceptLater() {
    acceptTimer_.expires_after(kAcceptPause);
    acceptTimer_.async_wait([this](const error_code& error) {
      if (!error && acceptor_.is_open()) accept();
    });
  }

  // Connections that have not sent the token make room for a new one, so that a browser gets in, however many others keep open.
  bool makeRoom(const asio::ip::address& address) {
    const auto& all = site_->connections;
    const auto isSame = [&](const Connection* connection) { return connection->address() == address; };
    const bool full = all.size() >= kMaxConnections;
    if (!full && static_cast<std::size_t>(std::ranges::count_if(all, isSame)) < kMaxConnectionsPerAddress) return true;
    const auto victim = std::ranges::find_if(
        all, [&](const Connection* connection) { return !connection->isTrusted() && (full || isSame(connection)); });
    if (victim == all.end()) return false;
    (*victim)->close();
    return true;
  }

  // Pages learn that the server ends, and their workers end.
  void beginStop() {
    acceptor_.close();
    acceptTimer_.cancel();
    for (PageSession* session : site_->sessions) session->stop();
    stopTimer_.expires_after(site_->sessions.empty() ? std::chrono::seconds(0) : kStopTime);
    stopTimer_.async_wait([this](const error_code& /*error*/) { context_.stop(); });
    awaitSessions();
  }

  void awaitSessions() {
    if (site_->sessions.empty()) return context_.stop();
    auto timer = std::make_shared<asio::steady_timer>(context_, std::chrono::milliseconds(10));
    timer->async_wait([this, timer](const error_code& /*error*/) { awaitSessions(); });
  }

  const ServerOptions options_;
  const std::string token_;
  std::optional<Site> site_;     // outlives the sessions and connections, which the context owns
  asio::io_context context_{1};  // one thread
  tcp::acceptor acceptor_;
  const std::uint16_t port_;
  asio::signal_set signals_;
  asio::steady_timer stopTimer_, acceptTimer_{context_};
};

Server::Server(const ProjectFolder& project, ServerOptions options)
    : implementation_(std::make_unique<Implementation>(project, std::move(options))) {}
Server::~Server() = default;

std::uint16_t Server::port() const { return implementation_->port(); }
std::string Server::url() const { return implementation_->url(); }
std::string Server::urlForBrowser() { return implementation_->urlForBrowser(); }
std::string Server::exposure() const { return implementation_->exposure(); }
void Server::run() { implementation_->run(); }
void Server::stop() { implementation_->stop(); }

}  // namespace quintet::lab
