// Private to src/io: OpenEXR's streams over memory.
#ifndef QUINTET_IO_EXR_STREAM_H
#define QUINTET_IO_EXR_STREAM_H

#include <ImfIO.h>

#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "io/formats.h"

namespace quintet::io {

class ExrReadStream : public Imf::IStream {
 public:
  explicit ExrReadStream(const Source& source) : Imf::IStream(source.name.c_str()), source_(source) {}

  bool read(char to[], int count) override {
    if (count < 0 || at_ > source_.size() || static_cast<std::size_t>(count) > source_.size() - at_) {
      ended_ = true;
      throw std::runtime_error("data ends early");
    }
    std::memcpy(to, source_.data() + at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return at_ < source_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }
  bool ended() const { return ended_; }

 private:
  const Source& source_;
  std::uint64_t at_ = 0;
  bool ended_ = false;
};

class ExrWriteStream : public Imf::OStream {
 public:
  ExrWriteStream() : Imf::OStream("memory") {}

  void write(const char from[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (at_ + size > bytes_.size()) bytes_.resize(at_ + size);
    std::memcpy(bytes_.data() + at_, from, size);
    at_ += size;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
  std::size_t at_ = 0;
};

}  // namespace quintet::io
#endif
