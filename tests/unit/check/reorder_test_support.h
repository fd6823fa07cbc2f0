// SPDX-License-Identifier: Apache-2.0
// Modules of SPV_NV_shader_invocation_reorder, which glslang writes, as modules of SPV_EXT_shader_invocation_reorder, which it does
// not know.
#ifndef QUINTET_TESTS_UNIT_CHECK_REORDER_TEST_SUPPORT_H
#define QUINTET_TESTS_UNIT_CHECK_REORDER_TEST_SUPPORT_H

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "spirv/raw_instructions.h"

namespace quintet::check {

// `combines`: a trace that is directly followed by the execution becomes one instruction.
inline std::vector<std::uint32_t> toReorderExt(const std::vector<std::uint32_t>& words, bool combines = false) {
  static const std::map<std::uint32_t, std::uint32_t> kNumbers{
      {5281, 5313}, {5280, 5314}, {5279, 5315}, {5260, 5316}, {5259, 5318}, {5264, 5319}, {5265, 5320},
      {5266, 5321}, {5267, 5322}, {5268, 5323}, {5269, 5324}, {5270, 5325}, {5271, 5326}, {5255, 5327},
      {5254, 5328}, {5272, 5329}, {5273, 5330}, {5253, 5331}, {5252, 5332}, {5274, 5333}, {5275, 5347},
      {5258, 5348}, {5257, 5349}, {5276, 5350}, {5277, 5351}, {5278, 5352}};
  constexpr std::uint32_t kRecordMiss = 5263, kExtRecordMiss = 5305, kTrace = 5316, kExecute = 5319, kCombined = 5311;
  std::vector<std::uint32_t> result = spirv::headerOf(words);
  std::size_t lastTrace = 0;  // position of the last instruction if it is a trace
  for (const spirv::RawInstruction& i : spirv::RawInstructions(words)) {
    const auto op = static_cast<std::uint32_t>(i.op);
    std::vector<std::uint32_t> next(i.words.begin(), i.words.end());
    if (const auto found = kNumbers.find(op); found != kNumbers.end()) next[0] = next[0] >> 16 << 16 | found->second;
    switch (i.op) {
      case spv::Op::OpCapability:
        if (next[1] == 5383) next[1] = 5388;
        break;
      case spv::Op::OpExtension:
        if (std::memcmp(&next[1], "SPV_NV_shader_invocation_reorder", 32) == 0) {
          next.assign(10, 0);
          next[0] = 10u << 16 | 10u;
          std::memcpy(&next[1], "SPV_EXT_shader_invocation_reorder", 33);
        }
        break;
      case spv::Op::OpTypePointer:
        if (next[2] == 5385) next[2] = 5411;
        break;
      case spv::Op::OpVariable:
        if (next[3] == 5385) next[3] = 5411;
        break;
      default: break;
    }
    if (op == kRecordMiss) {  // any integer as ray flags
      next.insert(next.begin() + 2, next[2]);
      next[0] = static_cast<std::uint32_t>(next.size() << 16) | kExtRecordMiss;
    }
    EXPECT_FALSE(op == 5261 || op == 5262) << "records of hits do not exist in the EXT extension";
    const std::uint32_t written = next[0] & 0xFFFFu;
    if (combines && written == kExecute && lastTrace != 0 && result[lastTrace + 1] == next[1] &&
        result[lastTrace + 12] == next[2]) {
      result[lastTrace] = result[lastTrace] >> 16 << 16 | kCombined;
      lastTrace = 0;
      continue;
    }
    if (written == kTrace)
      lastTrace = result.size();
    else if (i.op != spv::Op::OpLine)
      lastTrace = 0;
    result.insert(result.end(), next.begin(), next.end());
  }
  return result;
}

}  // namespace quintet::check
#endif
