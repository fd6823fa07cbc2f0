// SPDX-License-Identifier: Apache-2.0
// Arithmetic of ranges: random sets of values, and ranges that describe them, against the arithmetic of the GPU on each
// value.
#include "spirv/value_range.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace quintet::spirv {
namespace {

using spv::Op;

constexpr int kRounds = 3000;

Type integer(std::uint32_t width, bool isSigned) {
  Type type;
  type.kind = Type::Kind::integer, type.width = width, type.isSigned = isSigned;
  return type;
}

Type floating() {
  Type type;
  type.kind = Type::Kind::floating, type.width = 32;
  return type;
}

// Values, and a range that contains at least them.
struct Sample {
  std::vector<double> values;
  ValueRange range;
};

class Samples {
 public:
  Sample next(const Type& type) {
    std::set<double> values;
    const std::size_t count = 1 + generator_() % 6;
    while (values.size() < count) values.insert(value(type));
    Sample sample{{values.begin(), values.end()}, {}};
    switch (generator_() % 3) {
      case 0: sample.range = ValueRange::among(sample.values, Occurrence::each); break;
      case 1: sample.range = ValueRange::between(sample.values.front(), sample.values.back()); break;
      default: {
        sample.range = ValueRange::of(sample.values[0]);
        for (const double v : sample.values) sample.range = joined(sample.range, fitted(type, ValueRange::of(v)));
      }
    }
    sample.range = fitted(type, sample.range);
    return sample;
  }
  std::size_t pick(std::size_t count) { return generator_() % count; }

 private:
  double value(const Type& type) {
    if (type.kind == Type::Kind::floating) {
      constexpr float kSpecial[] = {0.0f, 1.0f, -1.0f, 0.5f, 3.0f, 1e30f, -1e30f, 1e-30f, INFINITY, -INFINITY};
      if (generator_() % 3 == 0) return kSpecial[generator_() % std::size(kSpecial)];
      return static_cast<float>(std::uniform_real_distribution<double>(-20.0, 20.0)(generator_));
    }
    switch (generator_() % 4) {
      case 0: return lowest(type) + static_cast<double>(generator_() % 3);
      case 1: return highest(type) - static_cast<double>(generator_() % 3);
      default: {
        const double small = static_cast<double>(generator_() % 40);
        return type.isSigned ? small - 20.0 : small;
      }
    }
  }

