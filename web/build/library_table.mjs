// SPDX-License-Identifier: Apache-2.0
// The table of names for completion and hover help, read from the sources that define them: the headers of
// shaders/quintet, docs/glsl.md, the predeclared names of docs/lecture-form.md, and the built-ins of each stage in
// src/shader/stage_builtins.cpp. Each symbol: {name, kind, signature, file, help, form, stages}.
import { readFile, readdir } from "node:fs/promises";
import path from "node:path";

// Headers that programs do not include by themselves.
const kInternal = /^(gsn|passes|stages)\/|^(gsn|names_begin|names_end|explain|instrument|recursion|print|heat|log)\.glsl$/;

const kStages = {
  kRayGeneration: ["rgen"],
  kIntersection: ["rint"],
  kAnyHit: ["rahit"],
  kClosestHit: ["rchit"],
  kMiss: ["rmiss"],
  kCallable: ["rcall"],
};
kStages.kHit = [...kStages.kAnyHit, ...kStages.kClosestHit];
kStages.kPrimitive = [...kStages.kIntersection, ...kStages.kHit];
kStages.kRay = [...kStages.kPrimitive, ...kStages.kMiss];
kStages.kAll = [...kStages.kRay, ...kStages.kRayGeneration, ...kStages.kCallable];

async function filesBelow(folder, prefix = "") {
  const files = [];
  for (const entry of await readdir(path.join(folder, prefix), { withFileTypes: true })) {
    const name = prefix ? `${prefix}/${entry.name}` : entry.name;
    if (entry.isDirectory()) files.push(...(await filesBelow(folder, name)));
    else if (/\.(glsl|h)$/.test(entry.name)) files.push(name);
  }
  return files.sort();
}

