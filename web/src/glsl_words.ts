// SPDX-License-Identifier: Apache-2.0
// The words of GLSL 4.60 with GL_EXT_ray_tracing, with one sentence each where the page shows help.
import type { StageKind } from "./lecture_segments";

const list = (text: string) => new Set(text.split(/\s+/));

export const kKeywords = list(
  "attribute break buffer case centroid coherent const continue default discard do else flat for highp if in inout invariant " +
    "layout lowp mediump noperspective nonuniformEXT out patch precise precision readonly restrict return sample shared smooth " +
    "struct subroutine switch uniform varying volatile while writeonly callableDataEXT callableDataInEXT hitAttributeEXT " +
    "rayPayloadEXT rayPayloadInEXT shaderRecordEXT",
);
export const kTypes = list(
  "accelerationStructureEXT bool bvec2 bvec3 bvec4 double dvec2 dvec3 dvec4 float float16_t float32_t float64_t int int8_t " +
    "int16_t int32_t int64_t ivec2 ivec3 ivec4 mat2 mat2x2 mat2x3 mat2x4 mat3 mat3x2 mat3x3 mat3x4 mat4 mat4x2 mat4x3 mat4x4 " +
    "sampler2D uint uint8_t uint16_t uint32_t uint64_t uvec2 uvec3 uvec4 vec2 vec3 vec4 void",
);
export const kAtoms = list("true false");

export interface Word {
  signature: string;
  help: string;
}

// Functions of GLSL; genType is float or a vector of floats.
const kFunctionTable = `
abs|genType abs(genType x)|Absolute value
acos|genType acos(genType x)|Arc cosine, 0 to pi
all|bool all(bvec x)|True if all components are true
any|bool any(bvec x)|True if any component is true
asin|genType asin(genType x)|Arc sine, -pi/2 to pi/2
atan|genType atan(genType y, genType x)|Angle of the vector (x, y), -pi to pi; with one argument the arc tangent
bitCount|int bitCount(uint value)|Number of bits that are 1
bitfieldExtract|uint bitfieldExtract(uint value, int offset, int bits)|Bits offset to offset + bits - 1
bitfieldReverse|uint bitfieldReverse(uint value)|Bits in reverse order
ceil|genType ceil(genType x)|Smallest integer that is not less than x
clamp|genType clamp(genType x, genType minVal, genType maxVal)|x limited to the interval
cos|genType cos(genType angle)|Cosine of an angle in radians
cosh|genType cosh(genType x)|Hyperbolic cosine
cross|vec3 cross(vec3 x, vec3 y)|Cross product
debugPrintfEXT|void debugPrintfEXT(format, …)|Prints values of this invocation; see Print in the panel Pixel
degrees|genType degrees(genType radians)|Converts radians to degrees
determinant|float determinant(mat m)|Determinant
distance|float distance(genType p0, genType p1)|Length of p0 - p1
dot|float dot(genType x, genType y)|Dot product
equal|bvec equal(vec x, vec y)|Component-wise x == y
exp|genType exp(genType x)|e to the power of x
exp2|genType exp2(genType x)|2 to the power of x
faceforward|genType faceforward(genType N, genType I, genType Nref)|N if dot(Nref, I) < 0, else -N
findLSB|int findLSB(uint value)|Index of the lowest bit that is 1, or -1
findMSB|int findMSB(uint value)|Index of the highest bit that is 1, or -1
floatBitsToInt|int floatBitsToInt(float value)|The bits of the float as an int
floatBitsToUint|uint floatBitsToUint(float value)|The bits of the float as a uint
floor|genType floor(genType x)|Largest integer that is not greater than x
fma|genType fma(genType a, genType b, genType c)|a * b + c
fract|genType fract(genType x)|x - floor(x)
greaterThan|bvec greaterThan(vec x, vec y)|Component-wise x > y
greaterThanEqual|bvec greaterThanEqual(vec x, vec y)|Component-wise x >= y
intBitsToFloat|float intBitsToFloat(int value)|The float with these bits
inverse|mat inverse(mat m)|Inverse matrix
inversesqrt|genType inversesqrt(genType x)|1 / sqrt(x)
isinf|bvec isinf(genType x)|True for infinite components
isnan|bvec isnan(genType x)|True for components that are not a number
length|float length(genType x)|Length of a vector
lessThan|bvec lessThan(vec x, vec y)|Component-wise x < y
lessThanEqual|bvec lessThanEqual(vec x, vec y)|Component-wise x <= y
log|genType log(genType x)|Natural logarithm
log2|genType log2(genType x)|Logarithm to base 2
max|genType max(genType x, genType y)|The larger value
min|genType min(genType x, genType y)|The smaller value
mix|genType mix(genType x, genType y, genType a)|x * (1 - a) + y * a
mod|genType mod(genType x, genType y)|x - y * floor(x / y)
modf|genType modf(genType x, out genType i)|Fractional part; i receives the integer part
normalize|genType normalize(genType v)|Vector of length 1 with the direction of v
not|bvec not(bvec x)|Component-wise logical complement
notEqual|bvec notEqual(vec x, vec y)|Component-wise x != y
outerProduct|mat outerProduct(vec c, vec r)|Column times row
packHalf2x16|uint packHalf2x16(vec2 v)|Two floats as 16-bit halves in one uint
pow|genType pow(genType x, genType y)|x to the power of y; undefined for x < 0
radians|genType radians(genType degrees)|Converts degrees to radians
reflect|genType reflect(genType I, genType N)|I - 2 dot(N, I) N; N must have length 1
refract|genType refract(genType I, genType N, float eta)|Refracted direction; zeros for total internal reflection. eta is the ratio of the indices of refraction
round|genType round(genType x)|Nearest integer
sign|genType sign(genType x)|-1, 0 or 1
sin|genType sin(genType angle)|Sine of an angle in radians
sinh|genType sinh(genType x)|Hyperbolic sine
smoothstep|genType smoothstep(genType edge0, genType edge1, genType x)|Smooth transition from 0 at edge0 to 1 at edge1
sqrt|genType sqrt(genType x)|Square root
step|genType step(genType edge, genType x)|0 if x < edge, else 1
tan|genType tan(genType angle)|Tangent of an angle in radians
tanh|genType tanh(genType x)|Hyperbolic tangent
texelFetch|vec4 texelFetch(sampler2D image, ivec2 texel, int level)|One texel, without filtering
texture|vec4 texture(sampler2D image, vec2 uv)|Filtered value of an image
textureLod|vec4 textureLod(sampler2D image, vec2 uv, float level)|Filtered value at a mip level
textureSize|ivec2 textureSize(sampler2D image, int level)|Size in texels
transpose|mat transpose(mat m)|Transposed matrix
trunc|genType trunc(genType x)|Integer part
uintBitsToFloat|float uintBitsToFloat(uint value)|The float with these bits
unpackHalf2x16|vec2 unpackHalf2x16(uint v)|Two halves of a uint as floats`;

