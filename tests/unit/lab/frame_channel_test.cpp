// SPDX-License-Identifier: Apache-2.0
#include "lab/frame_channel.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "base/error.h"

namespace quintet::lab {
namespace {

TEST(FrameParser, ReturnsMessagesThatArriveInPieces) {
  const std::string bytes = frameBytes(FrameKind::text, "first") +
                            frameBytes(FrameKind::binary, std::string(70000, 'x')) + frameBytes(FrameKind::control, "");
  for (const std::size_t piece : {1u, 3u, 4096u, 100000u}) {
    FrameParser parser;
    std::vector<ChannelFrame> frames;
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      parser.add(std::string_view(bytes).substr(at, piece));
      while (auto frame = parser.next()) frames.push_back(*frame);
    }
    ASSERT_EQ(frames.size(), 3u) << piece;
    EXPECT_EQ(frames[0].data, "first");
    EXPECT_EQ(frames[1].kind, FrameKind::binary);
    EXPECT_EQ(frames[1].data.size(), 70000u);
    EXPECT_EQ(frames[2].kind, FrameKind::control);
    EXPECT_EQ(frames[2].data, "");
  }
}

TEST(FrameParser, RejectsUnknownKindsAndSizes) {
  FrameParser kind;
  kind.add(std::string("\4\0\0\0\0", 5));
  EXPECT_THROW(kind.next(), Error);
  FrameParser size;
  size.add(std::string("\1\0\0\0\x7F", 5));
  EXPECT_THROW(size.next(), Error);
}

}  // namespace
}  // namespace quintet::lab
