// SPDX-License-Identifier: Apache-2.0
// Messages between the server and a worker over a stream socket: a header of five bytes (kind, size in little endian)
// and the bytes. The server parses them as they arrive; the worker reads and writes blocking.
#ifndef QUINTET_LAB_FRAME_CHANNEL_H
#define QUINTET_LAB_FRAME_CHANNEL_H

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace quintet::lab {

enum class FrameKind : std::uint8_t {
  text = 1,     // JSON from or to the page
  binary = 2,   // an image for the page
  control = 3,  // JSON between server and worker: worker_control.h
};

struct ChannelFrame {
  FrameKind kind = FrameKind::text;
  std::string data;
};

inline constexpr std::size_t kMaxFrameBytes = std::size_t{64} << 20;

std::string frameBytes(FrameKind kind, std::string_view data);

// Collects bytes and returns complete messages.
class FrameParser {
 public:
  void add(std::string_view bytes) { bytes_ += bytes; }
  // Throws Error for an unknown kind or a size above the limit.
  std::optional<ChannelFrame> next();

 private:
  std::string bytes_;
  std::size_t begin_ = 0;
};

// The worker's side. write() can be called from several threads.
class FrameChannel {
 public:
  explicit FrameChannel(int socket) : socket_(socket) {}
  std::optional<ChannelFrame> read();                 // nothing at the end of the stream
  void write(FrameKind kind, std::string_view data);  // without effect after the server has closed the socket

 private:
  const int socket_;
  FrameParser parser_;
  std::mutex writing_;
};

}  // namespace quintet::lab
#endif