// Built-ins of ray tracing. The stages that have them come from the generated table.
const kRayTable = `
executeCallableEXT|void executeCallableEXT(uint sbtRecordIndex, int callable)|Runs a callable shader. callable is the location of the data
gl_GeometryIndexEXT|int gl_GeometryIndexEXT|Index of the geometry in its bottom-level acceleration structure
gl_HitKindEXT|uint gl_HitKindEXT|0xFE: front face, 0xFF: back face of a triangle; else the value of reportIntersectionEXT
gl_HitTEXT|float gl_HitTEXT|Ray parameter t of the hit; equals gl_RayTmaxEXT
gl_IncomingRayFlagsEXT|uint gl_IncomingRayFlagsEXT|Flags of the trace
gl_InstanceCustomIndexEXT|int gl_InstanceCustomIndexEXT|The 24-bit index that the scene gave to the instance
gl_InstanceID|int gl_InstanceID|Index of the instance in the scene
gl_LaunchIDEXT|uvec3 gl_LaunchIDEXT|Index of this invocation: the pixel
gl_LaunchSizeEXT|uvec3 gl_LaunchSizeEXT|Number of invocations in each dimension: the size of the image
gl_ObjectRayDirectionEXT|vec3 gl_ObjectRayDirectionEXT|Direction of the ray in object space; not normalized
gl_ObjectRayOriginEXT|vec3 gl_ObjectRayOriginEXT|Origin of the ray in object space
gl_ObjectToWorld3x4EXT|mat3x4 gl_ObjectToWorld3x4EXT|Transposed transform from object to world space
gl_ObjectToWorldEXT|mat4x3 gl_ObjectToWorldEXT|Transform from object to world space
gl_PrimitiveID|int gl_PrimitiveID|Index of the triangle or box in its geometry
gl_RayTmaxEXT|float gl_RayTmaxEXT|End of the ray's interval: the closest hit so far; in miss shaders tmax of the trace
gl_RayTminEXT|float gl_RayTminEXT|Start of the ray's interval
gl_WorldRayDirectionEXT|vec3 gl_WorldRayDirectionEXT|Direction of the ray in world space
gl_WorldRayOriginEXT|vec3 gl_WorldRayOriginEXT|Origin of the ray in world space
gl_WorldToObject3x4EXT|mat3x4 gl_WorldToObject3x4EXT|Transposed transform from world to object space
gl_WorldToObjectEXT|mat4x3 gl_WorldToObjectEXT|Transform from world to object space
ignoreIntersectionEXT|ignoreIntersectionEXT;|Rejects the hit and ends the any-hit shader
reportIntersectionEXT|bool reportIntersectionEXT(float hitT, uint hitKind)|Reports a hit at hitT. Returns false if it is outside of the interval or was ignored
terminateRayEXT|terminateRayEXT;|Accepts the hit, ends the any-hit shader and the traversal
traceRayEXT|void traceRayEXT(accelerationStructureEXT topLevel, uint rayFlags, uint cullMask, uint sbtRecordOffset, uint sbtRecordStride, uint missIndex, vec3 origin, float tmin, vec3 direction, float tmax, int payload)|Traces a ray. payload is the location of the payload variable`;

