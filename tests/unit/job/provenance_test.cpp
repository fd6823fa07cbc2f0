// SPDX-License-Identifier: Apache-2.0
// The one table of facts: every field survives a film, and reaches the metadata under its key.
#include "job/provenance.h"

#include <gmock/gmock.h>

#include <set>

#include "base/error.h"
#include "job/films.h"

namespace quintet::job {
namespace {

using Role = ProvenanceField::Role;
using testing::Contains;
using testing::Not;
using testing::Pair;

TEST(Provenance, FilmsKeepEveryIdentityAndNote) {
  Provenance p = test::makeProvenance();
  for (const bool flag : {false, true}) {
    p.adaptive = p.transparent = p.allOutputs = flag;
    const Provenance read = fromFacts(toFacts(p, Role::identity), toFacts(p, Role::note));
    EXPECT_EQ(read.parameterValues, p.parameterValues);
    for (const ProvenanceField& field : provenanceFields()) {
      if (field.role != Role::result) {
        EXPECT_EQ(field.get(read), field.get(p)) << field.name;
      }
    }
  }
}

TEST(Provenance, AbsentFactsStayAbsent) {
  Provenance p;
  p.size = {1, 1};
  p.region = {0, 0, 1, 1};
  const Provenance read = fromFacts(toFacts(p, Role::identity), toFacts(p, Role::note));
  for (const ProvenanceField& field : provenanceFields()) {
    if (field.role != Role::result) {
      EXPECT_EQ(field.get(read), field.get(p)) << field.name;
    }
  }
}

// Films of renders without a shutter are the same as before there were shutters.
TEST(Provenance, FilmsHaveNoShutterWithoutMotionBlur) {
  Provenance p = test::makeProvenance();
  EXPECT_EQ(*render::findFact(toFacts(p, Role::identity), "shutter"), "-0.25,0.25");
  p.shutter.clear();
  EXPECT_EQ(render::findFact(toFacts(p, Role::identity), "shutter"), nullptr);
  EXPECT_THAT(metadataOf(p), Not(Contains(Pair("Shutter", testing::_))));
}

TEST(Provenance, NamesAndKeysAreUnique) {
  std::set<std::string_view> names[2], json, metadata;
  for (const ProvenanceField& field : provenanceFields()) {
    if (field.role != Role::result) {
      EXPECT_TRUE(names[field.role == Role::note].insert(field.name).second) << field.name;
    }
    if (!field.jsonKey.empty()) {
      EXPECT_TRUE(json.insert(field.jsonKey).second) << field.jsonKey;
    }
    if (!field.metadataKey.empty()) {
      EXPECT_TRUE(metadata.insert(field.metadataKey).second) << field.metadataKey;
    }
  }
}

TEST(Provenance, WrongValuesAreNamed) {
  const Provenance p = test::makeProvenance();
  for (const auto& [name, value] : {std::pair{"size", "8x"},
                                    {"size", "0x6"},
                                    {"seed", "-1"},
                                    {"region", "1,2,3"},
                                    {"region", "5,0,4,3"},
                                    {"transparent", "true"},
                                    {"planned samples", "many"}}) {
    render::FilmFacts identity = toFacts(p, Role::identity);
    for (auto& [known, text] : identity)
      if (known == name) text = value;
    try {
      fromFacts(identity, toFacts(p, Role::note));
      ADD_FAILURE() << name << " = " << value;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith(name)) << value;
    }
  }
}

TEST(Provenance, MetadataOmitsWhatIsAbsent) {
  Provenance p = test::makeProvenance();
  p.samples = 16;
  p.interrupted = true;
  io::Metadata metadata = metadataOf(p);
  EXPECT_THAT(metadata, Contains(Pair("Software", "quintet 1.2.3")));
  EXPECT_THAT(metadata, Contains(Pair("Seed", "4000000000")));
  EXPECT_THAT(metadata, Contains(Pair("Size", "8x6")));
  EXPECT_THAT(metadata, Contains(Pair("Region", "2,1,4,3")));
  EXPECT_THAT(metadata, Contains(Pair("Interrupted", "yes")));
  EXPECT_THAT(metadata, Contains(Pair("TargetError", "0.02")));
  p.interrupted = false;
  p.targetError.reset();
  p.toneMap.clear();
  metadata = metadataOf(p);
  for (const char* key : {"Interrupted", "TargetError", "ToneMap", "Frame", "Error"})
    EXPECT_THAT(metadata, Not(Contains(Pair(key, testing::_)))) << key;
}

}  // namespace
}  // namespace quintet::job
