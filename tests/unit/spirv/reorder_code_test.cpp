// SPDX-License-Identifier: Apache-2.0
// Instructions of SPV_EXT_shader_invocation_reorder as those of the NV extension, word by word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "spirv/reorder_code.h"

namespace quintet::spirv {
namespace {

using testing::ElementsAreArray;
using Op = spv::Op;

using WordList = std::vector<std::uint32_t>;

WordList instruction(std::uint32_t op, std::initializer_list<std::uint32_t> operands) {
  WordList words{static_cast<std::uint32_t>((operands.size() + 1) << 16) | op};
  words.insert(words.end(), operands);
  return words;
}
WordList instruction(Op op, std::initializer_list<std::uint32_t> operands) {
  return instruction(static_cast<std::uint32_t>(op), operands);
}

constexpr std::uint32_t kBound = 100;

WordList module(std::initializer_list<WordList> instructions, std::uint32_t bound = kBound) {
  WordList words{spv::MagicNumber, 0x10500, 0, bound, 0};
  for (const WordList& i : instructions) words.insert(words.end(), i.begin(), i.end());
  return words;
}

const WordList kCapability = instruction(Op::OpCapability, {5388}),
               kKnownCapability = instruction(Op::OpCapability, {5383});

// `given` with the capability of the EXT extension becomes `expected` with that of the NV extension.
void expectCode(const WordList& given, std::initializer_list<WordList> expected, std::uint32_t bound = kBound) {
  WordList wanted = module({kKnownCapability}, bound);
  for (const WordList& i : expected) wanted.insert(wanted.end(), i.begin(), i.end());
  EXPECT_THAT(withReorderNv(module({kCapability, given})), ElementsAreArray(wanted))
      << "opcode " << (given[0] & 0xFFFFu);
}

TEST(ReorderCode, EqualInstructionsGetTheirNumber) {
  expectCode(instruction(5313, {7}), {instruction(Op::OpTypeHitObjectNV, {7})});
  expectCode(instruction(5319, {7, 8}), {instruction(Op::OpHitObjectExecuteShaderNV, {7, 8})});
  expectCode(instruction(5351, {1, 20, 7}), {instruction(Op::OpHitObjectIsHitNV, {1, 20, 7})});
  expectCode(instruction(5308, {1, 20, 7}), {instruction(Op::OpHitObjectGetPrimitiveIndexNV, {1, 20, 7})});
  expectCode(instruction(Op::OpVariable, {1, 20, 5411}), {instruction(Op::OpVariable, {1, 20, 5385})});
  expectCode(instruction(Op::OpTypePointer, {20, 5411, 3}), {instruction(Op::OpTypePointer, {20, 5385, 3})});
  expectCode(instruction(Op::OpDecorate, {20, 5389}), {instruction(Op::OpDecorate, {20, 5386})});
}

TEST(ReorderCode, CombinedInstructionsBecomeTheirParts) {
  const WordList trace = instruction(Op::OpHitObjectTraceRayNV, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}),
                 execute = instruction(Op::OpHitObjectExecuteShaderNV, {1, 12});
  expectCode(instruction(5316, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}), {trace});
  expectCode(instruction(5317, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 99, 12}), {trace});  // motion blur
  expectCode(instruction(5310, {1, 12}), {execute});
  expectCode(instruction(5310, {1, 12, 30, 31}), {execute});  // with a hint
  expectCode(instruction(5311, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}), {trace, execute});
  expectCode(instruction(5311, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 30, 31}), {trace, execute});
  expectCode(instruction(5312, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 99, 12}), {trace, execute});
  expectCode(instruction(5312, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 99, 12, 30, 31}), {trace, execute});
}

TEST(ReorderCode, RecordsKeepWhatIsFollowed) {
  const WordList miss = instruction(Op::OpHitObjectRecordMissNV, {1, 3, 4, 5, 6, 7}),
                 unknown = instruction(Op::OpHitObjectRecordEmptyNV, {1});
  expectCode(instruction(5305, {1, 2, 3, 4, 5, 6, 7}), {miss});
  expectCode(instruction(5306, {1, 2, 3, 4, 5, 6, 7, 99}), {miss});
  expectCode(instruction(5304, {1, 2, 3, 4}), {unknown});  // from a ray query
  expectCode(instruction(5309, {1, 2}), {unknown});
  // Records of motion blur, also of the NV extension alone.
  EXPECT_THAT(withReorderNv(module({instruction(Op::OpHitObjectRecordMissMotionNV, {1, 3, 4, 5, 6, 7, 99})})),
              ElementsAreArray(module({miss})));
}

TEST(ReorderCode, VerticesAreAVectorOfTheObject) {
  const WordList array = instruction(Op::OpTypeArray, {40, 41, 42});
  const WordList given = module({kCapability, array, instruction(5307, {40, 50, 7})});
  const auto vertex = [](std::uint32_t id) { return instruction(Op::OpHitObjectGetObjectRayOriginNV, {41, id, 7}); };
  EXPECT_THAT(withReorderNv(given),
              ElementsAreArray(module({kKnownCapability, array, vertex(100), vertex(101), vertex(102),
                                       instruction(Op::OpCompositeConstruct, {40, 50, 100, 101, 102})},
                                      103)));
}

TEST(ReorderCode, OtherModulesAndIncompleteInstructionsAreCopied) {
  const WordList other = module({instruction(5316, {1}), instruction(Op::OpCapability, {5383})});
  EXPECT_THAT(withReorderNv(other), ElementsAreArray(other));
  for (const std::uint32_t op : {5304u, 5305u, 5307u, 5309u, 5310u, 5311u, 5312u, 5317u})
    expectCode(instruction(op, {}), {instruction(op, {})});
  EXPECT_THAT(withReorderNv(WordList{spv::MagicNumber, 0, 0}), ElementsAreArray(WordList{spv::MagicNumber, 0, 0}));
}

}  // namespace
}  // namespace quintet::spirv
