// SPDX-License-Identifier: Apache-2.0
// Commands of the lesson pages, such as `quintet run lessons/05_shadow --set lampRadius=12 -o wide.png`, as actions of the
// page. Commands that the page has no equivalent for belong into a terminal.
import type { ParameterDescription, ParameterValue } from "./protocol";

export interface RunCommand {
  kind: "run";
  program: string; // "mine": the user's copy; else a built-in program, "lessons/05_shadow"
  parameters: Record<string, string>;
  frames: number; // of a program that counts them; the last one is shown
  plays: boolean; // each frame becomes a file
  size?: [number, number];
  output?: string;
  file: string; // that the command writes; empty if unknown
}

export type LessonCommand =
  | RunCommand
  | { kind: "problems"; program: string; status: string }
  | { kind: "instrument"; program: string }
  | { kind: "pipeline"; program: string }
  | { kind: "original"; program: string }
  | { kind: "parameters"; program: string }
  | { kind: "compare"; files: [string, string] }
  | { kind: "terminal" };

const kTerminal: LessonCommand = { kind: "terminal" };

// A line of a code block without the comment at its end; undefined if it is no command.
export function commandLine(line: string): string | undefined {
  const command = line.replace(/\s+#\s.*$/, "").trim();
  return /^quintet [a-z]/.test(command) ? command : undefined;
}

// Names that a user gives to a copy: "mine.rt.glsl" and "mine/program.toml" are the program "mine".
function programName(argument: string): string {
  return argument.replace(/\.rt\.glsl$/, "").replace(/\/program\.toml$/, "").replace(/\/$/, "");
}

function parseRun(words: string[]): LessonCommand {
  const run: RunCommand = { kind: "run", program: "", parameters: {}, frames: 1, plays: false, file: "" };
  for (let i = 0; i < words.length; ++i) {
    const word = words[i]!;
    if (!word.startsWith("-")) {
      if (run.program) return kTerminal;
      run.program = programName(word);
      continue;
    }
    if (word === "--watch") continue; // the page does so always
    if (word === "--help") return { kind: "parameters", program: run.program };
    const value = words[++i];
    if (value === undefined) return kTerminal;
    if (word === "--set") {
      const [, name, text] = /^(\w+)=(.*)$/.exec(value) ?? [];
      if (!name) return kTerminal;
      run.parameters[name] = text!;
    } else if (word === "--frames" && /^\d+$/.test(value)) run.frames = Number(value);
    else if (word === "--size" && /^\d+x\d+$/.test(value)) run.size = value.split("x").map(Number) as [number, number];
    else if (word === "--output") run.output = value;
    else if (word === "-o") {
      run.file = value;
      run.plays = value.includes("%");
    } else if (word !== "--spp") return kTerminal; // the image of the page has more samples
  }
  return run.program ? run : kTerminal;
}

// `expected`: the status that the page of the lesson states for the command, such as "status 1 Q502"; empty if none.
export function parseCommand(line: string, expected = ""): LessonCommand {
  const words = line.split(/\s+/);
  const [, verb, ...rest] = words;
  if (verb === "run") return parseRun(rest);
  const [first] = rest;
  if (!first || first.startsWith("-")) return kTerminal;
  if (verb === "check" && rest.length === 1) return { kind: "problems", program: programName(first), status: expected };
  if (verb === "check" && rest.length === 2 && rest[1] === "--instrument") return { kind: "instrument", program: programName(first) };
  if (verb === "check" && rest.length === 3 && rest[1] === "--graph") return { kind: "pipeline", program: programName(first) };
  if (verb === "new" && rest.length === 3 && rest[1] === "--from") return { kind: "original", program: rest[2]! };
  if (verb === "compare" && rest.length >= 2 && !rest[1]!.startsWith("-")) return { kind: "compare", files: [first, rest[1]!] };
  return kTerminal;
}

// "12", "1,2,3", "true" and "name" as values of the protocol.
export function valueOf(text: string): ParameterValue {
  if (text === "true" || text === "false") return text === "true";
  const numbers = text.split(",").map(Number);
  if (text === "" || numbers.some(Number.isNaN)) return text;
  return numbers.length === 1 ? numbers[0]! : numbers;
}

// The values of all parameters for a command: those that it does not set have their defaults.
export function parameterValues(descriptions: readonly ParameterDescription[], set: Record<string, string>): Record<string, ParameterValue> {
  return Object.fromEntries(
    descriptions.map(({ name, type, default: initial }) => {
      const text = set[name];
      if (text === undefined) return [name, initial];
      const value = valueOf(text);
      return [name, type === "bool" && typeof value === "number" ? value !== 0 : value];
    }),
  );
}

// What a command does, for its button: "lampRadius = 12 · frame 13".
export function effectText(run: RunCommand): string {
  const parts = Object.entries(run.parameters).map(([name, text]) => `${name} = ${text.replaceAll(",", ", ")}`);
  if (run.output) parts.push(`output ${run.output}`);
  if (run.plays) parts.push("all frames");
  else if (run.frames > 1) parts.push(`${run.frames} frames`);
  if (run.size) parts.push(`${run.size[0]} × ${run.size[1]} pixels`);
  return parts.join(" · ");
}
