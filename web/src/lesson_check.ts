// SPDX-License-Identifier: Apache-2.0
// Checks a task of a lesson: runs the user's program and the solution in a session of their own, and compares images, or
// values.
import { Connection } from "./connection";
import type { Diagnostic } from "./diagnostic";
import { compareImages, type ImageDifference, kAllowedShare } from "./image_difference";
import { acceptedTasks, type LessonTask, solutionFiles } from "./lesson_tasks";
import type { Command, EventName, EventOf, ImageMessage, ParameterValue } from "./protocol";
import { compareMeans, comparePayloads, comparePrints, type ValueComparison, type ValueResult } from "./value_comparison";

export const kCheckSize = { width: 240, height: 135 };
const kTimeout = 60_000; // ms

export interface CheckResult {
  passed: boolean;
  message: string;
  yours?: ImageBitmap;
  expected?: ImageBitmap;
  difference?: ImageDifference;
}

type Sources = Record<string, string>; // by name in the folder

interface RenderedValues {
  samples?: number; // or frames; 1 by default
  parameters?: Record<string, ParameterValue>;
}

class Renderer {
  private readonly link: Connection;
  private waiting: { resolve: (image: ImageMessage) => void; reject: (error: Error) => void } | undefined;
  private ready: (() => void) | undefined;
  private fail: ((error: Error) => void) | undefined;
  printed: string[] = []; // since the last open() or print()

  constructor() {
    this.link = new Connection({
      onConnect: () => this.ready?.(),
      onState: (state, message) => {
        if (state === "refused" || state === "full" || state === "lost") this.stop(message || "The server does not answer");
      },
      onEvent: (event) => {
        if (event.event === "diagnostics") {
          const error = event.diagnostics.find((diagnostic: Diagnostic) => diagnostic.severity === "error");
          if (error) this.stop(`${error.file.replace(/^.*\//, "")}:${error.line}: ${error.text}`);
        } else if (event.event === "error") this.stop(event.message);
        else if (event.event === "printed") this.printed.push(...event.lines.map((line) => line.text));
        else if (event.event === "worker" && (event.state === "crashed" || event.state === "hung" || event.state === "waiting")) this.stop(event.message);
      },
      onImage: (image) => {
        this.link.send({ do: "received", image: image.number });
        if (!image.complete || image.mime !== "image/png") return;
        this.waiting?.resolve(image);
        this.waiting = undefined;
      },
    });
  }

  connect(): Promise<void> {
    return new Promise((resolve, reject) => {
      this.ready = resolve;
      this.fail = reject;
      this.link.connect();
    });
  }

  render(files: Sources, task: RenderedValues): Promise<ImageMessage> {
    return this.imageAfter({ do: "open", files, ...kCheckSize, samples: task.samples ?? 1, parameters: task.parameters ?? {} });
  }

  // Renders again, and returns what the program prints for a pixel.
  async print(pixel: readonly [number, number]): Promise<string[]> {
    this.printed = [];
    await this.imageAfter({ do: "print", x: pixel[0], y: pixel[1] });
    return this.printed;
  }

  ask<K extends EventName>(command: Command, wanted: K): Promise<EventOf<K>> {
    return this.link.request(command, wanted);
  }

  close(): void {
    this.link.close();
  }

  cancel(): void {
    this.stop("The check was canceled");
    this.close();
  }

  private imageAfter(command: Command): Promise<ImageMessage> {
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => this.stop("The render took too long"), kTimeout);
      const end = () => clearTimeout(timer);
      this.waiting = {
        resolve: (image) => (end(), resolve(image)),
        reject: (error) => (end(), reject(error)),
      };
      this.link.send(command);
    });
  }

  private stop(message: string): void {
    const error = new Error(message);
    this.fail?.(error);
    this.waiting?.reject(error);
    this.waiting = undefined;
  }
}

// Values that a comparison reads from the program that the renderer shows.
async function readValues(renderer: Renderer, comparison: ValueComparison) {
  switch (comparison.kind) {
    case "mean": {
      const means = [];
      for (const block of comparison.blocks) means.push((await renderer.ask({ do: "value", ...block }, "value")).value);
      return { means };
    }
    case "payload": {
      const [x, y] = comparison.pixel;
      return { explanation: (await renderer.ask({ do: "explain", x, y }, "explained")).explanation };
    }
    case "printed":
      return { lines: await renderer.print(comparison.pixel) };
  }
}

type Values = Awaited<ReturnType<typeof readValues>>;

