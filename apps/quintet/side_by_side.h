// Pictures next to one another, for a person to look at.
#ifndef QUINTET_APP_SIDE_BY_SIDE_H
#define QUINTET_APP_SIDE_BY_SIDE_H

#include "io/image.h"

namespace quintet::app {

// A, B and `difference` (bytes RGB) of one size from left to right; what is transparent shows dark grey.
io::Image sideBySide(const io::Image& a, const io::Image& b, const io::Image& difference);

}  // namespace quintet::app
#endif
