// SPDX-License-Identifier: Apache-2.0
// The instructions of SPIR-V words that no Module has read: for code that copies a module, or looks for a declaration. Any
// words are safe. An instruction of length 0 counts as one word, and one beyond the end has the words that are left.
#ifndef QUINTET_SPIRV_RAW_INSTRUCTIONS_H
#define QUINTET_SPIRV_RAW_INSTRUCTIONS_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <spirv/unified1/spirv.hpp11>
#include <string_view>
#include <vector>

namespace quintet::spirv {

using Words = std::span<const std::uint32_t>;

inline constexpr std::size_t kHeaderWords = 5;  // of a module, before its first instruction

struct RawInstruction {
  spv::Op op = spv::Op::OpNop;
  std::size_t position = 0;  // of the first word in the module
  Words words;               // the first one has length and opcode
  Words operands;            // with result type and result

  std::uint32_t at(std::size_t i) const { return i < operands.size() ? operands[i] : 0; }  // 0 if missing
};

// The instructions of a module in their order: `for (const RawInstruction& i : RawInstructions(words))`.
class RawInstructions {
 public:
  explicit RawInstructions(Words words) : words_(words) {}

  class Iterator {
   public:
    Iterator(Words words, std::size_t at) : words_(words), at_(at) {}
    RawInstruction operator*() const {
      const Words all = words_.subspan(at_, count());
      return {static_cast<spv::Op>(all[0] & 0xFFFFu), at_, all, all.subspan(1)};
    }
    Iterator& operator++() {
      at_ += count();
      return *this;
    }
    bool operator==(std::default_sentinel_t) const { return at_ >= words_.size(); }

   private:
    std::size_t count() const { return std::clamp<std::size_t>(words_[at_] >> 16, 1, words_.size() - at_); }

    Words words_;
    std::size_t at_;
  };

  Iterator begin() const { return {words_, kHeaderWords}; }
  std::default_sentinel_t end() const { return {}; }

 private:
  Words words_;
};

// The words before the first instruction; fewer if the module has fewer.
inline std::vector<std::uint32_t> headerOf(Words words) {
  const Words header = words.first(std::min(words.size(), kHeaderWords));
  return {header.begin(), header.end()};
}

inline void append(std::vector<std::uint32_t>& result, Words words) {
  result.insert(result.end(), words.begin(), words.end());
}

// The text of operands that are a literal string and nothing else. It refers to the words.
inline std::string_view literalText(Words operands) {
  const std::string_view padded(reinterpret_cast<const char*>(operands.data()), operands.size_bytes());
  return padded.substr(0, padded.find('\0'));
}

}  // namespace quintet::spirv
#endif
