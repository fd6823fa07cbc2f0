// SPDX-License-Identifier: Apache-2.0
// Formats of debugPrintfEXT: the text of every conversion, and errors for formats that do not match their arguments.
#include "spirv/print_format.h"

#include <gmock/gmock.h>

#include <bit>
#include <utility>

#include "base/error.h"

namespace quintet::spirv {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Kind = PrintArgument::Kind;
using Words = std::vector<std::uint32_t>;

const PrintArgument kInt{Kind::integer, true, 32, 1, "int"};
const PrintArgument kUint{Kind::integer, false, 32, 1, "uint"};
const PrintArgument kLong{Kind::integer, true, 64, 1, "int64_t"};
const PrintArgument kUnsignedLong{Kind::integer, false, 64, 1, "uint64_t"};
const PrintArgument kBool{Kind::boolean, false, 32, 1, "bool"};
const PrintArgument kFloat{Kind::floating, false, 32, 1, "float"};
const PrintArgument kDouble{Kind::floating, false, 64, 1, "double"};
const PrintArgument kMatrix{Kind::other, false, 0, 1, "mat3"};

PrintArgument vectorOf(PrintArgument argument, std::uint32_t count, std::string name) {
  argument.count = count;
  argument.typeName = std::move(name);
  return argument;
}
const PrintArgument kVec3 = vectorOf(kFloat, 3, "vec3");

std::uint32_t word(float value) { return std::bit_cast<std::uint32_t>(value); }
Words words(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

std::string textOf(std::string_view format, const PrintArgument& argument, const Words& words) {
  return PrintFormat(format, {argument}).text(words);
}
std::string errorOf(std::string_view format, const std::vector<PrintArgument>& arguments) {
  try {
    const PrintFormat parsed(format, arguments);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(PrintFormat, PrintsIntegers) {
  const std::uint32_t minusFive = static_cast<std::uint32_t>(-5);
  EXPECT_EQ(textOf("%d", kInt, {minusFive}), "-5");
  EXPECT_EQ(textOf("%i", kUint, {minusFive}), "-5");
  EXPECT_EQ(textOf("%u", kInt, {minusFive}), "4294967291");
  EXPECT_EQ(textOf("%x", kUint, {0xBEEFu}), "beef");
  EXPECT_EQ(textOf("%#X", kUint, {0xBEEFu}), "0XBEEF");
  EXPECT_EQ(textOf("%o", kUint, {8u}), "10");
  EXPECT_EQ(textOf("%c", kUint, {'A'}), "A");
  EXPECT_EQ(textOf("%c", kUint, {7u}), "?");
}

TEST(PrintFormat, PrintsBooleansAsNumbers) {
  EXPECT_EQ(textOf("%d", kBool, {1}), "1");
  EXPECT_EQ(textOf("%u", kBool, {0}), "0");
}

TEST(PrintFormat, PrintsFloats) {
  EXPECT_EQ(textOf("%f", kFloat, {word(1.5f)}), "1.500000");
  EXPECT_EQ(textOf("%.3e", kFloat, {word(12345.0f)}), "1.234e+04");
  EXPECT_EQ(textOf("%g", kFloat, {word(0.1f)}), "0.1");
  EXPECT_EQ(textOf("%G", kFloat, {word(1e-10f)}), "1E-10");
  EXPECT_EQ(textOf("%a", kFloat, {word(1.0f)}), "0x1p+0");
  EXPECT_EQ(textOf("%f", kFloat, {0x7FC00000u}), "nan");
  EXPECT_EQ(textOf("%f", kFloat, {0xFF800000u}), "-inf");
  EXPECT_EQ(textOf("%.12f", kDouble, words(0.1)), "0.100000000000");
}

TEST(PrintFormat, PrintsNumbersOf64Bits) {
  const Words minusTwo{0xFFFFFFFEu, 0xFFFFFFFFu};
  EXPECT_EQ(textOf("%ld", kLong, minusTwo), "-2");
  EXPECT_EQ(textOf("%lu", kUnsignedLong, {1u, 2u}), "8589934593");
  EXPECT_EQ(textOf("%ul|", kUnsignedLong, {1u, 2u}), "8589934593|");
  EXPECT_EQ(textOf("%lx", kUnsignedLong, {0x1u, 0xABu}), "ab00000001");
  EXPECT_EQ(textOf("%v2lu", vectorOf(kUnsignedLong, 2, "u64vec2"), {1, 0, 2, 0}), "1, 2");
  EXPECT_EQ(textOf("%ul", kUint, {7}), "7l") << "a letter of the text, because the argument has 32 bits";
}

TEST(PrintFormat, PrintsVectors) {
  const Words components{word(1.0f), word(-2.5f), word(3.25f)};
  EXPECT_EQ(textOf("n = %v3f.", kVec3, components), "n = 1.000000, -2.500000, 3.250000.");
  EXPECT_EQ(textOf("%6.2v3f", kVec3, components), "  1.00,  -2.50,   3.25");
  EXPECT_EQ(textOf("%v2d", vectorOf(kBool, 2, "bvec2"), {1, 0}), "1, 0");
}

TEST(PrintFormat, KeepsTheOrderOfArguments) {
  const PrintFormat format("%d %% %v3f %lu end", {kInt, kVec3, kUnsignedLong});
  EXPECT_EQ(format.wordCount(), 6u);
  EXPECT_EQ(format.text(Words{7, word(1.0f), word(2.0f), word(3.0f), 9, 0}), "7 % 1.000000, 2.000000, 3.000000 9 end");
}

TEST(PrintFormat, HasWidthAndFlags) {
  EXPECT_EQ(textOf("[%5d]", kInt, {42}), "[   42]");
  EXPECT_EQ(textOf("[%-5d]", kInt, {42}), "[42   ]");
  EXPECT_EQ(textOf("[%05d]", kInt, {42}), "[00042]");
  EXPECT_EQ(textOf("[%+d]", kInt, {42}), "[+42]");
}

TEST(PrintFormat, NeedsNoArguments) {
  EXPECT_EQ(PrintFormat("100 %%\n", {}).text({}), "100 %\n");
  EXPECT_EQ(PrintFormat("", {}).text({}), "");
}

TEST(PrintFormat, MissingWordsAreZero) {
  EXPECT_EQ(textOf("%v3f", kVec3, {word(1.0f)}), "1.000000, 0.000000, 0.000000");
}

TEST(PrintFormat, RejectsOtherTypes) {
  EXPECT_EQ(errorOf("%d", {kFloat}),
            "the specifier %d does not match argument 1, which is float; write for example %f");
  EXPECT_THAT(errorOf("%f", {kInt}), AllOf(HasSubstr("int"), HasSubstr("%d")));
  EXPECT_THAT(errorOf("%f", {kVec3}), AllOf(HasSubstr("vec3"), HasSubstr("%v3f")));
  EXPECT_THAT(errorOf("%v2f", {kVec3}), HasSubstr("%v3f"));
  EXPECT_THAT(errorOf("%v3f", {kFloat}), AllOf(HasSubstr("float"), HasSubstr("%f")));
  EXPECT_THAT(errorOf("%u", {kUnsignedLong}), HasSubstr("write for example %lu"));
  EXPECT_THAT(errorOf("%ld", {kInt}), HasSubstr("write for example %d"));
  EXPECT_THAT(errorOf("%d %f", {kInt, kUint}), AllOf(HasSubstr("argument 2"), HasSubstr("uint"), HasSubstr("%u")));
  EXPECT_THAT(errorOf("%f", {kBool}), HasSubstr("write for example %u"));
  EXPECT_THAT(errorOf("%f", {kMatrix}), AllOf(HasSubstr("argument 1"), HasSubstr("mat3")));
}

TEST(PrintFormat, RejectsOtherNumbersOfArguments) {
  EXPECT_THAT(errorOf("%d %d", {kInt}), AllOf(HasSubstr("2 specifiers"), HasSubstr("1 argument")));
  EXPECT_THAT(errorOf("%%", {kInt}), AllOf(HasSubstr("0 specifiers"), HasSubstr("1 argument")));
}

TEST(PrintFormat, RejectsInvalidSpecifiers) {
  EXPECT_THAT(errorOf("%s", {kInt}), HasSubstr("the specifier %s is unknown"));
  EXPECT_THAT(errorOf("%p", {kUint}), HasSubstr("%p is unknown"));
  EXPECT_THAT(errorOf("50 %", {}), AllOf(HasSubstr("%"), HasSubstr("incomplete")));
  EXPECT_THAT(errorOf("%5.2", {kFloat}), HasSubstr("incomplete"));
  EXPECT_THAT(errorOf("%v5f", {kFloat}), HasSubstr("2, 3 or 4"));
  EXPECT_THAT(errorOf("%*d", {kInt}), HasSubstr("width *"));
  EXPECT_THAT(errorOf("%999999999999d", {kInt}), HasSubstr("larger than 100"));
  EXPECT_THAT(errorOf("%.101f", {kFloat}), HasSubstr("larger than 100"));
}

}  // namespace
}  // namespace quintet::spirv
