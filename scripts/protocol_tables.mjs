#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Writes the tables of messages in pages below docs/ from the files that describe the messages
// (src/job/interactive/message_schema.h explains their keys).
//   node scripts/protocol_tables.mjs            updates the pages
//   node scripts/protocol_tables.mjs --check    only reports tables that differ; exit status 1 if any
//   node scripts/protocol_tables.mjs --self-test   shows that differences are found
//
// A page marks a table by a comment before it. The files are relative to the root of the repository:
//   <!-- protocol: commands of FILE… -->     also: events, types
//   <!-- protocol: binary NAME of FILE… -->  the header of a binary message
import assert from "node:assert/strict";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { fieldsOf, readProtocol } from "../web/build/protocol.mjs";

const root = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
const kMarker = /^<!-- protocol: (commands|events|types|binary) ?(\w*) of (.*) -->$/;
const kWords = { text: "text", number: "number", whole: "whole number", index: "whole number", count: "whole number", flag: "flag", null: "`null`" };

const joined = (words) => (words.length < 3 ? words.join(" or ") : `${words.slice(0, -1).join(", ")} or ${words.at(-1)}`);

// The alternatives of a type in words; `ending` makes plurals.
function alternativesOf(types, type, ending = "") {
  const parts = type.split("|");
  if (parts.length > 1) return parts.flatMap((part) => alternativesOf(types, part, ending));
  if (type.endsWith("{}")) return [`object${ending} of ${joined(alternativesOf(types, type.slice(0, -2), "s"))}`];
  const list = /^(.*)\[(\d*)\]$/.exec(type);
  if (list) return [`list${ending} of ${list[2] && `${list[2]} `}${joined(alternativesOf(types, list[1], "s"))}`];
  const { is, values, fields } = types[type] ?? {};
  if (is) return alternativesOf(types, is, ending);
  if (values) return values.map((value) => `\`${value}\``);
  if (fields) return [`\`${type}\``];
  return [(kWords[type] ?? "object") + (type === "null" ? "" : ending)];
}

function fieldText(types, field, isOneOfSeveral) {
  const { type, unit, above, max, help, otherwise } = field;
  const isNumber = kWords[type]?.endsWith("number");
  const range = max === undefined ? (type === "count" && !unit ? "from 1" : "") : above === undefined ? `1 to ${max}` : `above ${above}, at most ${max}`;
  const value = JSON.stringify(field.default)?.replace(/^"(.*)"$/, "$1");
  const missing = otherwise ?? (value ? `\`${value}\`` : field.optional && !isOneOfSeveral ? "optional" : "");
  return [isNumber && unit ? "" : joined(alternativesOf(types, type)), unit, range, help].filter(Boolean).join(", ") + (missing && ` (${missing})`);
}

// Fields in sequence that have the same text share it.
function keysText(types, { fields, others, atLeastOne }) {
  const groups = [];
  for (const [name, field] of fieldsOf(fields)) {
    const text = fieldText(types, field, atLeastOne);
    if (groups.at(-1)?.text === text) groups.at(-1).names.push(name);
    else groups.push({ names: [name], text });
  }
  const parts = groups.map(({ names, text }) => `${names.map((name) => `\`${name}\``).join(", ")}: ${text}`);
  if (others) parts.push(`further keys: ${joined(alternativesOf(types, others))}`);
  if (atLeastOne) parts.push("at least one");
  return parts.join("; ");
}

function tableOf(kind, name, files) {
  const protocol = readProtocol(root, files.split(" "));
  const all = readProtocol(root);
  const types = { ...all.types, ...protocol.types };
  const rows = Object.entries(protocol[kind]).flatMap(([key, value]) => {
    if (kind === "types") return value.fields ? [[`\`${key}\``, keysText(types, value)]] : [];
    if (kind !== "binary") return [[`\`${key}\``, keysText(types, value), value.help]];
    if (key !== name) return [];
    const header = [["0–3", `\`${value.magic}\``], ["4–7", `version ${value.version}`]];
    return [...header, ...Object.values(value.fields).map(({ at, bytes, help }) => [bytes > 1 ? `${at}–${at + bytes - 1}` : `${at}`, help])];
  });
  const titles = { commands: ["command", "keys", "effect"], events: ["event", "keys", "meaning"], types: ["type", "keys"], binary: ["bytes", "content"] }[kind];
  return [titles, titles.map(() => "---"), ...rows].map((cells) => `|${cells.map((cell) => (cell ? ` ${cell} |` : " |")).join("")}`);
}

function filled(text) {
  const lines = [];
  let inTable = false;
  for (const line of text.split("\n")) {
    inTable = inTable && line.startsWith("|");
    if (!inTable) lines.push(line);
    const marker = kMarker.exec(line);
    if (!marker) continue;
    lines.push(...tableOf(...marker.slice(1)));
    inTable = true;
  }
  return lines.join("\n");
}

if (process.argv[2] === "--self-test") {
  const marker = "<!-- protocol: events of src/lab/lab_protocol.json -->";
  const page = filled(`Text.\n${marker}\n\nMore.\n`);
  assert.match(page, /^Text.\n<!-- .* -->\n\| event \| keys \| meaning \|\n\| --- \| --- \| --- \|\n\| `worker` \|[^]*\| `done` \| \| .* \|\n\nMore.\n$/);
  assert.equal(filled(page), page);
  assert.equal(filled(page.replace("`worker`", "`wroker`").replace("| event", "| old")), page);
  assert.throws(() => filled(marker.replace("lab_protocol", "missing")));
  process.exit(0);
}

let differing = 0;
for (const page of readdirSync(path.join(root, "docs"), { recursive: true }).filter((name) => name.endsWith(".md"))) {
  const file = path.join(root, "docs", page);
  const text = readFileSync(file, "utf8");
  const current = filled(text);
  if (current === text) continue;
  if (process.argv[2] !== "--check") writeFileSync(file, current);
  else {
    const line = current.split("\n").findIndex((other, i) => other !== text.split("\n")[i]) + 1;
    console.error(`docs/${page}:${line}: a table differs from the protocol; run: node scripts/protocol_tables.mjs`);
    ++differing;
  }
}
process.exit(differing > 0 ? 1 : 0);
