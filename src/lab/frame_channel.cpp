// SPDX-License-Identifier: Apache-2.0
#include "lab/frame_channel.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>

#include "base/error.h"
#include "lab/little_endian.h"

namespace quintet::lab {
namespace {

constexpr std::size_t kHeader = 5;

}  // namespace

std::string frameBytes(FrameKind kind, std::string_view data) {
  std::string bytes;
  bytes.reserve(kHeader + data.size());
  bytes += static_cast<char>(kind);
  appendInteger(bytes, data.size(), 4);
  bytes += data;
  return bytes;
}

std::optional<ChannelFrame> FrameParser::next() {
  if (bytes_.size() - begin_ < kHeader) return {};
  const std::size_t size = integerAt(bytes_, begin_ + 1, 4);
  const auto kind = static_cast<unsigned char>(bytes_[begin_]);
  if (kind < 1 || kind > 3 || size > kMaxFrameBytes) throw Error("a worker of the lab sent an invalid message");
  if (bytes_.size() - begin_ - kHeader < size) return {};
  ChannelFrame frame{static_cast<FrameKind>(kind), bytes_.substr(begin_ + kHeader, size)};
  begin_ += kHeader + size;
  if (begin_ == bytes_.size() || begin_ > (std::size_t{1} << 20)) {
    bytes_.erase(0, begin_);
    begin_ = 0;
  }
  return frame;
}

std::optional<ChannelFrame> FrameChannel::read() {
  std::array<char, 65536> buffer;  // NOLINT: filled by recv
  while (true) {
    if (std::optional<ChannelFrame> frame = parser_.next()) return frame;
    const ssize_t size = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return {};
    parser_.add({buffer.data(), static_cast<std::size_t>(size)});
  }
}

void FrameChannel::write(FrameKind kind, std::string_view data) {
  const std::string bytes = frameBytes(kind, data);
  const std::lock_guard lock(writing_);
  std::string_view rest = bytes;
  while (!rest.empty()) {
    const ssize_t size = ::send(socket_, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return;
    rest.remove_prefix(static_cast<std::size_t>(size));
  }
}

}  // namespace quintet::lab
