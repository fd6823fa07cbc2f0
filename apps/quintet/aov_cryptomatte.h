// From the ids that the film counts to Cryptomatte's ranks.
#ifndef QUINTET_APP_AOV_CRYPTOMATTE_H
#define QUINTET_APP_AOV_CRYPTOMATTE_H

#include <cstddef>
#include <string>

#include "aov.h"

namespace quintet::app {

inline constexpr std::size_t kCryptomatteLayers = 3;  // six ranks, as the specification suggests

// "cryptomatte_object": "CryptoObject".
std::string cryptomatteType(const std::string& output);

// Three layers of four channels, and the attributes with the manifest.
void addCryptomatte(io::ExrPicture& picture, const AovLayer& layer, const AovSource& source,
                    const CoverageNames& names);

}  // namespace quintet::app
#endif
