// SPDX-License-Identifier: Apache-2.0
// Private to src/io: converts attributes of an OpenEXR header to our types and to text.
#ifndef QUINTET_IO_EXR_ATTRIBUTES_H
#define QUINTET_IO_EXR_ATTRIBUTES_H

#include <ImfHeader.h>

#include <vector>

#include "io/exr/exr.h"

namespace quintet::io {

// Throw UsageError for a duplicate name, a name that OpenEXR itself uses, or a name that a header cannot store.
void addMetadata(Imf::Header& header, const Metadata& metadata);
void addAttributes(Imf::Header& header, const std::vector<ExrAttribute>& attributes);

// Returns the string attributes in alphabetical order, without those that OpenEXR itself uses.
Metadata readStrings(const Imf::Header& header);
// Returns the other attributes whose type ExrValue supports.
std::vector<ExrAttribute> readAttributes(const Imf::Header& header);

// Returns the attributes beyond those of every file as text; the text of unsupported types is empty.
std::vector<ExrPartInfo::Attribute> describeAttributes(const Imf::Header& header);

}  // namespace quintet::io
#endif
