// SPDX-License-Identifier: Apache-2.0
// Runs a file of tests: node run.mjs FILE. Exit status 77 means skipped, because npm could not install the packages when the
// page was built, for example without a network.
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import path from "node:path";

const packages = path.join(process.env.WEB, "node_modules/.package-lock.json");
if (!existsSync(packages)) {
  console.log(`skipped: ${packages} does not exist; build the target quintet_lab_server with a network`);
  process.exit(77);
}
const isBuild = !process.argv[2].endsWith(".test.mjs");
const { status } = spawnSync(process.execPath, [...(isBuild ? [] : ["--test"]), process.argv[2]], { stdio: "inherit" });
process.exit(status ?? 1);
