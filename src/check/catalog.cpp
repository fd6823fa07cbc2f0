// SPDX-License-Identifier: Apache-2.0
#include "check/catalog.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "base/embedded.h"

namespace quintet {
std::span<const EmbeddedFile> embeddedExplanations();
}

namespace quintet::check {
namespace {

constexpr auto kError = Severity::error;
constexpr auto kWarning = Severity::warning;
constexpr auto kNote = Severity::note;
constexpr bool kOfScene = true;

constexpr DiagnosticInfo kCatalog[] = {
    // Found by an instrumented run (--instrument).
    {"Q001", kError, "render/renderer/instrument", "ray is invalid",
     "Traversal of a ray with NaN, infinity, direction 0 or an empty interval misses everything or does not terminate, "
     "depending on the driver.",
     "Find its cause: a division by zero, normalize of a zero vector, sqrt of a negative number, or tmin and tmax in "
     "the "
     "wrong order.",
     "nan infinity zero interval direction normalize"},
    {"Q002", kError, "render/renderer/instrument", "output is not finite",
     "One NaN or infinity makes the average of its pixel invalid, and every filter spreads it to other pixels.",
     "Find the operation that produces it, or discard the sample and count it.", "nan infinity fireflies black"},
    {"Q003", kError, "render/renderer/instrument", "recursion is deeper than the pipeline allows",
     "A trace beyond the declared depth is undefined: it overwrites the stack, or the device is lost.",
     "Limit the depth with a counter in the payload, or increase max_recursion in program.toml.", "depth stack"},
    {"Q004", kError, "render/renderer/instrument", "shader record index is out of range at run time",
     "The device reads a shader handle outside of the table and jumps to it.",
     "Keep offset, stride and miss index of the trace within the generated constants.",
     "sbt binding table offset stride miss hit callable"},
    {"Q005", kWarning, "render/renderer/instrument", "ray hits the primitive that it starts on",
     "The hit is closer than the rounding error of the origin: the surface shadows or reflects itself, which shows as "
     "dots.",
     "Offset the origin from the surface by the error bound (offsetOrigin), or increase tmin.",
     "acne shadow origin offset tmin"},
    {"Q006", kNote, "render/renderer/instrument", "number of any-hit shader invocations per ray",
     "Each invocation interrupts traversal; many of them per ray limit the speed of the program.",
     "Build geometry without alpha as opaque, or trace with gl_RayFlagsOpaqueEXT.", "alpha opaque speed performance"},
    {"Q007", kError, "render/renderer/instrument", "output is written outside of the image",
     "The value is discarded: the pixel for which it was meant keeps its old value.",
     "Compute the pixel with launchPixel() of <quintet/output.glsl>.", "pixel store"},

    // Files of the lecture form.
    {"Q010", kError, "program/lecture/split", "ray generation shader is missing",
     "Every launch starts with the ray generation shader.",
     "Mark one main() of the file with /**** RAY GENERATION SHADER ****/.", "raygen marker main"},
    {"Q011", kError, "program/lecture/split", "main() without a stage marker",
     "A file contains several main() functions, and only the marker assigns a stage to each of them.",
     "Start its body with a comment such as /**** CLOSEST-HIT SHADER ****/."},
    {"Q012", kError, "program/lecture/split", "stage marker names an unknown stage",
     "Without this error, the shader would be skipped silently.",
     "Write RAY GENERATION, CLOSEST-HIT, MISS, INTERSECTION, ANY-HIT or CALLABLE, followed by SHADER."},
    {"Q013", kError, "program/lecture/split", "stage is defined twice",
     "A file of the lecture form has one shader per stage, except for callable shaders; a second one would never run.",
     "Merge the two, or write the program as a folder with several hit groups or miss shaders.", "duplicate shader"},
    {"Q014", kError, "program/lecture/split", "braces do not match",
     "The end of a main() is unknown, so the file cannot be split into its stages.",
     "Close or remove the brace at the reported location; braces in comments are ignored.", "brackets"},
    {"Q015", kError, "program/lecture/uniforms", "uniform cannot become a parameter",
     "Uniforms of the lecture form are parameters of the program; the type, name or default of this one is not "
     "supported.",
     "Declare it as uniform TYPE NAME; with float, vec2, vec3, vec4, int, uint, bool or sampler2D and numbers as "
     "default.",
     "type default range"},
    {"Q016", kError, "program/lecture/lecture", "file is larger than 1 MiB",
     "Handwritten shaders are much smaller, so the path is probably wrong.",
     "Check the path, or move large parts to included files."},

    // Payloads.
    {"Q101", kError, "across_stages/payload_types", "payload type differs between a trace and a shader that it reaches",
     "Both stages share raw memory: members are read from wrong offsets, and the larger type overwrites other memory.",
     "Declare the payload struct once, in a file that all stages include.", "struct"},
    {"Q102", kNote, "across_stages/payload_types",
     "payload location differs between a trace and a shader that it reaches",
     "Only the location of the trace counts; a different location of rayPayloadInEXT is ignored but misleads readers.",
     "Use the same location for both."},
    {"Q103", kWarning, "across_stages/payload_types", "rayPayloadEXT instead of rayPayloadInEXT",
     "The stage writes its own outgoing payload, which no other stage reads, instead of that of the incoming ray.",
     "Declare it as rayPayloadInEXT; use rayPayloadEXT only for rays that the stage traces.",
     "payload incoming outgoing"},
    {"Q104", kWarning, "across_stages/payload_members",
     "payload member is read after a trace but not written on every path",
     "On that path the value is undefined: often that of a different pixel or an earlier ray, or zero by accident.",
     "Write the member in that shader, or set it before the trace.", "undefined uninitialized initialization"},
    {"Q105", kWarning, "across_stages/payload_members",
     "nested trace overwrites the incoming payload, which is read afterwards",
     "The shaders of the inner ray write the same memory, so the value read afterwards belongs to the inner ray.",
     "Trace with a separate rayPayloadEXT, or copy the values to local variables before the trace."},
    {"Q106", kError, "across_stages/payload_types", "stage has two incoming payloads or callable data variables",
     "Vulkan allows one per stage: the two share memory on one driver, and the pipeline fails on another.",
     "Declare one rayPayloadInEXT (or callableDataInEXT) whose struct has all members."},
    {"Q107", kWarning, "across_stages/payload_inputs", "payload member is read before anything has set it",
     "A payload is not cleared: the value is undefined, often that of a different pixel, or zero by accident.",
     "Set the member in the tracing stage before the trace.", "undefined uninitialized initialization"},

    // Hit attributes.
    {"Q201", kError, "across_stages/hit_attributes", "hit attribute type differs between the shaders of a hit group",
     "The attributes are raw memory that the intersection shader writes; a different type reads different bytes.",
     "Declare the attribute with the same type in the intersection, any-hit and closest-hit shaders.",
     "hitAttributeEXT"},
    {"Q202", kError, "across_stages/hit_attributes", "hit attribute of a triangle hit group is not vec2",
     "The built-in triangle intersection writes two barycentric coordinates and nothing else.",
     "Declare hitAttributeEXT vec2, and compute everything else from it.", "hitAttributeEXT barycentrics"},
    {"Q203", kError, "across_stages/hit_attributes", "hit attribute is larger than the device allows",
     "Devices limit the size (maxRayHitAttributeSize, 32 bytes on most); a larger attribute makes the pipeline "
     "invalid.",
     "Pass only values that cannot be recomputed from the ray and t, such as a face index instead of a normal.",
     "hitAttributeEXT limit"},
    {"Q204", kError, "shader/stage_builtins", "hit attribute in a stage without a hit",
     "Only intersection, any-hit and closest-hit shaders have a hit; a miss shader has none.",
     "Pass the values through the payload.", "miss"},
    {"Q205", kWarning, "across_stages/hit_attributes", "hit attribute is read but not written before the report",
     "reportIntersectionEXT passes on the attributes that were written before it; all others are undefined.",
     "Write the attribute in the intersection shader before reportIntersectionEXT.",
     "hitAttributeEXT reportIntersectionEXT undefined uninitialized initialization"},
    {"Q206", kWarning, "across_stages/candidates", "intersection shader never reports an intersection",
     "Without a call of reportIntersectionEXT, no ray can hit the geometry, which is invisible.",
     "Call reportIntersectionEXT(t, kind), and check the conditions around it.", "reportIntersectionEXT invisible"},

    // Callable shaders.
    {"Q301", kError, "across_stages/payload_types",
     "callable data type differs between the call and the callable shader",
     "Both stages share raw memory: members are read from wrong offsets, and the larger type overwrites other memory.",
     "Declare the struct once, in a file that both stages include.", "struct"},
    {"Q302", kError, "across_stages/arguments", "callable index is out of range",
     "The device reads a shader handle outside of the table and jumps to it.",
     "Use an index below the number of callable shaders.", "sbt shader binding table program.toml", kOfScene},
    {"Q303", kNote, "across_stages/payload_types",
     "callable data location differs between the call and the callable shader",
     "Only the location of the call counts; a different location of callableDataInEXT is ignored but misleads readers.",
     "Use the same location for both."},
    {"Q304", kWarning, "across_stages/callable_data", "callable data is read but not written",
     "Callable data is not cleared: the value is undefined, often that of an earlier call.",
     "Set what the callable shader reads before the call, and write the result in it on each path.",
     "undefined uninitialized initialization"},

    // Recursion.
    {"Q401", kError, "across_stages/recursion", "cycle of traces without a declared bound",
     "The stack size is fixed before the launch; a ray that recurses further overwrites memory, or the device is lost.",
     "Declare max_recursion in program.toml and stop there with a counter in the payload, or loop in ray generation.",
     "recursion max_recursion depth stack"},
    {"Q402", kError, "across_stages/recursion", "recursion is deeper than declared or than the device allows",
     "A trace beyond maxPipelineRayRecursionDepth is undefined.",
     "Reduce the depth, increase max_recursion (maxPipelineRayRecursionDepth), or replace the recursion by a loop in "
     "the ray generation shader.",
     "max_recursion depth stack"},
    {"Q403", kError, "across_stages/endless_recursion", "trace that always runs closes a cycle",
     "max_recursion is a promise of the program; a ray that recurses further overwrites memory, or the device is lost.",
     "Trace only while a depth in the payload is below the declared depth (max_recursion).",
     "recursion max_recursion endless infinite loop"},

    // The shader binding table.
    {"Q501", kError, "across_stages/arguments", "hit record is out of range for an instance of the scene",
     "The device reads a shader handle outside of the table and jumps to it.",
     "Use kRay_NAME as offset and kRayTypeCount as stride, which are generated from program.toml.",
     "sbt shader binding table offset stride", kOfScene},
    {"Q502", kError, "across_stages/arguments", "miss index is out of range",
     "The device reads a shader handle outside of the table and jumps to it.",
     "Use an index of the miss records: kMiss_NAME in programs of Quintet.", "sbt shader binding table"},
    {"Q503", kError, "across_stages/arguments", "offset or stride of the hit records exceeds 4 bits",
     "The device uses only the low 4 bits, so a different record is selected silently.", "Keep both between 0 and 15.",
     "sbt shader binding table"},
    {"Q504", kError, "across_stages/arguments", "miss index exceeds 16 bits",
     "The device uses only the low 16 bits, so a different miss shader runs silently.", "Keep it between 0 and 65535.",
     "sbt shader binding table"},
    {"Q505", kWarning, "across_stages/arguments", "cull mask exceeds 8 bits",
     "The device uses only the low 8 bits: with a mask of 0x100 the ray hits nothing.",
     "Use the bits 0x01 to 0x80; 0xFF includes all instances."},
    {"Q506", kWarning, "across_stages/arguments", "shadow ray uses the miss shader of radiance rays",
     "With closest-hit shaders skipped, only the miss shader returns a result, and this one writes a color, not "
     "visibility.",
     "Pass the index of a miss shader that returns visibility: kMiss_NAME of a ray type of its own.", ""},
    {"Q507",
     kWarning,
     "across_stages/ray_arguments",
     "cull mask excludes all instances",
     "A ray hits an instance only if the masks of both have a common bit, so this ray always misses.",
     "Use 0xFF for all instances, or set `mask` of the instances in the scene.",
     {},
     kOfScene},
    {"Q508", kError, "across_stages/ray_arguments", "arguments of a trace are swapped",
     "The arguments have the same types, so the compiler accepts them in any order.",
     "Use the order of traceRayEXT: structure, flags, mask, offset, stride, miss index, origin, tmin, direction, tmax, "
     "payload.",
     "traceRayEXT order parameters"},
    {"Q509", kError, "across_stages/ray_arguments", "ray interval is empty or invalid",
     "Vulkan requires 0 <= tmin <= tmax; a ray with an empty interval hits nothing.",
     "Pass a small tmin and a larger tmax, such as 0.001 and kInfinity.", "nan tmin tmax"},
    {"Q510", kError, "across_stages/ray_arguments", "ray direction is the zero vector",
     "The ray has no direction: its hits are undefined, and traversal may not terminate.",
     "Pass the direction of the ray, of any length but 0.", "nan normalize"},
    {"Q511", kError, "across_stages/ray_arguments", "stride is 0 although geometries need different hit groups",
     "With a stride of 0, all geometries of an instance use the hit records of its first geometry.",
     "Use kRayTypeCount as stride.", "sbt shader binding table record", kOfScene},
    {"Q512", kWarning, "across_stages/ray_arguments", "ray that ends at any hit is shaded as the closest hit",
     "With gl_RayFlagsTerminateOnFirstHitEXT, the closest-hit shader runs for the first hit that the device finds, in "
     "an "
     "arbitrary order.",
     "Remove the flag, or read only whether there is a hit.", "gl_RayFlagsTerminateOnFirstHitEXT shadow"},
    {"Q513",
     kWarning,
     "across_stages/ray_arguments",
     "ray flags leave no geometry to hit",
     "The flags skip all geometry that exists, so this ray always misses.",
     "Remove the flag, or add geometry of the other kind.",
     {},
     kOfScene},
    {"Q514", kWarning, "within_stage/ray_lengths", "ray direction is not normalized although tmax is its length",
     "The unit of t is the length of the direction, so the ray ends at the square of the length.",
     "Normalize the direction, or use a tmax of 1 with the direction as it is.", "normalize"},
    {"Q515", kError, "across_stages/hit_records", "hit record is beyond the hit table",
     "The device reads a shader handle behind the table and jumps to it.",
     "Check the record offset of the instance, the offset and the stride of the trace, and the number of hit records.",
     "sbt shader binding instanceShaderBindingTableRecordOffset", kOfScene},

    // Hit groups and geometry.
    {"Q601", kError, "across_stages/geometry", "procedural geometry uses a hit group without an intersection shader",
     "Without an intersection shader no ray can hit a bounding box, and the hit record is invalid.",
     "Add an intersection shader to the group, or bind the procedural geometry to a different group.", "box aabb",
     kOfScene},
    {"Q602",
     kError,
     "across_stages/geometry",
     "triangles use a hit group with an intersection shader",
     "The device intersects triangles itself; the use of a procedural hit group for them is undefined.",
     "Bind the group to procedural geometry (geometry = \"procedural\"), and add a group without the shader for "
     "triangles.",
     {},
     kOfScene},
    {"Q603", kWarning, "across_stages/geometry", "any-hit shader can never run",
     "All its geometry is opaque, because of the geometry, the instance or the ray flags, so the device never calls "
     "it.",
     "Remove the shader, or the opaque flag that prevents it.", "opaque", kOfScene},
    {"Q604", kWarning, "across_stages/geometry", "alpha test of a material never runs",
     "The surface looks solid, because the ray is opaque or no any-hit shader tests the material.",
     "Give the hit group for class alpha an any_hit for this ray type, and trace without the opaque flag.",
     "opaque transparent transparency any-hit", kOfScene},
    {"Q605", kError, "across_stages/arguments", "ray flags exclude each other",
     "Vulkan forbids the combination, and its effect depends on the driver.",
     "Keep only one of the two flags that the message names."},
    {"Q606", kWarning, "across_stages/candidates", "any-hit shader ignores every intersection",
     "The rays pass through all geometry of the hit group, as if it did not exist.",
     "Call ignoreIntersectionEXT only under a condition, or remove the geometry from these rays by the cull mask.",
     "ignoreIntersectionEXT"},
    {"Q607", kWarning, "across_stages/hit_kinds", "hit kind of triangles in a procedural hit group",
     "Only the built-in triangle intersection reports gl_HitKindFrontFacingTriangleEXT and "
     "gl_HitKindBackFacingTriangleEXT, so the comparison always has the same result.",
     "Compare with the kind that the intersection shader passes to reportIntersectionEXT.", "gl_HitKindEXT", kOfScene},
    {"Q608", kWarning, "across_stages/hit_kinds", "reported hit kind is above 127",
     "Vulkan allows 0 to 127 and reserves larger values for triangles; drivers can use only 7 bits.",
     "Number the kinds of the program from 0, and pass other data as a hit attribute.", "gl_HitKindEXT"},
    {"Q609", kError, "across_stages/hit_records", "geometry and its hit group are of different kinds",
     "Boxes need a procedural hit group, and triangles a hit group without an intersection shader; all else is "
     "undefined.",
     "Check the record offset of the instance and the order of the hit groups in the shader binding table.",
     "procedural triangles aabb intersection", kOfScene},
    {"Q610", kWarning, "across_stages/hit_records", "ray flags exclude an any-hit shader from all traces",
     "With gl_RayFlagsOpaqueEXT or gl_RayFlagsCullNoOpaqueEXT no any-hit shader runs: what it tests looks solid.",
     "Remove the flag from the traces that need the shader, or the shader from the hit group.",
     "opaque alpha transparent gl_RayFlagsOpaqueEXT"},

    // Resources.
    {"Q651", kError, "across_stages/resources", "resource that Quintet does not provide",
     "The descriptor set has no such binding: the driver reads unrelated memory, and the process crashes.",
     "Use the bindings of <quintet/frame.glsl>, and buffer addresses, parameters and outputs for all other data.",
     "descriptor binding buffer texture"},
    {"Q652", kError, "across_stages/resources", "push constant block that Quintet does not provide",
     "Quintet pushes its own block, so members of a different one have wrong values, and a longer one is undefined.",
     "Include <quintet/frame.glsl>, and declare values of the program as [[parameter]]."},
    {"Q653", kError, "across_stages/resources", "shader record block differs from the declared record",
     "Both describe the same bytes: members are read from wrong offsets or with a wrong type.",
     "Include <quintet/generated/record.glsl> instead of declaring the block.", "sbt binding table"},
    {"Q654", kError, "across_stages/resources", "shader record is read but the program declares none",
     "The records hold only shader handles, so the block reads the next record or memory behind the table.",
     "Declare the fields as [[record]] in program.toml, and include <quintet/generated/record.glsl>.",
     "sbt binding table"},

    // Shader binding tables of applications (the layer in layer/).
    {"Q661", kError, "check/modules/table_check", "record has a handle of a different pipeline",
     "The handle belongs to a different or destroyed pipeline, or is no handle: the device jumps to an unknown shader.",
     "Write the table again whenever the pipeline is created again, and copy handles with shaderGroupHandleSize.",
     "sbt shader binding table vkGetRayTracingShaderGroupHandlesKHR"},
    {"Q662", kError, "check/modules/table_check", "record has a handle for a different region",
     "A region runs only shaders of its kind, so the device runs a shader with data that it does not expect.",
     "Check the order of the groups from which the handles are copied to the regions.",
     "sbt shader binding table miss hit callable"},
    {"Q663", kError, "check/modules/table_check", "ray generation record is empty",
     "The launch runs no shader, or an unknown one.", "Write the handle of the ray generation group to the region.",
     "sbt shader binding table null handle"},
    {"Q664", kError, "check/modules/table_check", "address, stride or size of a region is invalid",
     "The device reads handles at wrong addresses.",
     "Align regions to shaderGroupBaseAlignment and strides to shaderGroupHandleAlignment.",
     "sbt shader binding table VkStridedDeviceAddressRegionKHR alignment"},
    {"Q665", kError, "check/modules/table_check", "region is larger than its buffer",
     "The device reads handles and data behind the buffer.", "Make the buffer larger, or the region smaller.",
     "sbt shader binding table size"},
    {"Q666", kError, "check/modules/table_check", "record is shorter than the shader record block",
     "The shader reads the next record, or memory behind the table.",
     "Use a stride of at least the size of the handle plus that of the block, aligned to the handle alignment.",
     "sbt binding table stride shaderRecordEXT"},
    {"Q667", kError, "check/modules/stack_check", "stack is smaller than the traces and calls need",
     "A stack that is too small is overwritten by nested shaders, or the device is lost.",
     "Set the size to the sum of the stack sizes of the shaders along the longest chain of traces and calls.",
     "vkCmdSetRayTracingPipelineStackSizeKHR recursion depth"},

    // Shading mistakes.
    {"Q701", kError, "within_stage/distance", "normalized object-space direction is used for t",
     "The unit of t is the length of the ray direction, so scaled instances get wrong distances and a wrong order of "
     "hits.",
     "Intersect with gl_ObjectRayDirectionEXT as it is, or divide the t of the unit direction by its length.",
     "distance normalize scale"},
    {"Q702", kWarning, "across_stages/spaces", "normal is transformed by gl_ObjectToWorldEXT",
     "With non-uniform scale the result is not perpendicular to the surface, and shading is wrong.",
     "Multiply from the left with world-to-object: normalize(vec3(normal * gl_WorldToObjectEXT)).", "transform matrix"},
    {"Q703", kWarning, "within_stage/indices", "gl_InstanceID is used instead of the custom index",
     "gl_InstanceID is the position in the built list, which Quintet can sort, so its order depends on the device.",
     "Use gl_InstanceCustomIndexEXT, the position in the scene, or instanceCustomIndex(), the number set in the scene "
     "file.",
     "gl_InstanceCustomIndexEXT instance"},
    {"Q704", kError, "within_stage/indices", "descriptor index depends on the hit but is not marked nonuniformEXT",
     "The driver can use the index of one invocation for its whole group, which shows as blocks of wrong textures.",
     "Mark the index: textures[nonuniformEXT(index)].", "texture"},
    {"Q705", kWarning, "across_stages/ray_origins", "ray starts on a surface with tmin 0",
     "Rounding puts the origin below the surface for about half of the rays, which shows as shadow acne.",
     "Offset the origin (offsetOrigin of <quintet/surface.glsl>), or use a tmin larger than the error.",
     "acne shadow origin offset"},
    {"Q706", kError, "shader/stage_builtins", "built-in does not exist in this stage",
     "The value is unknown in this stage: for example, a miss shader has no hit.",
     "Pass the value through the payload from a stage that has it.", "variable miss"},
    {"Q707", kError, "within_stage/print_formats", "format of debugPrintfEXT does not match its arguments",
     "The text would show a wrong number, or none.",
     "Write one specifier for each argument, of its type: %d, %u, %f, %v3f for a vec3, %ld for 64 bits.",
     "printf print specifier"},
    {"Q708", kWarning, "across_stages/spaces",
     "position is transformed like a direction, or a direction like a position",
     "A position must be translated (w = 1) and a direction must not (w = 0), or instances that are moved look wrong.",
     "Use matrix * vec4(position, 1.0) and matrix * vec4(direction, 0.0).", "transform matrix point vector"},
    {"Q709", kWarning, "across_stages/spaces", "values of different spaces are mixed",
     "The result is right only for instances without a transform.",
     "Transform one of the values first: gl_ObjectToWorldEXT maps object space to world space.",
     "transform matrix world object normal", kOfScene},
    {"Q710", kWarning, "across_stages/barycentrics", "weights of the three vertices of a triangle are wrong",
     "The attribute gives the weights of vertices 1 and 2, so values of the vertices end up at other corners.",
     "Interpolate with (1.0 - b.x - b.y) * v0 + b.x * v1 + b.y * v2.", "barycentrics interpolation"},
    {"Q711", kError, "across_stages/array_indices", "array index is beyond the array",
     "GLSL does not check indices: the shader reads or overwrites other memory.",
     "Make the array larger, or limit the index, for example with min().", "out-of-bounds", kOfScene},
    {"Q712", kWarning, "across_stages/outputs", "output is never written",
     "Its image is black: outputs start with zeros.",
     "Store the value with storeOutput or addOutput, or remove the output from program.toml.", "black store"},
    {"Q713", kWarning, "within_stage/pixels", "result is stored at a wrong pixel",
     "Other pixels keep their old values, several invocations write the same pixel, or the write is outside of the "
     "image.",
     "Store at launchPixel().", "launchPixel"},
    {"Q714", kWarning, "across_stages/outputs", "output is overwritten instead of accumulated",
     "An output is the sum over the samples of a batch. Only one sample remains, so the image is too dark and noisy.",
     "Add to the sum: storeOutput(kOutput_x, pixel, loadOutput(kOutput_x, pixel) + value), or call addOutput.",
     "dark noise average"},
    {"Q715", kWarning, "across_stages/color_encoding", "color is encoded or decoded twice",
     "Quintet encodes an output of kind color when it writes an image, so the image is too bright and pale.",
     "Store linear color, or declare the output with kind = \"display\".", "srgb gamma"},
    {"Q716", kWarning, "within_stage/pixels", "integer division of the launch id by the size",
     "The id is smaller than the size, so the result of the integer division is always 0.",
     "Convert both to float first: vec2(gl_LaunchIDEXT.xy) / vec2(gl_LaunchSizeEXT.xy).",
     "gl_LaunchIDEXT gl_LaunchSizeEXT black"},
    {"Q717", kWarning, "across_stages/hit_positions", "hit position is computed with a direction of a different length",
     "The unit of t is the length of the ray direction, so the position is before or behind the surface.",
     "Compute origin + t * direction with the direction of the trace as it is.", "normalize world"},
    {"Q718", kWarning, "across_stages/random_seeds", "random numbers are the same in each sample of a pixel",
     "The average of equal samples has the noise of one sample, however many there are.",
     "Make the seed from the pixel and the index of the sample: launch.firstSample, or frameID in the lecture form.",
     "noise seed"},
    {"Q719", kWarning, "across_stages/miss_distances", "distance of a miss is used like that of a hit",
     "In a miss shader, gl_RayTmaxEXT is the tmax of the trace, a positive number without a surface.",
     "Store a value that marks the miss, such as -1.0, and test it after the trace.", "gl_RayTmaxEXT tmax"},

    // Unused parts.
    {"Q801", kWarning, "across_stages/unused", "stage is unreachable", "It costs compile time without any effect.",
     "Trace or call it, or remove it from the pipeline.", "unused dead"},
    {"Q802", kWarning, "across_stages/unused", "hit group matches no geometry of the scene",
     "The group has no effect: a name is misspelled, or the program was written for a different scene.",
     "Compare geometry, material and primitives of the group with `quintet info SCENE`.", "unused material name",
     kOfScene},
    {"Q803", kNote, "check/suppression", "suppression of a diagnostic that is not reported",
     "A comment that allows what does not occur hides the next mistake of this kind in its line.",
     "Remove the comment, or move it to the line of the diagnostic.", "comment allow"},
    {"Q804", kWarning, "check/suppression", "suppression is invalid",
     "The comment has no effect: its id does not exist or is that of an error.",
     "Write // quintet: allow Q604 reason, with the id of a warning or note.", "comment allow"},

    // Driver defects (docs/design/quirks.md).
    {"Q901", kWarning, "within_stage/driver_defects", "built-in is read after a nested trace",
     "Some drivers return the value of the inner hit (lavapipe).",
     "Copy the built-in to a local variable before the trace.", "lavapipe driver defect"},
    {"Q902", kWarning, "within_stage/driver_defects", "hit attribute is written although the report can be rejected",
     "Some drivers keep the attributes of a rejected candidate instead of those of the accepted hit (lavapipe).",
     "Write them only if gl_RayTminEXT <= t and t < gl_RayTmaxEXT, or compute them in the closest-hit shader.",
     "lavapipe driver defect"},
    {"Q903", kNote, "across_stages/shared_intersections",
     "intersection shader is shared by hit groups with different any-hit shaders",
     "Some drivers run the any-hit shader of the first group for both (lavapipe).",
     "No change is required: Quintet gives each group a copy of the stage.", "lavapipe driver defect"},
    {"Q904", kWarning, "within_stage/driver_defects", "gl_RayTmaxEXT is read after a report of the same invocation",
     "It can have its old value (because of the optimizer, and on lavapipe), so a farther hit replaces a closer one.",
     "Keep the closest accepted t in a local variable.", "lavapipe driver defect"},
    {"Q905", kWarning, "within_stage/driver_defects",
     "dynamically indexed local array in an intersection shader with an any-hit shader",
     "Some drivers use the same memory for both stages (lavapipe): the any-hit shader overwrites the array.",
     "Keep the values in scalars, or do the any-hit test in the intersection shader.", "lavapipe driver defect"},
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

}  // namespace quintet::check
