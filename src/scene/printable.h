// Text from a file, made safe for one line of a terminal or a log.
#ifndef QUINTET_SCENE_PRINTABLE_H
#define QUINTET_SCENE_PRINTABLE_H

#include <string>
#include <string_view>

namespace quintet::scene {

// Control characters and bytes that are not part of valid UTF-8 become '?'.
std::string printable(std::string_view text);

}  // namespace quintet::scene
#endif
