// SPDX-License-Identifier: Apache-2.0
#include "base/text.h"

#include <gtest/gtest.h>

#include <limits>

namespace quintet {
namespace {

TEST(Text, KeepsValidUtf8) {
  EXPECT_EQ(printable("plain"), "plain");
  EXPECT_EQ(printable("Köln 漢 🙂"), "Köln 漢 🙂");
  EXPECT_EQ(printable(""), "");
}

TEST(Text, ReplacesControlCharactersAndInvalidUtf8) {
  EXPECT_EQ(printable("a\nb\tc\x1B[31m\x7F"), "a?b?c?[31m?");
  EXPECT_EQ(printable("\xC3"), "?");            // truncated sequence
  EXPECT_EQ(printable("\xC0\xAF\xFF"), "???");  // overlong sequence and an invalid byte
  EXPECT_EQ(printable("\xC2\x85"), "??");       // NEXT LINE, a C1 control character
}

TEST(Text, FormatsBytes) {
  EXPECT_EQ(bytesText(0), "0 bytes");
  EXPECT_EQ(bytesText(1), "1 byte");
  EXPECT_EQ(bytesText(1023), "1023 bytes");
  EXPECT_EQ(bytesText(1024), "1.0 KiB");
  EXPECT_EQ(bytesText(3355443), "3.2 MiB");
  EXPECT_EQ(bytesText(std::uint64_t{5} << 30), "5.0 GiB");
  EXPECT_EQ(bytesText(std::numeric_limits<std::uint64_t>::max()), "16.0 EiB");
}

TEST(Text, LowerCase) { EXPECT_EQ(lowerCase("Ab.GLB É"), "ab.glb É"); }

TEST(Text, FormatsDurations) {
  EXPECT_EQ(durationText(-1.0), "0.0 s");
  EXPECT_EQ(durationText(2.46), "2.5 s");
  EXPECT_EQ(durationText(75.0), "75 s");
  EXPECT_EQ(durationText(125.0), "2:05");
  EXPECT_EQ(durationText(3725.0), "1:02:05");
  EXPECT_EQ(durationText(1e9), "?");
  EXPECT_EQ(durationText(std::numeric_limits<double>::quiet_NaN()), "?");
}

}  // namespace
}  // namespace quintet