function compareValues(comparison: ValueComparison, yours: Values, wanted: Values): ValueResult {
  switch (comparison.kind) {
    case "mean":
      return compareMeans(comparison.blocks, comparison.tolerance, yours.means!, wanted.means!);
    case "payload":
      return comparePayloads(comparison.pixel, comparison.member, yours.explanation!, wanted.explanation!);
    case "printed":
      return comparePrints(comparison.pixel, yours.lines!, wanted.lines!);
  }
}

async function decode(image: ImageMessage): Promise<{ bitmap: ImageBitmap; data: Uint8ClampedArray }> {
  const bitmap = await createImageBitmap(new Blob([image.file], { type: image.mime }), { colorSpaceConversion: "none" });
  const canvas = document.createElement("canvas");
  canvas.width = bitmap.width;
  canvas.height = bitmap.height;
  const context = canvas.getContext("2d", { willReadFrequently: true })!;
  context.drawImage(bitmap, 0, 0);
  return { bitmap, data: context.getImageData(0, 0, bitmap.width, bitmap.height).data };
}

// How far a result is from the solution.
const distanceOf = (result: CheckResult) => (result.passed ? -1 : (result.difference?.differing ?? 0));

// `tasks`: all of the lesson. `mine` and `original`: files by name in the folder.
export async function checkTask(task: LessonTask, tasks: readonly LessonTask[], mine: ReadonlyMap<string, string>, original: ReadonlyMap<string, string>, main: string, signal: AbortSignal): Promise<CheckResult> {
  const renderer = new Renderer();
  const cancel = () => renderer.cancel();
  signal.addEventListener("abort", cancel);
  try {
    signal.throwIfAborted();
    await renderer.connect();
    const run = async (files: ReadonlyMap<string, string>) => {
      const image = await renderer.render(Object.fromEntries(files), task);
      return { image, values: task.compare && (await readValues(renderer, task.compare)) };
    };
    let own;
    try {
      own = await run(mine);
    } catch (error) {
      return { passed: false, message: `Your program does not render: ${(error as Error).message}` };
    }
    const yours = await decode(own.image);
    const compare = async (solution: ReadonlyMap<string, string>): Promise<CheckResult> => {
      const wanted = await run(solution);
      const expected = await decode(wanted.image);
      const images = { yours: yours.bitmap, expected: expected.bitmap };
      if (task.compare) return { ...compareValues(task.compare, own.values!, wanted.values!), ...images };
      const difference = compareImages(yours.data, expected.data, yours.bitmap.width);
      const passed = difference.differing <= kAllowedShare;
      return { passed, message: passed ? "Done: the image is that of the solution." : differenceText(difference), ...images, difference };
    };
    // The nearest one of those that count.
    let best: CheckResult | undefined;
    for (const done of acceptedTasks(tasks, task)) {
      const result = await compare(solutionFiles(original, main, ...done));
      if (!best || distanceOf(result) < distanceOf(best)) best = result;
      if (best.passed) break;
    }
    return best!;
  } catch (error) {
    return { passed: false, message: (error as Error).message };
  } finally {
    signal.removeEventListener("abort", cancel);
    renderer.close();
  }
}

export interface ComparedRun extends RenderedValues {
  files: ReadonlyMap<string, string>;
}

// The images of two commands: passed if they are equal up to rounding.
export async function compareRuns(left: ComparedRun, right: ComparedRun, signal: AbortSignal): Promise<CheckResult> {
  const renderer = new Renderer();
  const cancel = () => renderer.cancel();
  signal.addEventListener("abort", cancel);
  try {
    signal.throwIfAborted();
    await renderer.connect();
    const image = async (run: ComparedRun) => decode(await renderer.render(Object.fromEntries(run.files), run));
    const a = await image(left);
    const b = await image(right);
    const difference = compareImages(a.data, b.data, a.bitmap.width);
    const passed = difference.differing <= kAllowedShare;
    const percent = Math.max(0.1, Math.round(difference.differing * 1000) / 10);
    return { passed, message: passed ? "The images are equal up to rounding." : `${percent} % of the pixels differ.`, yours: a.bitmap, expected: b.bitmap, difference };
  } catch (error) {
    return { passed: false, message: (error as Error).message };
  } finally {
    signal.removeEventListener("abort", cancel);
    renderer.close();
  }
}

function differenceText(difference: ImageDifference): string {
  const percent = Math.max(0.1, Math.round(difference.differing * 1000) / 10);
  const worst = difference.worst;
  const text = `${percent} % of the pixels differ from the solution.`;
  if (!worst) return text;
  return `${text} Largest difference at pixel ${worst.x}, ${worst.y}: yours is ${worst.left.join(" ")}, the solution has ${worst.right.join(" ")} (0 to 255).`;
}
