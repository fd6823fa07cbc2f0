// Private to src/io: attributes of an OpenEXR header in our types, and as text.
#ifndef QUINTET_IO_EXR_ATTRIBUTES_H
#define QUINTET_IO_EXR_ATTRIBUTES_H

#include <ImfHeader.h>

#include "io/exr.h"

namespace quintet::io {

// Throw UsageError for a name that is given twice, that OpenEXR itself uses, or that no header can hold.
void addMetadata(Imf::Header& header, const Metadata& metadata);
void addAttributes(Imf::Header& header, const std::vector<ExrAttribute>& attributes);

// String attributes, in alphabetical order as OpenEXR keeps them; without those that OpenEXR itself uses.
Metadata readStrings(const Imf::Header& header);
// The others, of types that ExrValue has.
std::vector<ExrAttribute> readAttributes(const Imf::Header& header);

// All but those that every file has, one line of text each; types that are not known: how many bytes.
std::vector<ExrPartInfo::Attribute> describeAttributes(const Imf::Header& header);

}  // namespace quintet::io
#endif