// The bits of rayFlags, and hit kinds.
const kConstantTable = `
gl_HitKindBackFacingTriangleEXT|const uint gl_HitKindBackFacingTriangleEXT = 0xFF|Hit kind of the back of a triangle
gl_HitKindFrontFacingTriangleEXT|const uint gl_HitKindFrontFacingTriangleEXT = 0xFE|Hit kind of the front of a triangle
gl_RayFlagsCullBackFacingTrianglesEXT|const uint gl_RayFlagsCullBackFacingTrianglesEXT = 16|Ignore triangles seen from behind
gl_RayFlagsCullFrontFacingTrianglesEXT|const uint gl_RayFlagsCullFrontFacingTrianglesEXT = 32|Ignore triangles seen from the front
gl_RayFlagsCullNoOpaqueEXT|const uint gl_RayFlagsCullNoOpaqueEXT = 128|Ignore geometry without the opaque flag
gl_RayFlagsCullOpaqueEXT|const uint gl_RayFlagsCullOpaqueEXT = 64|Ignore opaque geometry
gl_RayFlagsNoOpaqueEXT|const uint gl_RayFlagsNoOpaqueEXT = 2|Treat all geometry as not opaque: any-hit shaders run
gl_RayFlagsNoneEXT|const uint gl_RayFlagsNoneEXT = 0|No flags
gl_RayFlagsOpaqueEXT|const uint gl_RayFlagsOpaqueEXT = 1|Treat all geometry as opaque: no any-hit shader runs
gl_RayFlagsSkipAABBEXT|const uint gl_RayFlagsSkipAABBEXT = 512|Ignore boxes
gl_RayFlagsSkipClosestHitShaderEXT|const uint gl_RayFlagsSkipClosestHitShaderEXT = 8|Do not run the closest-hit shader
gl_RayFlagsSkipTrianglesEXT|const uint gl_RayFlagsSkipTrianglesEXT = 256|Ignore triangles
gl_RayFlagsTerminateOnFirstHitEXT|const uint gl_RayFlagsTerminateOnFirstHitEXT = 4|End at the first accepted hit, not the closest one`;

function parse(table: string): Map<string, Word> {
  const rows = table.trim().split("\n").map((line) => line.split("|") as [string, string, string]);
  return new Map(rows.map(([name, signature, help]) => [name, { signature, help }]));
}

export const kFunctions = parse(kFunctionTable);
export const kRayBuiltIns = parse(kRayTable);
export const kRayConstants = parse(kConstantTable);

export type StageSet = readonly StageKind[];
