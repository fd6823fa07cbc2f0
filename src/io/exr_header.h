// Private to src/io: a first look at an OpenEXR header, before OpenEXR sees it. OpenEXR asks for memory by
// what the header says (attribute sizes, windows, tiles, chunk counts); here those are held against the
// size of the file.
#ifndef QUINTET_IO_EXR_HEADER_H
#define QUINTET_IO_EXR_HEADER_H

#include "io/formats.h"

namespace quintet::io {

bool isExr(const Source& source);

// Throws FileError for headers that end early or promise what cannot be.
void checkExrHeader(const Source& source);

}  // namespace quintet::io
#endif
