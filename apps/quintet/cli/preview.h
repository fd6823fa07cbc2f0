// SPDX-License-Identifier: Apache-2.0
// The preview of a render on the terminal of standard error: which protocol can show an image (--preview), and the position
// of the image above the progress line.
#ifndef QUINTET_CLI_PREVIEW_H
#define QUINTET_CLI_PREVIEW_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/terminal_image.h"

namespace quintet::cli {

// Either a protocol or the reason why there is no preview; neither with "off".
struct PreviewChoice {
  std::optional<io::TerminalProtocol> protocol;
  std::string problem;
};

// Names of --preview: auto, kitty, sixel, blocks, off.
std::vector<std::string> previewNames();

// "auto" is decided by the environment. If that is not enough, the terminal is asked for its attributes, which takes up to a
// second. Throws UsageError for an unknown name, and for a protocol if standard error is not a terminal.
PreviewChoice choosePreview(const std::string& name);

// The image on the screen. Its functions return text for the terminal. The cursor is at the start of the line below the
// image, before and after the text.
class Preview {
 public:
  explicit Preview(io::TerminalProtocol protocol);

  // Replaces the image. The text depends on the current size of the terminal. `image`: sRGB bytes with 3 channels.
  std::string draw(const io::Image& image);
  // Removes the image, if there is one.
  std::string erase();
  // The image stays; the next one is drawn below.
  void keep();

 private:
  const io::TerminalProtocol protocol_;
  const bool trueColor_;
  std::uint32_t id_;  // of the image, for kitty
  bool visible_ = false;
  io::TerminalArea area_;  // for which it was drawn
  io::TerminalFit fit_;
};

}  // namespace quintet::cli
#endif
