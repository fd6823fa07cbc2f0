#include "program/diagnostic_catalog.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "base/embedded.h"

namespace quintet {
std::span<const EmbeddedFile> embeddedExplanations();
}

namespace quintet::program {
namespace {

constexpr auto kError = shader::Severity::error;
constexpr auto kWarning = shader::Severity::warning;
constexpr auto kNote = shader::Severity::note;

constexpr DiagnosticInfo kCatalog[] = {
    // Found while the program runs with --instrument.
    {"Q001", kError, "ray origin or direction is not finite",
     "A NaN or infinity in a ray makes traversal miss everything, or not end, depending on the driver.",
     "Find the division by zero, the normalize of a zero vector or the sqrt of a negative number behind it."},
    {"Q002", kError, "output is not finite",
     "A single NaN or infinity stays in the average of its pixel for ever and spreads with every filter.",
     "Find the operation that makes it, or leave that sample out and count it."},
    {"Q003", kError, "recursion is deeper than the pipeline was linked for",
     "Beyond the declared depth a trace is undefined: the stack is overwritten, or the device is lost.",
     "Stop by a depth in the payload, or raise max_recursion in program.toml."},
    {"Q004", kError, "shader record index is out of range at run time",
     "The device reads a shader handle from foreign memory and jumps to it.",
     "Keep offset, stride and miss index of the trace within the generated constants."},
    {"Q005", kWarning, "hit on the primitive that the ray has just left",
     "The hit is nearer than the rounding error of its origin: the surface shadows or reflects itself in speckles.",
     "Offset the origin off the surface by the error bound (offsetOrigin), or raise tmin."},
    {"Q006", kNote, "any-hit shader invocations per ray",
     "Each invocation interrupts traversal; many of them per ray decide the speed of the program.",
     "Build geometry without alpha as opaque, or trace with gl_RayFlagsOpaqueEXT."},

    // A file of the lecture form.
    {"Q010", kError, "no ray generation shader",
     "Every launch begins with the ray generation shader; without one there is nothing to run.",
     "Mark one main() of the file with /**** RAY GENERATION SHADER ****/."},
    {"Q011", kError, "main() without a stage marker",
     "One file holds several main(); only the marker says which stage each of them is.",
     "Put a comment such as /**** CLOSEST-HIT SHADER ****/ at the beginning of its body."},
    {"Q012", kError, "stage marker names no stage",
     "A marker that is not understood would leave out a shader without a word.",
     "Write RAY GENERATION, CLOSEST-HIT, MISS, INTERSECTION, ANY-HIT or CALLABLE, followed by SHADER."},
    {"Q013", kError, "stage is there twice",
     "A file of the lecture form has one shader of each stage, callable shaders apart; a second one would never run.",
     "Merge the two, or write the program as a folder with several hit groups or miss shaders."},
    {"Q014", kError, "braces do not match",
     "The file cannot be cut into its stages: it is not clear where a main() ends.",
     "Close or remove the brace that the message points at; braces in comments do not count."},
    {"Q015", kError, "uniform cannot become a parameter",
     "Uniforms of the lecture form are the parameters of the program; this one has no type, name or default that fits.",
     "Declare it as uniform TYPE NAME; with float, vec2, vec3, vec4, int, bool or sampler2D and numbers as default."},
    {"Q016", kError, "file is larger than 1 MiB",
     "Nobody writes such a shader by hand; it is more likely another file than a program.",
     "Check the path, or put large parts into files that are included."},

    // Payloads.
    {"Q101", kError, "payload type differs between a trace and a shader that it reaches",
     "Both sides share raw memory: members land on others, and what lies behind the smaller type is overwritten.",
     "Declare the payload struct once, in a file that every stage includes."},
    {"Q102", kNote, "payload location differs between a trace and a shader that it reaches",
     "The location of rayPayloadInEXT is ignored, only that of the trace counts, but readers are misled.",
     "Give both the same location."},
    {"Q103", kWarning, "rayPayloadEXT where rayPayloadInEXT is meant",
     "The stage writes a payload of its own, which nobody reads, instead of the one of the ray that called it.",
     "Declare it rayPayloadInEXT; keep rayPayloadEXT for rays that this stage traces itself."},
    {"Q104", kWarning, "payload member is read after a trace but not written on every path",
     "On that path the member holds whatever was in the registers: other pixels, earlier rays, zeros by luck.",
     "Write the member in that shader, or set it before the trace."},
    {"Q105", kWarning, "nested trace overwrites the incoming payload, which is read afterwards",
     "The inner ray's shaders write the same memory, so what is read afterwards belongs to the inner ray.",
     "Trace with a rayPayloadEXT of its own, or copy what is still needed to locals before the trace."},

    // Hit attributes.
    {"Q201", kError, "hit attribute type differs between the shaders of a hit group",
     "The attributes are raw memory written by the intersection shader; another type reads other bytes.",
     "Declare the attribute with one type in the intersection, any-hit and closest-hit shaders."},
    {"Q202", kError, "hit attribute of a triangle hit group is not vec2",
     "The built-in triangle intersection writes two barycentrics and nothing else.",
     "Declare hitAttributeEXT vec2, and compute everything else from it."},
    {"Q203", kError, "hit attribute is larger than the device allows",
     "Every device has a limit (maxRayHitAttributeSize, 32 bytes on most); beyond it the pipeline is invalid.",
     "Pass only what cannot be computed again from the ray and t, e.g. a face index instead of a normal."},
    {"Q204", kError, "hit attribute in a stage that has no hit",
     "Only intersection, any-hit and closest-hit shaders have a hit; in a miss shader nothing was hit.",
     "Return what is needed through the payload."},

    // Callable shaders.
    {"Q301", kError, "callable data type differs between the call and the callable shader",
     "Both sides share raw memory: members land on others, and what lies behind the smaller type is overwritten.",
     "Declare the struct once, in a file that both stages include."},
    {"Q302", kError, "callable index is beyond the table",
     "The device reads a shader handle from foreign memory and jumps to it.",
     "Use an index below the number of callables in program.toml."},
    {"Q303", kNote, "callable data location differs between the call and the callable shader",
     "The location of callableDataInEXT is ignored, only that of the call counts, but readers are misled.",
     "Give both the same location."},

    // Recursion.
    {"Q401", kError, "cycle of traces without a declared bound",
     "The stack is sized before the launch; a ray that recurses further overwrites memory or loses the device.",
     "Declare max_recursion in program.toml and stop there by a depth in the payload, or loop in ray generation."},
    {"Q402", kError, "recursion is deeper than declared or than the device allows",
     "A trace beyond maxPipelineRayRecursionDepth is undefined.",
     "Trace less deep, raise max_recursion, or turn the recursion into a loop in the ray generation shader."},

    // The shader binding table.
    {"Q501", kError, "hit record is beyond the table for an instance of the scene",
     "The device reads a shader handle from foreign memory and jumps to it.",
     "Use kRay_NAME as offset and kRayTypeCount as stride: they follow program.toml."},
    {"Q502", kError, "miss index is beyond the table",
     "The device reads a shader handle from foreign memory and jumps to it.",
     "Use kMiss_NAME: it follows program.toml."},
    {"Q503", kError, "offset or stride of the hit records is beyond 4 bits",
     "Only the 4 low bits count, so another record than the one meant is used, without a message.",
     "Keep both between 0 and 15."},
    {"Q504", kError, "miss index is beyond 16 bits",
     "Only the 16 low bits count, so another miss shader than the one meant runs, without a message.",
     "Keep it between 0 and 65535."},
    {"Q505", kWarning, "cull mask is beyond 8 bits", "Only the 8 low bits count: a mask of 0x100 sees nothing at all.",
     "Use the bits 0x01 to 0x80; 0xFF sees every instance."},
    {"Q506", kWarning, "shadow ray uses a miss shader that is meant for radiance",
     "With closest-hit skipped the miss shader is the only answer, and this one writes a colour, not visibility.",
     "Add a ray type with a miss shader of its own, and pass its kMiss_NAME."},

    // Hit groups and geometry.
    {"Q601", kError, "boxes are served by a hit group without intersection shader",
     "A box is no surface: without an intersection shader no ray can hit it, and the record is invalid.",
     "Add an intersection shader to the group, or bind boxes to another group."},
    {"Q602", kError, "triangles are served by a hit group with intersection shader",
     "The device intersects triangles itself; a procedural group's record for them is undefined.",
     "Bind the group to boxes (geometry = \"procedural\"), and add a group without it for triangles."},
    {"Q603", kWarning, "any-hit shader can never run",
     "Everything that it could meet is opaque, by geometry, instance or ray flags, so the device never calls it.",
     "Drop the shader, or the opaque flag that keeps it away."},
    {"Q604", kWarning, "alpha test of a material never runs",
     "The surface looks solid: the ray is opaque, or no any-hit shader tests the material.",
     "Give the hit group that serves class alpha an any_hit for this ray type, and trace without the opaque flag."},
    {"Q605", kError, "ray flags contradict each other",
     "Vulkan forbids the combination; what a driver does with it is undefined.",
     "Keep one of them: opaque or no-opaque, cull front or back, skip triangles or boxes, cull opaque or not opaque."},

    // Shading mistakes.
    {"Q701", kError, "normalized object-space direction is used for t",
     "t is measured in lengths of the ray direction, so a scaled instance gets wrong distances and order of hits.",
     "Intersect with gl_ObjectRayDirectionEXT as it is, or divide the t of the unit direction by its length."},
    {"Q702", kWarning, "normal is transformed by gl_ObjectToWorldEXT",
     "Under non-uniform scale the result is not perpendicular to the surface; shading tilts.",
     "Multiply from the left with world-to-object: normalize(vec3(normal * gl_WorldToObjectEXT))."},
    {"Q703", kWarning, "gl_InstanceID is used where the custom index is meant",
     "gl_InstanceID is the place in the built list, which Quintet may sort; another device gives another order.",
     "Use gl_InstanceCustomIndexEXT, the position in the scene, or instanceCustomIndex(), the number that the scene "
     "gives."},
    {"Q704", kError, "descriptor is indexed by a hit-dependent value without nonuniformEXT",
     "The driver may take the index of one invocation for all of its group: wrong textures in blocks.",
     "Wrap the index: textures[nonuniformEXT(index)]."},
    {"Q705", kWarning, "ray starts on a surface with tmin 0",
     "The rounding error of the origin puts it below the surface for half of the rays: acne.",
     "Offset the origin (offsetOrigin of <quintet/surface.glsl>), or give a tmin beyond the error."},
    {"Q706", kError, "built-in does not exist in this stage",
     "The value does not exist there, e.g. there is no hit in a miss shader.",
     "Pass it on through the payload from a stage that has it."},

    // Parts that do nothing.
    {"Q801", kWarning, "stage is reached by nobody", "It costs compile time and suggests that it does something.",
     "Trace or call it, or remove it from program.toml."},
    {"Q802", kWarning, "hit group serves no geometry of the scene",
     "Its binding fits nothing here: a name is misspelt, or the scene is another.",
     "Compare geometry, material and primitives of the group with `quintet info SCENE`."},

    // Drivers with defects (docs/design/quirks.md).
    {"Q901", kWarning, "built-in is read after a nested trace",
     "Some drivers give the value of the inner hit there (lavapipe).",
     "Copy the built-in to a local before the trace."},
    {"Q902", kWarning, "hit attribute is written although the report may be rejected",
     "Some drivers do not tie the attributes to the accepted hit, so a rejected candidate overwrites them (lavapipe).",
     "Write them only if gl_RayTminEXT <= t and t < gl_RayTmaxEXT, or compute them again in closest-hit."},
    {"Q903", kNote, "intersection shader is shared by hit groups with different any-hit shaders",
     "Some drivers run the first group's any-hit shader for both (lavapipe).",
     "Nothing to do: Quintet gives each group a copy of the stage."},
    {"Q904", kWarning, "gl_RayTmaxEXT is read after a report of the same invocation",
     "It may have the value from before (by the optimizer, and on lavapipe), so a farther hit replaces a nearer one.",
     "Keep the nearest accepted t in a local."},
    {"Q905", kWarning, "dynamically indexed local array in an intersection shader that has an any-hit shader",
     "Some drivers let the two stages share that storage (lavapipe): the any-hit shader overwrites the array.",
     "Keep the values in scalars, or do the any-hit test in the intersection shader."},
};

std::string upper(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return result;
}

}  // namespace

std::span<const DiagnosticInfo> allDiagnostics() { return kCatalog; }

const DiagnosticInfo* findDiagnostic(std::string_view id) {
  const std::string wanted = upper(id);
  const auto* found = std::ranges::lower_bound(kCatalog, std::string_view(wanted), {}, &DiagnosticInfo::id);
  return found != std::end(kCatalog) && found->id == wanted ? found : nullptr;
}

std::string_view explanation(std::string_view id) {
  if (findDiagnostic(id) == nullptr) return {};
  const std::string wanted = upper(id) + ".md";
  for (const EmbeddedFile& page : embeddedExplanations())
    if (page.path == wanted) return page.data;
  return {};
}

}  // namespace quintet::program