  std::mt19937 generator_{7};
};

testing::AssertionResult contains(const ValueRange& range, double value) {
  if (std::isnan(value) ? range.nan : range.contains(value)) {
    if (std::isnan(value) || (range.ones == 0 && range.zeros == 0)) return testing::AssertionSuccess();
    const auto bits = static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
    if ((bits & range.ones) == range.ones && (bits & range.zeros) == 0) return testing::AssertionSuccess();
    return testing::AssertionFailure() << value << " does not have the bits " << range.ones << ", " << range.zeros;
  }
  return testing::AssertionFailure() << value << " is not in " << range.min << " to " << range.max
                                     << (range.nan ? " or NaN" : "") << ", " << range.values.size() << " values";
}

// Quotients and remainders by 0, and shifts by the width or more, are undefined.
std::optional<double> onGpu(const Type& type, Op op, double x, double y) {
  const auto a = static_cast<std::int64_t>(x), b = static_cast<std::int64_t>(y);
  const auto bits = static_cast<std::uint32_t>(a) & (type.width == 32 ? ~0u : (1u << type.width) - 1u);
  const bool shifts = b >= 0 && b < static_cast<std::int64_t>(type.width);
  const auto whole = [&](std::int64_t value) { return stored(type, static_cast<double>(value)); };
  switch (op) {
    case Op::OpIAdd: return whole(a + b);
    case Op::OpISub: return whole(a - b);
    case Op::OpIMul:
      return whole(
          static_cast<std::int64_t>(static_cast<std::uint64_t>(a) * static_cast<std::uint64_t>(b) & 0xFFFFFFFFu));
    case Op::OpUDiv:
    case Op::OpSDiv: return b == 0 ? std::nullopt : std::optional(whole(a / b));
    case Op::OpUMod:
    case Op::OpSRem: return b == 0 ? std::nullopt : std::optional(whole(a % b));
    case Op::OpSMod:
      if (b == 0) return {};
      return whole(a % b != 0 && (a % b < 0) != (b < 0) ? a % b + b : a % b);
    case Op::OpBitwiseAnd: return whole(a & b);
    case Op::OpBitwiseOr: return whole(a | b);
    case Op::OpBitwiseXor: return whole(a ^ b);
    case Op::OpShiftLeftLogical: return shifts ? std::optional(whole(bits << b)) : std::nullopt;
    case Op::OpShiftRightLogical: return shifts ? std::optional(whole(bits >> b)) : std::nullopt;
    case Op::OpShiftRightArithmetic: return shifts ? std::optional(whole(a >> b)) : std::nullopt;
    default: break;
  }
  const auto l = static_cast<float>(x), r = static_cast<float>(y);
  switch (op) {
    case Op::OpFAdd: return l + r;
    case Op::OpFSub: return l - r;
    case Op::OpFMul: return l * r;
    case Op::OpFDiv: return r == 0.0f ? std::nullopt : std::optional<double>(l / r);
    case Op::OpFMod:
      return r == 0.0f || std::isinf(r) ? std::nullopt : std::optional<double>(l - r * std::floor(l / r));
    default: ADD_FAILURE() << "no such operation"; return {};
  }
}

void checkBinary(const Type& type, const std::vector<Op>& operations, bool areBitwise) {
  Samples samples;
  for (int round = 0; round < kRounds; ++round) {
    const Op op = operations[samples.pick(operations.size())];
    const Sample a = samples.next(type), b = samples.next(type);
    const ValueRange result = areBitwise ? bitwise(type, op, a.range, b.range) : binary(type, op, a.range, b.range);
    for (const double x : a.values)
      for (const double y : b.values)
        if (const auto expected = onGpu(type, op, x, y)) {
          ASSERT_TRUE(contains(result, *expected)) << static_cast<int>(op) << ": " << x << ", " << y;
        }
  }
}

TEST(ValueRange, ArithmeticContainsAllResults) {
  for (const std::uint32_t width : {16u, 32u}) {
    checkBinary(integer(width, false), {Op::OpIAdd, Op::OpISub, Op::OpIMul, Op::OpUDiv, Op::OpUMod}, false);
    checkBinary(integer(width, true), {Op::OpIAdd, Op::OpISub, Op::OpIMul, Op::OpSDiv, Op::OpSRem, Op::OpSMod}, false);
  }
  checkBinary(floating(), {Op::OpFAdd, Op::OpFSub, Op::OpFMul, Op::OpFDiv, Op::OpFMod}, false);
}

TEST(ValueRange, BitOperationsContainAllResults) {
  for (const std::uint32_t width : {16u, 32u})
    for (const bool isSigned : {false, true})
      checkBinary(integer(width, isSigned),
                  {Op::OpBitwiseAnd, Op::OpBitwiseOr, Op::OpBitwiseXor, Op::OpShiftLeftLogical, Op::OpShiftRightLogical,
                   Op::OpShiftRightArithmetic},
                  true);
}

TEST(ValueRange, FunctionsContainAllResults) {
  Samples samples;
  for (int round = 0; round < kRounds; ++round) {
    const Type type = round % 2 == 0 ? integer(32, true) : floating();
    const Sample a = samples.next(type), b = samples.next(type), c = samples.next(type);
    const ValueRange least = chosen(type, a.range, b.range, false), most = chosen(type, a.range, b.range, true);
    for (const double x : a.values) {
      if (x != lowest(type)) {
        ASSERT_TRUE(contains(magnitude(type, a.range), std::abs(x))) << x;
      }
      ASSERT_TRUE(contains(signOf(type, a.range), x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0)) << x;
      ASSERT_TRUE(contains(mapped(type, a.range, [](double v) { return std::floor(v); }), std::floor(x))) << x;
      ASSERT_TRUE(contains(joined(a.range, b.range), x));
      if (x >= -3.0 && x <= 7.0) {
        ASSERT_TRUE(contains(limited(a.range, -3.0, 7.0), x));
      }
      for (const double y : b.values) {
        ASSERT_TRUE(contains(least, std::min(x, y)));
        ASSERT_TRUE(contains(most, std::max(x, y)));
        for (const double z : c.values)
          if (y <= z) {
            ASSERT_TRUE(contains(clamped(type, a.range, b.range, c.range), std::clamp(x, y, z)));
          }
      }
    }
  }
}

TEST(ValueRange, ComparisonsDecideOnlyWhatIsCertain) {
  Samples samples;
  for (int round = 0; round < kRounds; ++round) {
    const Type type = integer(32, true);
    const Sample a = samples.next(type), b = samples.next(type);
    const Comparison comparison{static_cast<Relation>(samples.pick(6))};
    const ValueRange result = compared(comparison, a.range, b.range);
    for (const double x : a.values)
      for (const double y : b.values)
        ASSERT_TRUE(contains(result, holds(comparison, x, y) ? 1.0 : 0.0)) << x << ", " << y;
  }
}

// Quotients of a run are a shorter run: of 256 coordinates, 32 tiles of 8.
TEST(ValueRange, RunsOfTilesAreShorter) {
  const Type type = integer(32, false);
  const ValueRange pixels = ValueRange::between(0.0, 1073741823.0, Occurrence::many);
  const auto occurrence = [&](const ValueRange& tiles, double size) {
    return binary(type, Op::OpUMod, tiles, ValueRange::of(size)).occurrence;
  };
  for (const ValueRange& tiles : {binary(type, Op::OpUDiv, pixels, ValueRange::of(8.0)),
                                  bitwise(type, Op::OpShiftRightLogical, pixels, ValueRange::of(3.0))}) {
    EXPECT_EQ(tiles.occurrence, Occurrence::many);
    EXPECT_EQ(tiles.run, 32.0);
    EXPECT_EQ(occurrence(tiles, 32.0), Occurrence::each);
    EXPECT_NE(occurrence(tiles, 33.0), Occurrence::each);
    EXPECT_EQ(bitwise(type, Op::OpBitwiseAnd, tiles, ValueRange::of(31.0)).occurrence, Occurrence::each);
    EXPECT_NE(bitwise(type, Op::OpBitwiseAnd, tiles, ValueRange::of(63.0)).occurrence, Occurrence::each);
    const ValueRange later = binary(type, Op::OpIAdd, tiles, ValueRange::of(1.0));
    EXPECT_EQ(later.run, 32.0);
  }
  EXPECT_EQ(binary(type, Op::OpUDiv, pixels, ValueRange::of(1024.0)).occurrence, Occurrence::unknown);
  const ValueRange signedPixels = ValueRange::between(-8.0, 1000.0, Occurrence::many);
  EXPECT_NE(binary(integer(32, true), Op::OpSDiv, signedPixels, ValueRange::of(2.0)).occurrence, Occurrence::many);
}

TEST(ValueRange, RunsOfPixelsReachOnlySmallRemainders) {
  const Type type = integer(32, false);
  const ValueRange pixels = ValueRange::between(0.0, 1073741823.0, Occurrence::many);
  const ValueRange few = binary(type, Op::OpUMod, pixels, ValueRange::of(8.0));
  EXPECT_EQ(few.max, 7.0);
  EXPECT_EQ(few.occurrence, Occurrence::each);
  EXPECT_NE(binary(type, Op::OpUMod, pixels, ValueRange::of(100000.0)).occurrence, Occurrence::each);
  const ValueRange three = ValueRange::between(0.0, 2.0, Occurrence::many);
  EXPECT_NE(binary(type, Op::OpUMod, three, ValueRange::of(8.0)).occurrence, Occurrence::each);
  EXPECT_NE(bitwise(type, Op::OpBitwiseAnd, three, ValueRange::of(7.0)).occurrence, Occurrence::each);
}

}  // namespace
}  // namespace quintet::spirv
