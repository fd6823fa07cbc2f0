// SPDX-License-Identifier: Apache-2.0
// Writes src/protocol_messages.ts, the types of the messages between page and server, and checks the types of all sources.
import { spawnSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { protocolTypes } from "./protocol.mjs";

const web = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
const root = process.env.QUINTET_SOURCE ?? path.dirname(web);  // the repository; the build works in a copy of web/
writeFileSync(path.join(web, "src/protocol_messages.ts"), protocolTypes(root));
const { status } = spawnSync(process.execPath, [path.join(web, "node_modules/typescript/bin/tsc"), "--noEmit"], { cwd: web, stdio: "inherit" });
process.exit(status ?? 1);
