// SPDX-License-Identifier: Apache-2.0
#include "io/terminal_image.h"

#include <algorithm>
#include <cmath>

namespace quintet::io {
namespace {

// For terminals that do not report the size of their cells. Cells of common fonts are larger, so that the image does not
// cover the text below.
constexpr std::uint32_t kCellWidth = 6;
constexpr std::uint32_t kCellHeight = 12;

}  // namespace

TerminalFit fitToTerminal(std::uint32_t width, std::uint32_t height, const TerminalArea& area,
                          TerminalProtocol protocol) {
  const bool known = area.cellWidth > 0 && area.cellHeight > 0;
  const std::uint32_t cellWidth = known ? area.cellWidth : kCellWidth;
  const std::uint32_t cellHeight = known ? area.cellHeight : kCellHeight;
  const bool blocks = protocol == TerminalProtocol::halfBlocks;
  // Image pixels per cell, and how much wider than high they appear.
  const std::uint32_t perColumn = blocks ? 1 : cellWidth, perRow = blocks ? 2 : cellHeight;
  const double aspect = blocks ? 2.0 * cellWidth / cellHeight : 1.0;
  const double columnPixels = static_cast<double>(std::max(area.columns, 1u)) * perColumn;
  const double rowPixels = static_cast<double>(std::max(area.rows, 1u)) * perRow;
  const double scale = std::min({1.0, columnPixels / width, rowPixels / (height * aspect)});
  TerminalFit fit;
  fit.width = static_cast<std::uint32_t>(std::clamp(std::round(width * scale), 1.0, columnPixels));
  fit.height = static_cast<std::uint32_t>(std::clamp(std::round(height * aspect * scale), 1.0, rowPixels));
  fit.rows = (fit.height + perRow - 1) / perRow;
  return fit;
}

}  // namespace quintet::io