// The comment block that ends before line `index`, as one paragraph.
function commentBefore(lines, index) {
  const block = [];
  for (let i = index - 1; i >= 0 && /^\/\//.test(lines[i]); --i) block.unshift(lines[i].replace(/^\/\/ ?/, ""));
  const text = block.join(" ").trim();
  return text.startsWith("SPDX") ? "" : text;
}

export function headerSymbols(file, text) {
  const lines = text.split("\n");
  const symbols = [];
  for (let i = 0; i < lines.length; ++i) {
    const line = lines[i];
    const func = /^(?:[A-Za-z_]\w*(?:\[\])? )+(\w+)\(([^;{]*)\)?\s*(?:\{.*)?$/.exec(line);
    if (func && !/^(layout|struct|return|else|if|for|while|const )/.test(line) && !line.includes("=")) {
      let declaration = line;
      for (let j = i; !declaration.includes(")") && j + 1 < lines.length; ++j) declaration += ` ${lines[j + 1].trim()}`;
      const signature = declaration.slice(0, declaration.indexOf(")") + 1).replace(/\s+/g, " ");
      symbols.push({ name: func[1], kind: "function", signature, help: commentBefore(lines, i) });
      continue;
    }
    const constant = /^(?:QUINTET_CONSTANT|const|constexpr)\s+(\w+)\s+(k\w+)(?:\[[^\]]*\])?\s*=\s*([^;]+);\s*(?:\/\/\s*(.*))?$/.exec(line);
    if (constant) {
      symbols.push({
        name: constant[2],
        kind: "constant",
        signature: `const ${constant[1]} ${constant[2]} = ${constant[3].trim().slice(0, 80)}`,
        help: constant[4] ?? commentBefore(lines, i),
      });
      continue;
    }
    const macro = /^#define (explain[A-Z]\w*\([^)]*\))/.exec(line);
    if (macro) {
      symbols.push({ name: macro[1].split("(")[0], kind: "macro", signature: macro[1], help: commentBefore(lines, i) });
      continue;
    }
    const struct = /^struct (\w+) \{/.exec(line);
    if (struct) {
      const members = [];
      for (let j = i + 1; j < lines.length && !lines[j].startsWith("}"); ++j)
        if (lines[j].trim() && !lines[j].trim().startsWith("#")) members.push(lines[j].replace(/^ {2}/, ""));
      symbols.push({
        name: struct[1],
        kind: "struct",
        signature: `struct ${struct[1]} {\n  ${members.join("\n  ")}\n}`,
        help: commentBefore(lines, i),
      });
    }
  }
  return symbols.filter((symbol) => !symbol.name.endsWith("_")).map((symbol) => ({ ...symbol, file }));
}

// Rows "| `name(arguments)`, `other` | text |" of the tables of a page. Returns a map from name to {signature, help}.
export function tableRows(markdown) {
  const rows = new Map();
  for (const line of markdown.split("\n")) {
    const row = /^\| (`.*?`[^|]*) \| (.*) \|$/.exec(line.replaceAll("\\|", "\u0001"));
    if (!row) continue;
    const help = row[2].replaceAll("\u0001", "|").replace(/\[([^\]]*)\]\([^)]*\)/g, "$1");
    for (const code of row[1].matchAll(/`([^`]+)`/g)) {
      const signature = code[1].replaceAll("\u0001", "|");
      const name = /(\w+)\s*(?:\(|$)/.exec(signature)?.[1];
      if (name && !/[\/."<*#]/.test(signature) && !rows.has(name)) rows.set(name, { signature, help });
    }
  }
  return rows;
}

export function stageBuiltIns(source) {
  const symbols = [];
  for (const row of source.matchAll(/\{"(\w+)", ([kA-Za-z |]+)(, true)?\}/g))
    symbols.push({
      name: row[1],
      isFunction: row[3] !== undefined,
      stages: [...new Set(row[2].split("|").flatMap((name) => kStages[name.trim()] ?? []))],
    });
  return symbols;
}

function section(markdown, heading) {
  const start = markdown.indexOf(`\n## ${heading}`);
  if (start < 0) throw new Error(`docs/lecture-form.md has no section '${heading}'`);
  const end = markdown.indexOf("\n## ", start + 4);
  return markdown.slice(start, end < 0 ? undefined : end);
}

// Names of the ray generation shader alone; the shaders of hits; and those of intersections.
const kLectureStages = {
  gsnSetPixel: ["rgen"],
  gsnGetPreviousPixel: ["rgen"],
  baryCoord: ["rchit", "rahit"],
  hit: ["rchit", "rahit", "rint"],
  payload: ["rgen", "rchit", "rahit", "rmiss"],
  topLevelAS: ["rgen", "rchit", "rmiss"],
};

export async function libraryTable(root) {
  const folder = path.join(root, "shaders/quintet");
  const help = tableRows(await readFile(path.join(root, "docs/glsl.md"), "utf8"));
  const symbols = [];
  const includes = [];
  for (const file of await filesBelow(folder)) {
    if (kInternal.test(file)) continue;
    if (file.endsWith(".glsl")) includes.push(file);
    for (const symbol of headerSymbols(file, await readFile(path.join(folder, file), "utf8"))) {
      const documented = help.get(symbol.name);
      symbols.push({ ...symbol, help: documented?.help ?? symbol.help, form: "library" });
    }
  }
  const lecture = await readFile(path.join(root, "docs/lecture-form.md"), "utf8");
  for (const [first, row] of tableRows(section(lecture, "Predeclared names"))) {
    if (row.signature.startsWith("gl_")) continue;
    // The rows "userParam0 … userParam2" and "texture0 … texture4" name the first and the last one.
    const range = /^(userParam|texture)0$/.exec(first);
    const names = range ? Array.from({ length: range[1] === "texture" ? 5 : 3 }, (_, i) => range[1] + i) : [first];
    for (const name of names)
      symbols.push({
        name,
        kind: row.signature.includes("(") ? "function" : "variable",
        signature: range ? name : row.signature,
        file: "",
        help: row.help,
        form: "lecture",
        stages: kLectureStages[name],
      });
  }
  const builtIns = stageBuiltIns(await readFile(path.join(root, "src/shader/stage_builtins.cpp"), "utf8"));
  const unique = [...new Map([...symbols].reverse().map((symbol) => [symbol.form + symbol.name, symbol])).values()].reverse();
  if (unique.length < 200 || builtIns.length < 20) throw new Error("the table of the shader library is incomplete");
  return { includes, symbols: unique, builtIns };
}

if (process.argv[1] === new URL(import.meta.url).pathname) {
  const table = await libraryTable(process.argv[2] ?? "..");
  console.log(JSON.stringify(table, null, 1));
}
