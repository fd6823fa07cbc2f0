// SPDX-License-Identifier: Apache-2.0
// The version of Quintet, which films, plans and messages state. Renders of different versions do not belong together.
#ifndef QUINTET_JOB_VERSION_H
#define QUINTET_JOB_VERSION_H

namespace quintet::job {

const char* quintetVersion();  // "0.1.0"

}  // namespace quintet::job
#endif
