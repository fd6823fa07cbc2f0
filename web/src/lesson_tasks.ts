// SPDX-License-Identifier: Apache-2.0
// The tasks of the lessons. A solution is the built-in program with edits. A task is done if the user's program renders the
// same image as the solution, with the stated parameters, or has the same values. Each task starts from the lesson's program,
// and the other tasks may be done in it (acceptedTasks).
import type { ParameterValue } from "./protocol";
import type { ValueComparison } from "./value_comparison";

export interface TaskEdit {
  file?: string; // name in the folder; the main file if omitted
  from: string; // occurs once
  to: string;
}

export interface LessonTask {
  id: string; // unique, for the stored progress
  text: string; // Markdown
  hint: string; // Markdown
  edits: readonly TaskEdit[];
  samples?: number; // samples or frames that are compared; 1 by default
  parameters?: Record<string, ParameterValue>;
  compare?: ValueComparison; // instead of the images
}

// By the name of the lesson, such as "05_shadow".
export const kLessonTasks: Readonly<Record<string, readonly LessonTask[]>> = {
  "00_pipeline": [
    {
      id: "payload",
      text: "A payload is all that a ray returns. Return the color 0.25, 0.5, 0.75 from the shader that runs if a ray hits nothing. The check reads `payload.color` after the ray of pixel 4, 4.",
      hint: "It is the miss shader of lesson 01, which is open in the editors. Assign to `payload.color`.",
      edits: [{ from: "payload.color = vec3(0.0);", to: "payload.color = vec3(0.25, 0.5, 0.75);" }],
      compare: { kind: "payload", pixel: [4, 4], member: "color" },
    },
    {
      id: "launch",
      text: "`vkCmdTraceRays` starts one invocation for each pixel. Print its index and the size of the launch in the ray generation shader: `debugPrintfEXT(\"%d %d of %d %d\", …)`. The check reads what pixel 60, 30 prints.",
      hint: "`gl_LaunchIDEXT` and `gl_LaunchSizeEXT` are `uvec3`. The arguments for `%d` are integers, so convert each with `int(…)`.",
      edits: [
        {
          from: "void main() { /**** RAY GENERATION SHADER ****/\n",
          to:
            "void main() { /**** RAY GENERATION SHADER ****/\n" +
            '  debugPrintfEXT("%d %d of %d %d", int(gl_LaunchIDEXT.x), int(gl_LaunchIDEXT.y), int(gl_LaunchSizeEXT.x), int(gl_LaunchSizeEXT.y));\n',
        },
      ],
      compare: { kind: "printed", pixel: [60, 30] },
    },
  ],
  "01_first_ray": [
    {
      id: "instance-gray",
      text: "Show which instance a ray hits: return the gray value `0.25 * (gl_InstanceID + 1)` in the closest-hit shader.",
      hint: "`gl_InstanceID` is an `int`. Convert it with `float(…)`, and make a color of one number with `vec3(…)`.",
      edits: [{ from: "payload.color = hitColor;", to: "payload.color = vec3(0.25 * float(gl_InstanceID + 1));" }],
    },
    {
      id: "gradient",
      text: "Replace the black background by a gradient: in the miss shader, all three components are 0.5 + 0.5 *y*, where *y* is the vertical component of the ray's direction.",
      hint: "A miss shader can read `gl_WorldRayDirectionEXT`.",
      edits: [{ from: "payload.color = vec3(0.0);", to: "payload.color = vec3(0.5 + 0.5 * gl_WorldRayDirectionEXT.y);" }],
    },
  ],
  "02_cameras": [
    {
      id: "orthographic",
      text: "Make the camera orthographic: all rays have the direction of the view, and start on a plane through `eye` that is 4 m high.",
      hint: "The columns of `worldFromCamera()` are right, up and back. Move the origin by `2.0 * (ndc.x * aspect * right + ndc.y * up)`; the direction is `-back`.",
      edits: [
        {
          from: "  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, nearPlane, direction, farPlane, 0);",
          to:
            "  mat4 camera = worldFromCamera();\n" +
            "  vec3 origin = eye + 2.0 * (ndc.x * aspect * camera[0].xyz + ndc.y * camera[1].xyz);\n" +
            "  direction = -camera[2].xyz;\n" +
            "  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, origin, nearPlane, direction, farPlane, 0);",
        },
      ],
    },
  ],
  "03_mesh_data": [
    {
      id: "wireframe",
      text: "Draw the edges of the triangles: where the smallest of the three barycentric weights is below 0.05, the color is white.",
      hint: "Add a line at the end of the closest-hit shader. `weights` has all three weights.",
      edits: [
        {
          from: "  else payload.color = 0.5 + 0.5 * faceNormal;\n",
          to: "  else payload.color = 0.5 + 0.5 * faceNormal;\n  if (min(weights.x, min(weights.y, weights.z)) < 0.05) payload.color = vec3(1.0);\n",
        },
      ],
    },
    {
      id: "wrong-matrix",
      text: "Transform the interpolated normal by `mat3(gl_ObjectToWorldEXT)` instead of the normal matrix. Which objects change, and why?",
      hint: "Only the line of `vec3 normal` changes. The check warns about it, because the result is wrong for objects whose scale is not uniform.",
      edits: [{ from: "vec3 normal = normalize(normalMatrix * localNormal);", to: "vec3 normal = normalize(mat3(gl_ObjectToWorldEXT) * localNormal);" }],
    },
  ],
  "04_diffuse": [
    {
      id: "inverse-square",
      text: "Let the light fall off with the squared distance to the lamp, as in physics. Multiply `baseColor` by 30 to compensate.",
      hint: "For a vector `v`, `dot(v, v)` is its squared length. Use the vector to the lamp before it is normalized.",
      edits: [
        {
          from: "payload.color = ambientColor + baseColor * max(dot(normal, toLight), 0.0);",
          to: "vec3 toLamp = lightPosition - position;\n  payload.color = ambientColor + 30.0 * baseColor * max(dot(normal, toLight), 0.0) / dot(toLamp, toLamp);",
        },
      ],
    },
  ],
  "05_shadow": [
    {
      id: "blue-shadow",
      text: "Make shadows blue: where the lamp is not visible, multiply the ambient light by the color 0.4, 0.5, 1.5.",
      hint: "`payload.lampIsSeen` is false in the shadow, after the shadow ray. Add an `else` to the line that uses it.",
      edits: [
        {
          from: "  if (payload.lampIsSeen) radiance += baseColor * max(dot(normal, toLamp / lampDistance), 0.0);\n",
          to: "  if (payload.lampIsSeen) radiance += baseColor * max(dot(normal, toLamp / lampDistance), 0.0);\n  else radiance *= vec3(0.4, 0.5, 1.5);\n",
        },
      ],
    },
    {
      id: "still-lamp",
      text: "Stop the lamp at its position of frame 0. The check compares frame 11.",
      hint: "`turn` is the angle of the lamp. It depends on `frameID`.",
      edits: [{ from: "float turn = 2.0 * 3.14159265359 * float(frameID % framesPerTurn) / float(framesPerTurn);", to: "float turn = 0.0;" }],
      samples: 12,
    },
  ],
  "06_mirror_loop": [
    {
      id: "one-mirror",
      text: "Let only the sphere (instance 1) reflect. The other surfaces have the reflectance 0.",
      hint: "The closest-hit shader returns the reflectance of the surface in `payload.reflectance`.",
      edits: [{ from: "payload.reflectance = reflectance;", to: "payload.reflectance = gl_InstanceID == 1 ? reflectance : 0.0;" }],
    },
  ],
  "07_mirror_recursion": [
    {
      id: "one-mirror",
      text: "Let only the sphere (instance 1) trace the reflected ray.",
      hint: "Extend the condition before the second `traceRayEXT` of the closest-hit shader.",
      edits: [{ from: "if (level + 1 < maxLevel &&", to: "if (gl_InstanceID == 1 && level + 1 < maxLevel &&" }],
    },
  ],
  "08_refraction": [
    {
      id: "total-reflection",
      text: "A bubble in water: the check sets `inside` to 1 and `outside` to 1.33. Make total internal reflection visible: paint these points red (1, 0, 0) and end the path there.",
      hint: "`reflected` is true where `refract` has no solution. A path ends if `payload.nextDirection` is zero.",
      edits: [
        {
          from: "  if (reflected) next = reflect(direction, normal);\n",
          to: "  if (reflected) {\n    payload.color = vec3(1.0, 0.0, 0.0);\n    payload.nextDirection = vec3(0.0);\n    return;\n  }\n",
        },
      ],
      parameters: { inside: 1, outside: 1.33 },
    },
  ],
  "09_progressive": [
    {
      id: "blur",
      text: "Blur the image: spread the samples over a square of 8 × 8 pixels around the center of the pixel. The check compares the mean of 16 frames.",
      hint: "`offset` is in a square of side 1 with the center 0.5. Scale its distance from the center.",
      edits: [
        {
          from: "  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + offset)",
          to: "  offset = 0.5 + 8.0 * (offset - 0.5);\n  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + offset)",
        },
      ],
      samples: 16,
    },
  ],
  "10_sphere": [
    {
      id: "inner-side",
      text: "Open the spheres: report only the points where a ray *leaves* a sphere, so that you see their inner side.",
      hint: "`crossSphere` returns at the first of the two solutions that is in the interval. Remove the first one.",
      edits: [{ from: "  if (t >= tmin && t <= tmax) return 1u;\n", to: "" }],
    },
  ],
  "11_many_spheres": [
    {
      id: "fog",
      text: "Add fog: mix the shaded color with the color of the background (0.75, 0.82, 0.9) by `gl_HitTEXT / 60`, at most 1.",
      hint: "`mix(a, b, min(x, 1.0))` is `a` at 0 and `b` at 1.",
      edits: [
        {
          from: "payload.color = color * (0.12 + 0.88 * light);",
          to: "payload.color = mix(color * (0.12 + 0.88 * light), vec3(0.75, 0.82, 0.9), min(gl_HitTEXT / 60.0, 1.0));",
        },
      ],
    },
  ],
  "12_box": [
    {
      id: "frame",
      text: "Draw a frame on each face: where a texture coordinate is below 0.05 or above 0.95, the color is `vec3(0.05)`.",
      hint: "The coordinates are in `hit.texCoord`. Add a line at the end of the closest-hit shader.",
      edits: [
        {
          from: "abs(dot(normal, normalize(vec3(1.0, 2.0, 3.0)))));\n",
          to:
            "abs(dot(normal, normalize(vec3(1.0, 2.0, 3.0)))));\n" +
            "    if (any(lessThan(hit.texCoord, vec2(0.05))) || any(greaterThan(hit.texCoord, vec2(0.95)))) payload.color = vec3(0.05);\n",
        },
      ],
    },
  ],
  "13_triangle": [
    {
      id: "hole",
      text: "Cut a hole into the custom triangle: report no hit where the distance of (*u*, *v*) from (1/3, 1/3) is below 0.25.",
      hint: "Return from the intersection shader before `reportIntersectionEXT`.",
      edits: [
        {
          from: "  hit.barycentric = vec2(u, v);\n",
          to: "  if (distance(vec2(u, v), vec2(1.0 / 3.0)) < 0.25) return;\n  hit.barycentric = vec2(u, v);\n",
        },
      ],
    },
  ],
  "14_csg": [
    {
      id: "ball-minus-box",
      text: "Replace the intersection (in the middle) by *ball without box*. Turn the normals of the box's faces there, so that they point out of the solid.",
      hint: "Change `insideAfter` for `opIntersection`. The line that turns the normals of the hole shows how to do it for the box (`!ofBall`).",
      edits: [
        { from: "op == opIntersection ? inBox && inBall", to: "op == opIntersection ? inBall && !inBox" },
        { from: "  if (op == opDifference && ofBall) normal = -normal;", to: "  if (op == opIntersection && !ofBall) normal = -normal;\n  if (op == opDifference && ofBall) normal = -normal;" },
      ],
    },
  ],
  "15_any_hit": [
    {
      id: "square-holes",
      text: "Make the holes square: a point is in a hole if both coordinates of `field` are closer than `holeRadius` to 0.",
      hint: "`max(abs(field.x), abs(field.y))` is the distance that counts.",
      edits: [{ from: "return dot(field, field) < holeRadius * holeRadius;", to: "return max(abs(field.x), abs(field.y)) < holeRadius;" }],
    },
  ],
  "16_callable": [
    {
      id: "rotate",
      text: "Rotate the materials: each sphere calls the callable shader of the next one, and the last sphere calls number 0.",
      hint: "The first argument of `executeCallableEXT` selects the shader. There are three.",
      edits: [{ from: "executeCallableEXT(uint(gl_InstanceID), 0);", to: "executeCallableEXT(uint(gl_InstanceID + 1) % 3u, 0);" }],
    },
    {
      id: "four-tones",
      text: "Give the comic material four tones: 1 above 0.8, 0.75 above 0.5, 0.5 above 0.2, else 0.25.",
      hint: "It is the third callable shader. `light` is the cosine that selects the tone.",
      edits: [{ from: "(light > 0.7 ? 1.0 : light > 0.2 ? 0.6 : 0.3)", to: "(light > 0.8 ? 1.0 : light > 0.5 ? 0.75 : light > 0.2 ? 0.5 : 0.25)" }],
    },
  ],
  "17_records": [
    {
      id: "floor-tint",
      text: "Give the floor the color 0.3, 0.5, 0.8 without a change of a shader: set `tint` in the record of its hit group.",
      hint: "The floor uses the hit group `plain` in `program.toml`. The group `striped` shows how to write a record.",
      edits: [{ file: "program.toml", from: 'name = "plain"\n', to: 'name = "plain"\nrecord = { tint = [0.3, 0.5, 0.8] }\n' }],
    },
  ],
  "18_instances": [
    {
      id: "white-odd",
      text: "Make all instances with an odd `gl_InstanceID` white instead of a color of the palette.",
      hint: "`(gl_InstanceID & 1) != 0` is true for odd numbers.",
      edits: [{ from: "vec3 base = palette[gl_InstanceCustomIndexEXT & 3];", to: "vec3 base = (gl_InstanceID & 1) != 0 ? vec3(1.0) : palette[gl_InstanceCustomIndexEXT & 3];" }],
    },
  ],
  "19_dynamic": [
    {
      id: "sun-path",
      text: "Let the sun move: its direction is `vec3(cos(a), 1.0, sin(a))`, normalized, with `a = 0.1 * frameID`. The check compares frame 9.",
      hint: "`frameID` is an `int`. `toSun` is in the closest-hit shader.",
      edits: [
        {
          from: "vec3 toSun = normalize(vec3(0.5, 1.0, 0.4));",
          to: "float a = 0.1 * float(frameID);\n  vec3 toSun = normalize(vec3(cos(a), 1.0, sin(a)));",
        },
      ],
      samples: 10,
    },
  ],
  "20_lambert": [
    {
      id: "normals",
      text: "Show the shading normals: a surface that is no mirror gets the color `0.5 + 0.5 * normal`, without light. Mirrors still reflect.",
      hint: "Only the line in `lambert.rgen` that adds the light of the surface changes. Keep `weight`.",
      edits: [{ file: "lambert.rgen", from: "color += weight * surface * (parameters.ambient + sun);", to: "color += weight * (0.5 + 0.5 * normal);" }],
    },
  ],
  "21_one_weekend": [
    {
      id: "sunset",
      text: "Replace the sky by a sunset: from `vec3(1.0, 0.6, 0.3)` at the bottom to `vec3(0.2, 0.3, 0.7)` at the top.",
      hint: "`pathColor` returns the sky where a path misses all spheres.",
      edits: [{ from: "mix(vec3(1.0), vec3(0.5, 0.7, 1.0), up)", to: "mix(vec3(1.0, 0.6, 0.3), vec3(0.2, 0.3, 0.7), up)" }],
      parameters: { samples: 4, bounces: 8 },
    },
  ],
  "22_path_tracer": [
    {
      id: "sky",
      text: "Add a sky: a path that leaves the room finds the radiance 0.4, 0.5, 0.7. Keep the lamp.",
      hint: "`payload.t` is negative where a ray misses. There, add the radiance times the `weight` of the path before the loop ends.",
      edits: [{ from: "    if (payload.t < 0.0) break;\n", to: "    if (payload.t < 0.0) {\n      radiance += weight * vec3(0.4, 0.5, 0.7);\n      break;\n    }\n" }],
      parameters: { samples: 4, bounces: 4 },
    },
  ],
  "23_monte_carlo": [
    {
      id: "white-sky",
      text: "Measure an albedo: let the sky have the radiance 1 in all directions, also where the camera sees it. The floor then shows almost its albedo, 0.6: the block hides a small part of the sky. The check compares the mean of 16 frames on the floor and in the sky.",
      hint: "`skyRadiance` returns the light of a direction.",
      edits: [{ from: "return mix(vec3(1.0, 0.95, 0.85), vec3(0.25, 0.5, 1.0), clamp(direction.y, 0.0, 1.0));", to: "return vec3(1.0);" }],
      samples: 16,
      parameters: { samples: 4 },
      compare: { kind: "mean", blocks: [{ x: 190, y: 112, width: 44, height: 16 }, { x: 8, y: 4, width: 60, height: 8 }], tolerance: 0.02 },
    },
    {
      id: "sky-only",
      text: "A ray in a random direction is blocked or reaches the sky. Show the share of rays that reach the sky: the image is the mean of 1 (sky) and 0 (blocked), without albedo and cosine. The check compares the mean of 16 frames.",
      hint: "`estimate` returns one sample. It is 1 or 0 now, so there is nothing to divide by.",
      edits: [
        {
          from: "  vec3 incoming = payload.t < 0.0 ? skyRadiance(wi) : vec3(0.0);\n  return albedo / pi * incoming * dot(normal, wi) / density;",
          to: "  return vec3(payload.t < 0.0 ? 1.0 : 0.0);",
        },
      ],
      samples: 16,
      parameters: { samples: 4 },
      compare: { kind: "mean", blocks: [{ x: 8, y: 112, width: 40, height: 16 }, { x: 100, y: 84, width: 48, height: 24 }], tolerance: 0.02 },
    },
  ],
  "24_cosine_sampling": [
    {
      id: "furnace",
      text: "The furnace test: let each sample receive the radiance 1, also where something blocks the sky. With `method` 1, every surface has the color of its albedo, without any noise. Why?",
      hint: "Only `incoming` changes. The sample is albedo · cosine / π divided by the density cosine / π.",
      edits: [{ from: "vec3 incoming = payload.t < 0.0 ? skyRadiance(wi) : vec3(0.0);", to: "vec3 incoming = vec3(1.0);" }],
      parameters: { method: 1 },
    },
    {
      id: "print-density",
      text: "Print the density of each sample with `debugPrintfEXT(\"%f\", …)` before the ray is traced. The check reads what pixel 24, 120 prints with `method` 0: the density of uniform directions.",
      hint: "`density` has the value in `estimate`.",
      edits: [{ from: "  if (density <= 0.0) return vec3(0.0);\n", to: '  if (density <= 0.0) return vec3(0.0);\n  debugPrintfEXT("%f", density);\n' }],
      parameters: { method: 0 },
      compare: { kind: "printed", pixel: [24, 120] },
    },
  ],
  "25_next_event": [
    {
      id: "upwards",
      text: "Let the lamp also shine upward: a point above it receives light from its other side. The check compares the mean of 16 frames at the ceiling and at the floor.",
      hint: "`cosLamp` in `byPoint` is the cosine at the lamp. Its absolute value counts both sides.",
      edits: [{ from: "float cosLamp = wi.y;", to: "float cosLamp = abs(wi.y);" }],
      samples: 16,
      compare: { kind: "mean", blocks: [{ x: 100, y: 4, width: 40, height: 6 }, { x: 104, y: 118, width: 32, height: 10 }], tolerance: 0.03 },
    },
  ],
  "26_mis": [
    {
      id: "power-heuristic",
      text: "Use the power heuristic: the weight is the square of the technique's own density, divided by the sum of both squares. It favors the better technique more strongly than the balance heuristic.",
      hint: "`weightOf` computes the weight. The check compares the noise of one frame, so keep the random numbers as they are.",
      edits: [{ from: "strategy == 2 ? own / (own + other) : 1.0;", to: "strategy == 2 ? own * own / (own * own + other * other) : 1.0;" }],
    },
  ],
  "27_roulette": [
    {
      id: "first-event",
      text: "Use Russian roulette from the first scattering event on, instead of from the third. The check compares the mean number of events of a path (`show` 1) in 16 frames.",
      hint: "The condition before `survival` contains the depth.",
      edits: [{ from: "if (roulette && depth >= 2) {", to: "if (roulette) {" }],
      samples: 16,
      parameters: { show: 1 },
      compare: { kind: "mean", blocks: [{ x: 60, y: 10, width: 120, height: 115 }], tolerance: 0.02 },
    },
  ],
};

// The programs that count as the solution of a task: the lesson's program with the task alone, and with any of the other tasks,
// because a student keeps what is done.
export function acceptedTasks(tasks: readonly LessonTask[], task: LessonTask): LessonTask[][] {
  const others = tasks.filter((other) => other !== task);
  return Array.from({ length: 1 << others.length }, (_, set) => [...others.filter((_, i) => (set >> i) & 1), task]);
}

// The files of the program in which these tasks are done, by name in the folder. Throws if an edit does not fit, which the
// tests exclude.
export function solutionFiles(originals: ReadonlyMap<string, string>, main: string, ...tasks: readonly LessonTask[]): Map<string, string> {
  const files = new Map(originals);
  for (const edit of tasks.flatMap((task) => task.edits)) {
    const name = edit.file ?? main;
    const text = files.get(name) ?? "";
    const at = text.indexOf(edit.from);
    if (at < 0 || text.indexOf(edit.from, at + 1) >= 0) throw new Error(`${name}: the text '${edit.from}' must occur once`);
    files.set(name, text.slice(0, at) + edit.to + text.slice(at + edit.from.length));
  }
  return files;
}
