// SPDX-License-Identifier: Apache-2.0
// Metadata of a glTF file (KHR_xmp_json_ld): XMP packets in JSON-LD, and the objects that refer to them.
#ifndef QUINTET_SCENE_GLTF_METADATA_H
#define QUINTET_SCENE_GLTF_METADATA_H

#include <nlohmann/json.hpp>
#include <vector>

#include "scene/model/report.h"

namespace quintet::scene {

// The properties of all packets, in their order; those of unused packets, too. `checked`: from checkSchema().
std::vector<MetadataEntry> readMetadata(const nlohmann::json& checked);

}  // namespace quintet::scene
#endif
