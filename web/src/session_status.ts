// SPDX-License-Identifier: Apache-2.0
// What the page says about the session: the state of the connection at the top, and a message over the image while it does
// not show the current program.
import { countText, type Diagnostic } from "./diagnostic";
import { h, replace } from "./dom";
import type { ImageView } from "./image_view";
import type { Session } from "./session";
import { capitalized } from "./text";

function message(title: string, text: string, ...actions: Node[]): HTMLElement {
  return h("div", { class: "message" }, h("b", {}, title), text && h("span", {}, text), actions.length > 0 && h("div", { class: "message-actions" }, actions));
}

interface Overlay {
  content: Node | string;
  dim: boolean; // the image does not show the current program
}

export class SessionStatus {
  readonly link = h("span", { class: "link-state", role: "status" });

  constructor(
    private readonly session: Session,
    private readonly image: ImageView,
  ) {}

  show(diagnostics: readonly Diagnostic[], outdated: boolean): void {
    this.showLink();
    const { content, dim } = this.overlay(diagnostics, outdated);
    this.image.setOverlay(content, dim, dim && !this.session.hasImage);
  }

  private showLink(): void {
    const { connection, worker, opened } = this.session;
    let dot = "good";
    let label = opened?.device ?? "Connected";
    if (connection !== "open") {
      dot = connection === "connecting" ? "busy" : "bad";
      label = connection === "connecting" ? "Connecting" : "No connection";
    } else if (worker && worker.state !== "started") {
      dot = worker.state === "idle" ? "busy" : "bad";
      label = { waiting: "Stopped", crashed: "Crashed", hung: "Stopped: too slow", idle: "Idle" }[worker.state];
    }
    replace(this.link, h("span", { class: `dot ${dot}`, "aria-hidden": "true" }), h("span", { title: label }, label));
  }

  private overlay(diagnostics: readonly Diagnostic[], outdated: boolean): Overlay {
    const { session } = this;
    const { worker, connection } = session;
    const button = (label: string, run: () => void) => h("button", { type: "button", onclick: run }, label);
    const restart = () => button("Start again", () => session.send({ do: "restart" }));
    const connect = () => button("Connect now", () => session.connect());
    const errors = diagnostics.filter((diagnostic) => diagnostic.severity === "error");
    if (connection === "refused" || connection === "full") return { content: message("No connection", session.connectionMessage, connect()), dim: true };
    if (connection === "lost") return { content: message("The server does not answer", "The page reconnects as soon as the server runs again. Edits stay here until they can be saved.", connect()), dim: true };
    if (worker?.state === "crashed" || worker?.state === "hung" || worker?.state === "waiting") {
      const cause = session.cause;
      const title = cause?.state === "hung" ? "The shader takes too long" : cause ? "The render process crashed" : "The render process has stopped";
      const sentences = [cause?.message, worker.state === "waiting" ? worker.message : ""].filter(Boolean).map((text) => `${capitalized(text!)}.`);
      return { content: message(title, sentences.join(" "), restart()), dim: true };
    }
    if (worker?.state === "idle") return { content: message("The render process has ended after a pause", "The next change starts it again.", restart()), dim: false };
    if (errors.length > 0 && !session.hasImage) return { content: message("The program has errors", countText(diagnostics)), dim: true };
    if (errors.length > 0) return { content: message("", `${countText(errors)}: the image shows the last version without errors`), dim: outdated };
    if (session.failure) return { content: message("The render stopped", session.failure, restart()), dim: true };
    if (!session.hasImage) return { content: message("", connection === "connecting" ? "Connecting…" : session.stage ? `${capitalized(session.stage)}…` : "Rendering…"), dim: true };
    return { content: "", dim: false };
  }
}
