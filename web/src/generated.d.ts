// SPDX-License-Identifier: Apache-2.0
// The table that build/library_table.mjs generates.
declare module "generated:library" {
  const table: {
    includes: string[];
    symbols: unknown[];
    builtIns: { name: string; isFunction: boolean; stages: string[] }[];
  };
  export default table;
}
declare module "*.css";
// For tests.
declare module "*/build/protocol.mjs" {
  export interface Protocol {
    commands: Record<string, unknown>;
    events: Record<string, unknown>;
    binary: Record<"image" | "file", { magic: string; version: number; fields: Record<string, { at: number; bytes: number }> }>;
  }
  export function readProtocol(root: string): Protocol;
  export function eventProblem(protocol: Protocol, event: object): string | undefined;
}
