// SPDX-License-Identifier: Apache-2.0
// What the editors know about a name: predeclared names, the shader library, built-ins of a stage, parameters, and the
// declarations of the program itself.
import library from "generated:library";
import { kFunctions, kRayBuiltIns, kRayConstants, kTypes, kKeywords } from "./glsl_words";
import { kStageNames, type StageKind } from "./lecture_segments";
import type { ParameterDescription } from "./protocol";

export interface LibrarySymbol {
  name: string;
  kind: "function" | "constant" | "macro" | "struct" | "variable";
  signature: string;
  file: string;
  help: string;
  form: "library" | "lecture";
  stages?: StageKind[];
}

export interface GlslContext {
  form: "lecture" | "folder";
  stage: StageKind | undefined; // undefined: text that several stages share
  source: string; // the whole file, and what it includes of the program
  parameters: readonly ParameterDescription[];
}

export interface Help {
  name: string;
  kind: "function" | "constant" | "macro" | "struct" | "variable" | "keyword" | "type" | "parameter" | "builtin";
  signature: string;
  text: string; // Markdown
  origin: string; // "camera.glsl of the shader library"
  include?: string; // header that declares it
  wrongStage?: boolean;
}

const symbols = library.symbols as LibrarySymbol[];
const stagesOf = new Map(library.builtIns.map((builtIn) => [builtIn.name, builtIn.stages as StageKind[]]));
const byName = {
  lecture: new Map(symbols.filter((symbol) => symbol.form === "lecture").map((symbol) => [symbol.name, symbol])),
  library: new Map(symbols.filter((symbol) => symbol.form === "library").map((symbol) => [symbol.name, symbol])),
};

export const libraryIncludes: readonly string[] = library.includes;

// Names of the library are visible in folders, and in lecture files that include it.
export function usesLibrary(context: GlslContext): boolean {
  return context.form === "folder" || /#\s*include\s*<quintet\//.test(context.source);
}

function fits(stages: readonly StageKind[] | undefined, stage: StageKind | undefined): boolean {
  return stages === undefined || stage === undefined || stages.includes(stage);
}

function ofSymbol(symbol: LibrarySymbol): Help {
  return {
    name: symbol.name,
    kind: symbol.kind,
    signature: symbol.signature,
    text: symbol.help,
    origin: symbol.form === "lecture" ? "predeclared" : `quintet/${symbol.file}`,
    ...(symbol.form === "library" && { include: `quintet/${symbol.file}` }),
  };
}

function stageText(stages: readonly StageKind[]): string {
  return stages.length === 6 ? "all stages" : stages.map((stage) => kStageNames[stage].toLowerCase()).join(", ");
}

function ofBuiltIn(name: string): Help | undefined {
  const word = kRayBuiltIns.get(name);
  const stages = stagesOf.get(name);
  if (word && stages) return { name, kind: "builtin", signature: word.signature, text: word.help, origin: `in: ${stageText(stages)}` };
  const constant = kRayConstants.get(name);
  if (constant) return { name, kind: "constant", signature: constant.signature, text: constant.help, origin: "GL_EXT_ray_tracing" };
  const func = kFunctions.get(name);
  return func && { name, kind: "function", signature: func.signature, text: func.help, origin: "GLSL" };
}

export function parameterHelp(parameter: ParameterDescription): Help {
  const parts = [`default ${Array.isArray(parameter.default) ? parameter.default.join(", ") : String(parameter.default)}`];
  if (parameter.min !== null && parameter.max !== null) parts.push(`${parameter.min} to ${parameter.max}`);
  else if (parameter.min !== null) parts.push(`at least ${parameter.min}`);
  else if (parameter.max !== null) parts.push(`at most ${parameter.max}`);
  if (parameter.unit) parts.push(parameter.unit);
  return { name: parameter.name, kind: "parameter", signature: `${parameter.type} ${parameter.name}`, text: parameter.help ?? "", origin: `parameter: ${parts.join(", ")}` };
}

export interface Declaration {
  name: string;
  kind: "function" | "struct" | "constant" | "variable" | "macro";
  signature: string;
  type: string;
}

const kNotTypes = new Set(["return", "else", "case", "goto", "new", "const", "in", "out", "inout", "struct", "discard", "precise"]);

