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
void addCryptomatte(io::ExrPicture& picture, const std::string& output, const render::Film& film,
                    const render::FilmPlane& plane, const CoverageNames& names);

}  // namespace quintet::app
#endif
