// SPDX-License-Identifier: Apache-2.0
#include "page_client.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "lab/file_message.h"
#include "lab/page_message.h"

extern char** environ;  // NOLINT: POSIX

namespace quintet::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

tcp::endpoint endpointOf(const LabProcess& server) { return {asio::ip::make_address("127.0.0.1"), server.port()}; }

// The token, and the host, unless the test has its own.
Headers withDefaults(const LabProcess& server, Headers headers) {
  headers.emplace("host", fmt::format("127.0.0.1:{}", server.port()));
  if (!headers.contains("cookie")) headers.emplace("authorization", "Bearer " + server.token());
  return headers;
}

}  // namespace

LabProcess::LabProcess(const std::filesystem::path& target, const std::vector<std::string>& options,
                       bool opensBrowser) {
  std::vector<std::string> texts{QUINTET_LAB_BINARY, target.string(), "--port", "0"};
  if (!opensBrowser) texts.emplace_back("--no-open");
  texts.insert(texts.end(), options.begin(), options.end());
  std::vector<char*> arguments;
  for (std::string& text : texts) arguments.push_back(text.data());
  arguments.push_back(nullptr);
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe");
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  const int failed = ::posix_spawn(&process_, arguments[0], &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  std::string line;
  char c = 0;
  while (failed == 0 && ::read(ends[0], &c, 1) == 1 && c != '\n') line += c;
  ::close(ends[0]);
  const std::size_t colon = line.rfind(':'), token = line.find("/?token=");
  if (!line.starts_with("http://127.0.0.1:") || token == line.npos)
    throw std::runtime_error("the server printed no URL: " + line);
  port_ = static_cast<std::uint16_t>(std::stoi(line.substr(colon + 1)));
  token_ = line.substr(token + 8);
}

LabProcess::~LabProcess() { stop(); }

int LabProcess::stop() {
  if (process_ < 0) return 0;
  ::kill(process_, SIGTERM);
  int status = 0;
  ::waitpid(process_, &status, 0);
  process_ = -1;
  return WIFSIGNALED(status) ? 1000 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::vector<pid_t> LabProcess::workers() const {
  std::ifstream file(fmt::format("/proc/{0}/task/{0}/children", process_));
  std::vector<pid_t> children;
  for (pid_t child = 0; file >> child;) children.push_back(child);
  return children;
}

std::size_t LabProcess::memory() const {
  std::ifstream file(fmt::format("/proc/{}/statm", process_));
  std::size_t size = 0, resident = 0;
  file >> size >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

Reply LabProcess::request(const std::string& method, const std::string& target, const std::string& body,
                          Headers headers) const {
  asio::io_context context;
  beast::tcp_stream stream(context);
  stream.connect(endpointOf(*this));
  http::request<http::string_body> request;
  request.method_string(method);
  request.target(target);
  request.version(11);
  request.body() = body;
  request.prepare_payload();
  for (const auto& [name, value] : withDefaults(*this, std::move(headers))) request.set(name, value);
  error_code error;
  http::write(stream, request, error);  // the server can answer before it has read everything
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(std::uint64_t{1} << 30);
  http::read(stream, buffer, parser, error);
  Reply reply;
  if (error) return reply;
  reply.status = parser.get().result_int();
  for (const auto& field : parser.get()) {
    std::string name(field.name_string());
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    reply.headers[name] = std::string(field.value());
  }
  reply.body = parser.get().body();
  return reply;
}

struct PageClient::Connection {
  asio::io_context context;
  websocket::stream<beast::tcp_stream> stream{context};
  beast::flat_buffer buffer;
  bool open = false;

  // Runs the operation that was started, up to `seconds`. Returns its error.
  error_code run(const std::optional<error_code>& result, double seconds) {
    context.restart();
    context.run_for(std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds)));
    if (!result) throw std::runtime_error(fmt::format("nothing arrived within {} s", seconds));
    return *result;
  }
};

PageClient::PageClient(const LabProcess& server, const Headers& headers) : connection_(std::make_unique<Connection>()) {
  auto& stream = connection_->stream;
  beast::get_lowest_layer(stream).connect(endpointOf(server));
  const Headers all = withDefaults(server, headers);
  stream.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
    for (const auto& [name, value] : all) request.set(name, value);
  }));
  stream.read_message_max(std::size_t{1} << 28);
  error_code error;
  stream.handshake(all.at("host"), "/ws", error);
  connection_->open = !error;
}

