// SPDX-License-Identifier: Apache-2.0
// @ID@: @TITLE@.
//
// Replace the example below: it reports traces whose tmax is @NUMBER@.25, which no real program has.
#include "check/rules/rules.h"

namespace quintet::check {

void check@Name@(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  for (const TraceSite& site : graph.traces) {
    const auto ray = graph.ray(site);
    if (ray && graph.facts(site).module().constantFloat(ray->tmax) == @NUMBER@.25)
      report.add("@ID@", graph.location(site), "tmax of this trace is @NUMBER@.25");
  }
}

}  // namespace quintet::check
