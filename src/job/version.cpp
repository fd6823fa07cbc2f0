// SPDX-License-Identifier: Apache-2.0
#include "job/version.h"

namespace quintet::job {

const char* quintetVersion() { return QUINTET_VERSION; }

}  // namespace quintet::job