PageClient::~PageClient() = default;

bool PageClient::isOpen() const { return connection_->open; }
void PageClient::send(const Json& message) { sendText(message.dump()); }
void PageClient::sendText(const std::string& text) { connection_->stream.write(asio::buffer(text)); }

bool PageClient::receive(double seconds) {
  event_.reset();
  image_.reset();
  part_.reset();
  connection_->buffer.clear();
  std::optional<error_code> result;
  connection_->stream.async_read(connection_->buffer,
                                 [&](const error_code& error, std::size_t /*size*/) { result = error; });
  if (connection_->run(result, seconds)) return false;
  std::string message = beast::buffers_to_string(connection_->buffer.data());
  if (connection_->stream.got_binary()) {
    if (const auto part = lab::parseFileMessage(message)) {
      part_ = part->bytes;
      return true;
    }
    const auto header = lab::parseImageHeader(message);
    if (!header) throw std::runtime_error("an image has no valid header");
    image_ = ReceivedImage{*header, message.substr(lab::kImageHeaderBytes)};
    send({{"do", "received"}, {"image", header->number}});
  } else {
    event_ = Json::parse(message);
    lab::labSchema().checkEvent(*event_);
    events_.push_back(*event_);
  }
  return true;
}

Json PageClient::waitFor(const std::function<bool(const Json&)>& matches, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    if (!receive(seconds)) throw std::runtime_error("the server closed the WebSocket");
    if (event_ && matches(*event_)) return *event_;
  }
  std::string last;
  for (std::size_t i = events_.size() - std::min<std::size_t>(events_.size(), 5); i < events_.size(); ++i)
    last += events_[i].dump() + "\n";
  throw std::runtime_error("the expected event did not arrive; the last ones:\n" + last);
}

Json PageClient::waitFor(const std::string& event, double seconds) {
  return waitFor([&](const Json& json) { return json.value("event", "") == event; }, seconds);
}

Json PageClient::waitForWorker(const std::string& state, double seconds) {
  return waitFor(
      [&](const Json& json) { return json.value("event", "") == "worker" && json.value("state", "") == state; },
      seconds);
}

ReceivedImage PageClient::waitForImage(const std::function<bool(const lab::ImageHeader&)>& matches, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    if (!receive(seconds)) throw std::runtime_error("the server closed the WebSocket");
    if (image_ && (!matches || matches(image_->header))) return *image_;
  }
  throw std::runtime_error("the expected image did not arrive");
}

std::string PageClient::readFile(const Json& file) {
  std::string content;
  while (content.size() < file.at("size").get<std::size_t>()) {
    send({{"do", "read"}, {"file", file.at("file")}, {"offset", content.size()}});
    do {
      if (!receive(30)) throw std::runtime_error("the server closed the WebSocket");
      if (event_ && event_->value("event", "") == "error") throw std::runtime_error(event_->dump());
    } while (!part_);
    if (part_->empty()) throw std::runtime_error("the file is shorter than stated");
    content += *part_;
  }
  return content;
}

unsigned PageClient::waitForClose(double seconds) {
  while (receive(seconds)) {
  }
  return connection_->stream.reason().code;
}

std::string PageClient::closeReason() const { return connection_->stream.reason().reason.c_str(); }

void PageClient::close() {
  error_code ignored;
  connection_->stream.close(websocket::close_code::normal, ignored);
}

}  // namespace quintet::test
