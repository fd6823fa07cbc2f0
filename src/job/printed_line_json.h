// SPDX-License-Identifier: Apache-2.0
// A line that a program printed, as JSON: in the report of a render and in the events of a session.
#ifndef QUINTET_JOB_PRINTED_LINE_JSON_H
#define QUINTET_JOB_PRINTED_LINE_JSON_H

#include <nlohmann/json_fwd.hpp>

#include "job/observer.h"

namespace quintet::job {

// {"pixel":[3,4],"sample":0,"stage":"a.rchit","file":"a.rchit","line":12,"text":"t = 1"}
nlohmann::ordered_json printedLineJson(const PrintedLine& line);

}  // namespace quintet::job
#endif
