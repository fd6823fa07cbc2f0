// SPDX-License-Identifier: Apache-2.0
// The session of the page against a socket that the test answers.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { EventOf, ServerEvent } from "../src/protocol";
import { Session } from "../src/session";

class FakeSocket {
  static readonly OPEN = 1;
  static last: FakeSocket;
  readyState = FakeSocket.OPEN;
  sent: { do: string; [key: string]: unknown }[] = [];
  onopen?: () => void;
  onmessage?: (message: { data: string }) => void;
  constructor() {
    FakeSocket.last = this;
  }
  send(text: string): void {
    this.sent.push(JSON.parse(text));
  }
  close(): void {}
  receive(event: ServerEvent): void {
    this.onmessage!({ data: JSON.stringify(event) });
  }
}
Object.assign(globalThis, { WebSocket: FakeSocket, location: { protocol: "http:", host: "localhost" } });

const kState: EventOf<"state"> = {
  event: "state", program: "mine", parameters: {}, output: "image", exposure: 0, tonemap: "default", width: 64, height: 36, samples: 64, frame: 0,
  frames: true, still: false, paused: false, camera: null, environment: { source: "", intensity: 1, rotation: 0, on: true },
  canUndo: false, canRedo: false, prints: false,
};
const kError = { severity: "error" as const, file: "mine/mine.rt.glsl", line: 3, column: 1, id: "GLSL", text: "syntax error" };

function opened() {
  const ignore = () => undefined;
  const session = new Session({
    onStatus: ignore, onOpened: ignore, onState: ignore, onDiagnostics: ignore, onGraph: ignore, onImage: ignore,
    onStatistics: ignore, onRestarted: ignore, onReloaded: ignore, onPrinted: ignore, onMessage: ignore,
  });
  session.connect();
  const socket = FakeSocket.last;
  socket.onopen!();
  session.open({ program: "mine", scene: "", width: 64, height: 36 });
  socket.receive({ event: "worker", state: "started", message: "", restarts: 0 });
  socket.receive({ event: "opening", number: 1 });
  const pauses = () => socket.sent.filter((command) => command.do === "pause").map((command) => command["on"]);
  return { session, socket, pauses };
}

for (const [name, event] of [
  ["runs", { event: "stage", text: "loading" }],
  ["has errors", { event: "diagnostics", diagnostics: [kError], outdated: false }],
] satisfies [string, ServerEvent][])
  test(`after a program that took too long, the saved repair ${name}, and the session no longer waits`, () => {
    const { session, socket } = opened();
    socket.receive({ event: "worker", state: "hung", message: "a launch took longer than 3 s", restarts: 1 });
    socket.receive({ event: "worker", state: "waiting", message: "the program runs again as soon as …", restarts: 1 });
    socket.receive({ event: "opening", number: 1 }); // the new worker has the command, and waits
    assert.equal(session.worker!.state, "waiting");
    assert.equal(session.cause!.state, "hung");
    socket.receive(event);
    assert.equal(session.worker!.state, "started");
    assert.equal(session.cause, undefined);
  });

test("a hidden page pauses, and continues when it is shown", () => {
  const { session, socket, pauses } = opened();
  session.setHidden(true);
  assert.deepEqual(pauses(), [], "nothing is open yet");
  socket.receive(kState);
  socket.receive({ ...kState, paused: true });
  assert.deepEqual(pauses(), [true]);
  session.setHidden(false);
  assert.deepEqual(pauses(), [true, false]);
});

test("a hidden page leaves a session alone that the user has paused, or that has nothing to render", () => {
  for (const state of [{ ...kState, paused: true }, { ...kState, still: true }]) {
    const { session, socket, pauses } = opened();
    socket.receive(state);
    session.setHidden(true);
    session.setHidden(false);
    assert.deepEqual(pauses(), []);
  }
});

test("a worker that starts again while the page is hidden is paused, too", () => {
  const { session, socket, pauses } = opened();
  socket.receive(kState);
  session.setHidden(true);
  socket.receive({ event: "worker", state: "started", message: "", restarts: 1 });
  socket.receive({ event: "opening", number: 1 });
  socket.receive(kState);
  assert.deepEqual(pauses(), [true, true]);
});
