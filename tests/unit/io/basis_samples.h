// SPDX-License-Identifier: Apache-2.0
// Small KTX2 files that an encoder of Basis Universal wrote.
#ifndef QUINTET_TESTS_IO_BASIS_SAMPLES_H
#define QUINTET_TESTS_IO_BASIS_SAMPLES_H

#include "io/samples.h"

namespace quintet::io::test {

Bytes etc1sFile();       // 30 x 22, with mip levels
Bytes etc1sAlphaFile();  // 17 x 40, with an alpha slice
Bytes uastcFile();       // 21 x 13, with alpha and Zstandard

}  // namespace quintet::io::test
#endif
