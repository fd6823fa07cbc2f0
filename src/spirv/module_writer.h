// SPDX-License-Identifier: Apache-2.0
// Copies a SPIR-V module instruction by instruction, with changes.
#ifndef QUINTET_SPIRV_MODULE_WRITER_H
#define QUINTET_SPIRV_MODULE_WRITER_H

#include <cstddef>
#include <cstdint>
#include <spirv/unified1/spirv.hpp11>
#include <utility>
#include <vector>

#include "spirv/raw_instructions.h"
#include "spirv/type.h"

namespace quintet::spirv {

class ModuleWriter {
 public:
  // `words`: a module that Module::read() accepts. It must outlive this object.
  explicit ModuleWriter(const std::vector<std::uint32_t>& words)
      : words_(words), result_(words.begin(), words.begin() + kHeaderWords), at_(kHeaderWords) {}

  Id newId() { return result_[3]++; }
  // The next instruction of the source.
  bool atEnd() const { return at_ >= words_.size(); }
  spv::Op next() const { return static_cast<spv::Op>(words_[at_] & 0xFFFFu); }
  std::uint32_t word(std::size_t i) const { return words_[at_ + i]; }  // word 0 is length and opcode
  void copy() {
    const std::size_t count = words_[at_] >> 16;
    result_.insert(result_.end(), words_.begin() + static_cast<std::ptrdiff_t>(at_),
                   words_.begin() + static_cast<std::ptrdiff_t>(at_ + count));
    at_ += count;
  }
  void skip() { at_ += words_[at_] >> 16; }
  // Adds an instruction; the operands begin with the result type and the result, if it has them.
  void emit(spv::Op op, const std::vector<std::uint32_t>& operands) {
    result_.push_back(static_cast<std::uint32_t>(operands.size() + 1) << 16 | static_cast<std::uint32_t>(op));
    result_.insert(result_.end(), operands.begin(), operands.end());
  }
  std::vector<std::uint32_t> take() { return std::move(result_); }

 private:
  const std::vector<std::uint32_t>& words_;
  std::vector<std::uint32_t> result_;
  std::size_t at_;
};

}  // namespace quintet::spirv
#endif
