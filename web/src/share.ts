// SPDX-License-Identifier: Apache-2.0
// Files to share: a page without references to other files that shows image, sources and parameters; downloads.
import { highlightCode, tags, tagHighlighter } from "@lezer/highlight";
import { StreamLanguage } from "@codemirror/language";
import { toml } from "@codemirror/legacy-modes/mode/toml";
import { glslLanguage } from "./glsl_language";
import type { ParameterValue } from "./protocol";

export function download(content: Blob, name: string): void {
  const address = URL.createObjectURL(content);
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

export function escapeHtml(text: string): string {
  return text.replace(/[&<>"']/g, (character) => `&#${character.charCodeAt(0)};`);
}

const highlighter = tagHighlighter([
  { tag: tags.comment, class: "c" },
  { tag: [tags.keyword, tags.processingInstruction, tags.heading], class: "k" },
  { tag: tags.typeName, class: "t" },
  { tag: [tags.number, tags.atom, tags.bool], class: "n" },
  { tag: tags.string, class: "s" },
  { tag: tags.standard(tags.variableName), class: "b" },
  { tag: tags.function(tags.variableName), class: "f" },
]);

export type CodeLanguage = "glsl" | "toml" | "text";

const languages = { glsl: glslLanguage, toml: StreamLanguage.define(toml) };

// Parts of a source with the class of their color; "" for plain text.
export function colored(text: string, language: CodeLanguage): [string, string][] {
  if (language === "text") return [[text, ""]];
  const parts: [string, string][] = [];
  highlightCode(text, languages[language].parser.parse(text), highlighter, (code, classes) => parts.push([code, classes]), () => parts.push(["\n", ""]));
  return parts;
}

export function languageOf(path: string): CodeLanguage {
  if (path.endsWith(".toml")) return "toml";
  return /\.(glsl|rgen|rchit|rahit|rint|rmiss|rcall|h)$/.test(path) ? "glsl" : "text";
}

export interface SharedProgram {
  title: string;
  version: string;
  scene: string;
  device: string;
  output: string;
  samples: string; // "64 samples per pixel"
  parameters: Readonly<Record<string, ParameterValue>>;
  image: string; // data: address, empty without an image
  width: number;
  height: number;
  files: readonly { path: string; text: string }[];
}

const kStyle = `:root{color-scheme:light dark;--b:#fff;--t:#1b1f24;--s:#57606a;--l:#d5d9de;--p:#f5f6f8;--c:#667085;--k:#8a2be2;--ty:#0b6e6e;--n:#9a4a00;--st:#2b7a1f;--bi:#0b5cad;--f:#7a4b00}
@media(prefers-color-scheme:dark){:root{--b:#16181c;--t:#e3e6ea;--s:#a0a7b0;--l:#33383f;--p:#1e2126;--c:#8b95a3;--k:#c79bf2;--ty:#63c7c1;--n:#eba36b;--st:#93cf7d;--bi:#79b8f3;--f:#e0bf78}}
body{margin:0 auto;padding:24px;max-width:1000px;background:var(--b);color:var(--t);font:15px/1.5 system-ui,sans-serif}
h1{font-size:24px;margin:0 0 2px}h2{font:600 14px ui-monospace,monospace;margin:28px 0 6px}p{color:var(--s);margin:0 0 16px}
img{max-width:100%;height:auto;display:block;margin:0 0 16px}table{border-collapse:collapse;margin:0 0 16px}
td,th{padding:2px 16px 2px 0;text-align:left;font-weight:400}th{color:var(--s)}
pre{background:var(--p);border:1px solid var(--l);border-radius:4px;padding:12px;overflow:auto;font:13px/1.5 ui-monospace,monospace;tab-size:2;margin:0}
.c{color:var(--c)}.k{color:var(--k)}.t{color:var(--ty)}.n{color:var(--n)}.s{color:var(--st)}.b{color:var(--bi)}.f{color:var(--f)}`;

export function sharedPage(program: SharedProgram): string {
  const escape = escapeHtml;
  const code = (path: string, text: string) =>
    colored(text, languageOf(path))
      .map(([part, name]) => (name ? `<span class="${name}">${escape(part)}</span>` : escape(part)))
      .join("");
  const value = (parameter: ParameterValue) => (Array.isArray(parameter) ? parameter.join(", ") : String(parameter));
  const rows = Object.entries(program.parameters).map(([name, parameter]) => `<tr><th>${escape(name)}</th><td>${escape(value(parameter))}</td></tr>`);
  const facts = [program.scene && `scene ${program.scene}`, `output ${program.output}`, `${program.width} × ${program.height}`, program.samples, program.device, `Quintet ${program.version}`].filter(Boolean);
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>${escape(program.title)}</title>
<style>${kStyle}</style>
</head>
<body>
<h1>${escape(program.title)}</h1>
<p>${escape(facts.join(" · "))}</p>
${program.image ? `<img src="${program.image}" width="${program.width}" height="${program.height}" alt="Image of ${escape(program.title)}">` : ""}
${rows.length > 0 ? `<table>${rows.join("")}</table>` : ""}
${program.files.map((file) => `<h2>${escape(file.path)}</h2>\n<pre><code>${code(file.path, file.text)}</code></pre>`).join("\n")}
</body>
</html>
`;
}
