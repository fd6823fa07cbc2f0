// Fills a SpirvModule from words, and refuses what cannot be analysed. Used by spirv_module.cpp alone.
#ifndef QUINTET_SHADER_SPIRV_READER_H
#define QUINTET_SHADER_SPIRV_READER_H

#include "shader/spirv_module.h"

namespace quintet::shader {

class SpirvReader {
 public:
  explicit SpirvReader(SpirvModule& module) : m_(module) {}
  bool read();  // false: error() says why
  const std::string& error() const { return error_; }

 private:
  bool fail(std::string text);
  bool readHeader();
  bool readInstructions();
  bool add(SpirvInstruction instruction, std::size_t where);
  void readDebug(const SpirvInstruction& instruction);
  void readSource(const SpirvInstruction& instruction);
  bool readType(const SpirvInstruction& instruction);
  void readVariable(const SpirvInstruction& instruction);
  bool readFunctions();
  bool linkBlocks(SpirvFunction& function);
  void collectUsers();

  SpirvModule& m_;
  std::string error_;
  std::uint32_t bound_ = 0;
  SpirvId line_ = 0, lineNumber_ = 0, lineColumn_ = 0;  // of the last OpLine
  std::string* openSource_ = nullptr;                   // OpSourceContinued goes on here
  std::vector<std::pair<SpirvId, std::pair<std::uint32_t, std::string>>> memberNames_;
};

}  // namespace quintet::shader
#endif
