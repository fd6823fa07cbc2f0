// SPDX-License-Identifier: Apache-2.0
// The exception of work that its caller canceled.
#ifndef QUINTET_CANCELLATION_H
#define QUINTET_CANCELLATION_H

#include <quintet/error.h>

namespace quintet {

// The caller canceled the work: LoadOptions::canceled, Settings::canceled.
class CanceledError : public Error {
 public:
  using Error::Error;
};

}  // namespace quintet
#endif
