// SPDX-License-Identifier: Apache-2.0
// The linked pipeline as the server describes it: the JSON of `quintet check --graph` (docs/cli.md).
import type { Diagnostic } from "./diagnostic";

export interface Location {
  file: string;
  line: number;
  column: number;
}

export interface Target {
  list: "hits" | "misses" | "callables";
  index: number;
  exact: boolean;
  diagnostics: number[];
}

export interface PipelineModel {
  program: string;
  scene: string | null;
  recursion: { depth: number; declared: number | null; stackBytes: number };
  rays: string[];
  stages: { kind: string; file: string; reached: boolean; diagnostics: number[] }[];
  hits: {
    group: string;
    ray: string;
    closestHit: number | null;
    anyHit: number | null;
    intersection: number | null;
    record: string;
    binding: string[];
    geometry: string[];
    diagnostics: number[];
  }[];
  misses: { name: string; stage: number | null; record: string }[];
  callables: { name: string; stage: number | null; record: string }[];
  traces: {
    stage: number;
    location: Location;
    rays: number[];
    flags: string;
    mask: string;
    offset: string;
    stride: string;
    miss: string;
    payload: { name: string; type: string; bytes: number };
    inLoop: boolean;
    searches: boolean; // fills a hit object: without the shader at the end of the ray
    executes: boolean; // runs a hit object: only that shader
    skipsClosestHit: boolean;
    skipsAnyHit: boolean;
    targets: Target[];
    diagnostics: number[];
  }[];
  calls: {
    stage: number;
    location: Location;
    index: string;
    data: { name: string; type: string; bytes: number };
    targets: Target[];
    diagnostics: number[];
  }[];
  diagnostics: Diagnostic[];
}
