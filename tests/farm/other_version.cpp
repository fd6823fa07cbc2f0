// SPDX-License-Identifier: Apache-2.0
// The version of a node that was not updated.
#include "job/version.h"

namespace quintet::job {

const char* quintetVersion() { return "0.0.9"; }

}  // namespace quintet::job
