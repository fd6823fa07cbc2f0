// SPDX-License-Identifier: Apache-2.0
// Images as text for terminals: the graphics protocol of kitty, sixel, and colored half blocks. Every encoder takes sRGB
// bytes with 3 channels and draws from the cursor on, at the start of a line. It is deterministic.
#ifndef QUINTET_IO_TERMINAL_IMAGE_H
#define QUINTET_IO_TERMINAL_IMAGE_H

#include <cstdint>
#include <string>

#include "io/image.h"

namespace quintet::io {

enum class TerminalProtocol { kitty, sixel, halfBlocks };

// Space for an image.
struct TerminalArea {
  std::uint32_t columns = 80;
  std::uint32_t rows = 24;
  // Pixels of a character cell; 0 if the terminal does not report them.
  std::uint32_t cellWidth = 0;
  std::uint32_t cellHeight = 0;

  bool operator==(const TerminalArea&) const = default;
};

struct TerminalFit {
  std::uint32_t width = 0;  // of the image to encode, pixels
  std::uint32_t height = 0;
  std::uint32_t rows = 0;  // of the terminal, that the image covers
};

// The largest size of a width x height image that fits into the area, at most its own: with its aspect ratio, at least one
// pixel.
TerminalFit fitToTerminal(std::uint32_t width, std::uint32_t height, const TerminalArea& area,
                          TerminalProtocol protocol);

// RGB in base64, in chunks of at most 4096 bytes (https://sw.kovidgoyal.net/kitty/graphics-protocol/). The cursor does not
// move, and the terminal does not answer. An image that already has this id disappears. `id`: not 0.
std::string encodeKitty(const Image& image, std::uint32_t id);
// Removes the image from the terminal.
std::string deleteKitty(std::uint32_t id);

// At most 256 colors by median cut, with dithering (Floyd and Steinberg 1976). Afterwards the cursor is where it was.
std::string encodeSixel(const Image& image);

// Two pixels in each character: U+2580, whose foreground color is the upper pixel. Each row ends with a line break. Without
// `trueColor`, the colors are those of the xterm palette from 16 on.
std::string encodeHalfBlocks(const Image& image, bool trueColor);

}  // namespace quintet::io
#endif
