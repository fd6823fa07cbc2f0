// SPDX-License-Identifier: Apache-2.0
// Instructions of SPV_EXT_shader_invocation_reorder as those of the NV extension, word by word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <spirv/unified1/spirv.hpp11>
#include <vector>

#include "spirv/reorder_code.h"

namespace quintet::spirv {
namespace {

using spv::Op;
using testing::ElementsAreArray;

using WordList = std::vector<std::uint32_t>;

WordList encoded(std::uint32_t op, std::initializer_list<std::uint32_t> operands) {
  WordList words{static_cast<std::uint32_t>((operands.size() + 1) << 16) | op};
  words.insert(words.end(), operands);
  return words;
}
WordList encoded(Op op, std::initializer_list<std::uint32_t> operands) {
  return encoded(static_cast<std::uint32_t>(op), operands);
}

constexpr std::uint32_t kIdBound = 100;

WordList moduleOf(std::initializer_list<WordList> instructions, std::uint32_t bound = kIdBound) {
  WordList words{spv::MagicNumber, 0x10500, 0, bound, 0};
  for (const WordList& i : instructions) words.insert(words.end(), i.begin(), i.end());
  return words;
}

const WordList kExtCapability = encoded(Op::OpCapability, {5388}), kKnownCapability = encoded(Op::OpCapability, {5383});

// `given` with the capability of the EXT extension becomes `expected` with that of the NV extension.
void expectCode(const WordList& given, std::initializer_list<WordList> expected, std::uint32_t bound = kIdBound) {
  WordList wanted = moduleOf({kKnownCapability}, bound);
  for (const WordList& i : expected) wanted.insert(wanted.end(), i.begin(), i.end());
  EXPECT_THAT(withReorderNv(moduleOf({kExtCapability, given})), ElementsAreArray(wanted))
      << "opcode " << (given[0] & 0xFFFFu);
}

TEST(ReorderCode, EqualInstructionsGetTheirNumber) {
  expectCode(encoded(5313, {7}), {encoded(Op::OpTypeHitObjectNV, {7})});
  expectCode(encoded(5319, {7, 8}), {encoded(Op::OpHitObjectExecuteShaderNV, {7, 8})});
  expectCode(encoded(5351, {1, 20, 7}), {encoded(Op::OpHitObjectIsHitNV, {1, 20, 7})});
  expectCode(encoded(5308, {1, 20, 7}), {encoded(Op::OpHitObjectGetPrimitiveIndexNV, {1, 20, 7})});
  expectCode(encoded(Op::OpVariable, {1, 20, 5411}), {encoded(Op::OpVariable, {1, 20, 5385})});
  expectCode(encoded(Op::OpTypePointer, {20, 5411, 3}), {encoded(Op::OpTypePointer, {20, 5385, 3})});
  expectCode(encoded(Op::OpDecorate, {20, 5389}), {encoded(Op::OpDecorate, {20, 5386})});
}

TEST(ReorderCode, CombinedInstructionsBecomeTheirParts) {
  const WordList trace = encoded(Op::OpHitObjectTraceRayNV, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}),
                 execute = encoded(Op::OpHitObjectExecuteShaderNV, {1, 12});
  expectCode(encoded(5316, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}), {trace});
  expectCode(encoded(5317, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 99, 12}), {trace});  // motion blur
  expectCode(encoded(5310, {1, 12}), {execute});
  expectCode(encoded(5310, {1, 12, 30, 31}), {execute});  // with a hint
  expectCode(encoded(5311, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}), {trace, execute});
  expectCode(encoded(5311, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 30, 31}), {trace, execute});
  expectCode(encoded(5312, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 99, 12}), {trace, execute});
  expectCode(encoded(5312, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 99, 12, 30, 31}), {trace, execute});
}

TEST(ReorderCode, RecordsKeepWhatIsFollowed) {
  const WordList miss = encoded(Op::OpHitObjectRecordMissNV, {1, 3, 4, 5, 6, 7}),
                 unknown = encoded(Op::OpHitObjectRecordEmptyNV, {1});
  expectCode(encoded(5305, {1, 2, 3, 4, 5, 6, 7}), {miss});
  expectCode(encoded(5306, {1, 2, 3, 4, 5, 6, 7, 99}), {miss});
  expectCode(encoded(5304, {1, 2, 3, 4}), {unknown});  // from a ray query
  expectCode(encoded(5309, {1, 2}), {unknown});
  // Records of motion blur, also of the NV extension alone.
  EXPECT_THAT(withReorderNv(moduleOf({encoded(Op::OpHitObjectRecordMissMotionNV, {1, 3, 4, 5, 6, 7, 99})})),
              ElementsAreArray(moduleOf({miss})));
}

TEST(ReorderCode, VerticesAreAVectorOfTheObject) {
  const WordList array = encoded(Op::OpTypeArray, {40, 41, 42});
  const WordList given = moduleOf({kExtCapability, array, encoded(5307, {40, 50, 7})});
  const auto vertex = [](std::uint32_t id) { return encoded(Op::OpHitObjectGetObjectRayOriginNV, {41, id, 7}); };
  EXPECT_THAT(withReorderNv(given),
              ElementsAreArray(moduleOf({kKnownCapability, array, vertex(100), vertex(101), vertex(102),
                                         encoded(Op::OpCompositeConstruct, {40, 50, 100, 101, 102})},
                                        103)));
}

TEST(ReorderCode, OtherModulesAndIncompleteInstructionsAreCopied) {
  const WordList other = moduleOf({encoded(5316, {1}), encoded(Op::OpCapability, {5383})});
  EXPECT_THAT(withReorderNv(other), ElementsAreArray(other));
  for (const std::uint32_t op : {5304u, 5305u, 5307u, 5309u, 5310u, 5311u, 5312u, 5317u})
    expectCode(encoded(op, {}), {encoded(op, {})});
  EXPECT_THAT(withReorderNv(WordList{spv::MagicNumber, 0, 0}), ElementsAreArray(WordList{spv::MagicNumber, 0, 0}));
}

}  // namespace
}  // namespace quintet::spirv