// Functions, structs, constants and variables that a source declares, without resolving scopes.
export function declarations(source: string): Declaration[] {
  const found = new Map<string, Declaration>();
  const add = (declaration: Declaration) => {
    if (!found.has(declaration.name) && !kKeywords.has(declaration.name) && !kTypes.has(declaration.name)) found.set(declaration.name, declaration);
  };
  const code = source.replace(/\/\*[\s\S]*?\*\//g, " ").replace(/\/\/[^\n]*/g, "");
  for (const match of code.matchAll(/\bstruct\s+(\w+)\s*\{([^}]*)\}/g))
    add({ name: match[1]!, kind: "struct", signature: `struct ${match[1]} {${match[2]!.replace(/\s*\n\s*/g, "\n  ").replace(/\n {2}$/, "\n")}}`, type: match[1]! });
  for (const match of code.matchAll(/^#\s*define\s+(\w+)(\([^)]*\))?\s*(.*)$/gm))
    add({ name: match[1]!, kind: "macro", signature: `#define ${match[1]}${match[2] ?? ""} ${match[3]}`.trim(), type: "" });
  for (const match of code.matchAll(/\b([A-Za-z_]\w*)\s+([A-Za-z_]\w*)\s*\(([^(){};]*)\)\s*\{/g))
    if (!kNotTypes.has(match[1]!) && match[2] !== "main") add({ name: match[2]!, kind: "function", signature: `${match[1]} ${match[2]}(${match[3]!.replace(/\s+/g, " ")})`, type: match[1]! });
  for (const match of code.matchAll(/\b(const\s+)?([A-Za-z_]\w*)\s+([A-Za-z_]\w*)\s*(?:\[[^\]]*\])?\s*(=\s*[^;,]+)?(?=[;,)])/g))
    if (!kNotTypes.has(match[2]!) && (kTypes.has(match[2]!) || /^[A-Z]/.test(match[2]!)))
      add({
        name: match[3]!,
        kind: match[1] ? "constant" : "variable",
        signature: `${match[1] ? "const " : ""}${match[2]} ${match[3]}${match[1] && match[4] ? ` ${match[4].trim().slice(0, 60)}` : ""}`,
        type: match[2]!,
      });
  for (const match of code.matchAll(/\b([A-Za-z]\w*)\s+([A-Za-z_]\w*(?:\s*,\s*[A-Za-z_]\w*)+)\s*;/g))
    if (kTypes.has(match[1]!))
      for (const name of match[2]!.split(",")) add({ name: name.trim(), kind: "variable", signature: `${match[1]} ${name.trim()}`, type: match[1]! });
  return [...found.values()];
}

// Returns undefined for a name that the page knows nothing about.
export function helpFor(name: string, context: GlslContext): Help | undefined {
  const parameter = context.parameters.find((candidate) => candidate.name === name);
  if (parameter) return parameterHelp(parameter);
  if (context.form === "lecture") {
    const symbol = byName.lecture.get(name);
    const type = { payload: "RayPayloadType", hit: "HitAttributeType", callableData: "CallableDataType" }[name];
    if (symbol) {
      const struct = type && declarations(context.source).find((candidate) => candidate.name === type);
      return { ...ofSymbol(symbol), ...(struct && { signature: `${type} ${name};\n${struct.signature}` }), wrongStage: !fits(symbol.stages, context.stage) };
    }
  }
  const builtIn = ofBuiltIn(name);
  if (builtIn) return { ...builtIn, wrongStage: !fits(stagesOf.get(name), context.stage) };
  const declared = declarations(context.source).find((candidate) => candidate.name === name);
  if (declared) return { ...declared, text: "", origin: "this program" };
  const symbol = usesLibrary(context) ? byName.library.get(name) : undefined;
  return symbol && ofSymbol(symbol);
}

// All names that can be written here.
export function visibleNames(context: GlslContext): Help[] {
  const all: Help[] = [];
  const seen = new Set<string>();
  const add = (help: Help | undefined) => {
    if (!help || seen.has(help.name)) return;
    seen.add(help.name);
    all.push(help);
  };
  for (const parameter of context.parameters) add(parameterHelp(parameter));
  for (const declared of declarations(context.source)) add({ ...declared, text: "", origin: "this program" });
  if (context.form === "lecture") for (const symbol of byName.lecture.values()) if (fits(symbol.stages, context.stage)) add(ofSymbol(symbol));
  for (const name of kRayBuiltIns.keys()) if (fits(stagesOf.get(name), context.stage)) add(ofBuiltIn(name));
  for (const table of [kRayConstants, kFunctions]) for (const name of table.keys()) add(ofBuiltIn(name));
  if (usesLibrary(context)) for (const symbol of byName.library.values()) add(ofSymbol(symbol));
  for (const name of kTypes) add({ name, kind: "type", signature: name, text: "", origin: "GLSL" });
  for (const name of kKeywords) add({ name, kind: "keyword", signature: name, text: "", origin: "GLSL" });
  return all;
}

function structMembers(signature: string): { name: string; signature: string }[] {
  const body = /\{([\s\S]*)\}/.exec(signature)?.[1] ?? "";
  const members: { name: string; signature: string }[] = [];
  for (const match of body.matchAll(/([A-Za-z_]\w*)\s+([A-Za-z_][\w\s,[\]]*);[ \t]*(\/\/[^\n]*)?/g))
    for (const name of match[2]!.split(",")) {
      const plain = name.trim().replace(/\[.*$/, "");
      if (plain) members.push({ name: plain, signature: `${match[1]} ${name.trim()}${match[3] ? `  ${match[3].trim()}` : ""}` });
    }
  return members;
}

// Members of the variable before a dot; empty if its type is unknown.
export function membersOf(variable: string, context: GlslContext): { name: string; signature: string }[] {
  if (variable === "parameters" && context.form === "folder")
    return context.parameters.map((parameter) => ({ name: parameter.name, signature: `${parameter.type} ${parameter.name}` }));
  const declared = declarations(context.source);
  const predeclared: Record<string, string> = { payload: "RayPayloadType", hit: "HitAttributeType", callableData: "CallableDataType" };
  const type = declared.find((candidate) => candidate.name === variable && candidate.kind !== "struct")?.type ?? (context.form === "lecture" ? predeclared[variable] : undefined);
  if (!type) return [];
  const vector = /^[biud]?vec([234])$/.exec(type);
  if (vector) {
    const count = Number(vector[1]);
    return [..."xyzw".slice(0, count), "xy", "xyz", "rgb"].filter((name) => name.length <= count).map((name) => ({ name, signature: `${name} of ${type}` }));
  }
  const struct = declared.find((candidate) => candidate.kind === "struct" && candidate.name === type)?.signature ?? byName.library.get(type)?.signature;
  return struct ? structMembers(struct) : [];
}
