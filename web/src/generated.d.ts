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
