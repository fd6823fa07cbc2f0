// SPDX-License-Identifier: Apache-2.0
// Writes files with the encoders of npm packages, and what the reference decoders make of them:
//   NAME.ktx2, NAME.rgba                            an image with Basis Universal, and its pixels
//   COUNT_STRIDE_FILTER_N.meshopt, ….bytes          vertices in version 1 of meshoptimizer's codec, and their bytes
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { encodeToKTX2 } from "ktx2-encoder";
import { MeshoptDecoder, MeshoptEncoder } from "meshoptimizer";

const require = createRequire(import.meta.url);
let state = 1;
const random = () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) >>> 8;

// ---- Basis Universal ----

async function loadTranscoder() {
  // The script is CommonJS in a package of modules.
  const file = require.resolve("three/examples/jsm/libs/basis/basis_transcoder.js");
  const module = { exports: {} };
  new Function("module", "exports", "require", "__dirname", readFileSync(file, "utf8"))(
    module, module.exports, require, path.dirname(file));
  const transcoder = await module.exports({ wasmBinary: readFileSync(file.replace(/js$/, "wasm")) });
  transcoder.initializeBasis();
  return transcoder;
}

// Pixels of level 0; nothing if the transcoder rejects the file.
function transcode(transcoder, bytes) {
  const rgba32 = 13;
  const file = new transcoder.KTX2File(new Uint8Array(bytes));
  try {
    if (!file.isValid() || !file.startTranscoding()) return undefined;
    const pixels = new Uint8Array(file.getImageTranscodedSizeInBytes(0, 0, 0, rgba32));
    return file.transcodeImage(pixels, 0, 0, 0, rgba32, 0, -1, -1) ? pixels : undefined;
  } finally {
    file.close();
    file.delete();
  }
}

function makeImage(width, height, kind, alpha) {
  const data = new Uint8Array(4 * width * height);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, i += 4) {
      const u = x / width, v = y / height;
      if (kind === "noise") data.set([random(), random(), random()], i);
      if (kind === "flat") data.set([200, 30, 90], i);
      if (kind === "gray") data.fill(255 * (0.5 + 0.5 * Math.sin(20 * u * v + 5 * u)), i, i + 3);
      const stripes = ((x >> 3) ^ (y >> 3)) & 1;
      if (kind === "gradient") data.set([255 * (stripes ? u : 1 - u), 255 * v, 127 + 127 * Math.sin(30 * u + 17 * v * v)], i);
      data[i + 3] = alpha ? 127 + 127 * Math.cos(9 * u - 14 * v) : 255;
    }
  return { data, width, height };
}

// A KTX2 file with blocks of UASTC and the channels RGBA.
function uastcFile(width, height, blocks) {
  const descriptor = Buffer.alloc(44), header = Buffer.alloc(104);
  descriptor.writeUInt32LE(44, 0), descriptor.writeUInt16LE(2, 8), descriptor.writeUInt16LE(40, 10);
  descriptor.set([166, 1, 2, 0, 3, 3, 0, 0, 16], 12), descriptor.set([127, 3], 30);
  header.set(Buffer.from("\xABKTX 20\xBB\r\n\x1A\n", "latin1"));
  [0, 1, width, height, 0, 0, 1, 1, 0, 104, 44].forEach((word, i) => header.writeUInt32LE(word, 12 + 4 * i));
  [148, blocks.length, blocks.length].forEach((word, i) => header.writeBigUInt64LE(BigInt(word), 80 + 8 * i));
  return Buffer.concat([header, descriptor, blocks]);
}

// Codes of the modes of UASTC and their numbers of bits.
const uastcModes = [[0x01, 4], [0x35, 6], [0x1d, 5], [0x03, 5], [0x13, 5], [0x0b, 5], [0x1b, 5], [0x07, 5], [0x17, 5], [0x0f, 5],
  [0x02, 3], [0x00, 2], [0x06, 3], [0x1f, 5], [0x0d, 5], [0x05, 7], [0x15, 6], [0x25, 6], [0x09, 4]];

async function writeBasisFiles(folder) {
  const transcoder = await loadTranscoder();
  let count = 0;
  const save = (name, bytes) => {
    const pixels = transcode(transcoder, bytes);
    if (!pixels) throw new Error(`the reference transcoder rejects ${name}`);
    writeFileSync(path.join(folder, `${name}.ktx2`), bytes);
    writeFileSync(path.join(folder, `${name}.rgba`), pixels);
    ++count;
  };
  for (const [width, height] of [[1, 1], [4, 4], [5, 3], [3, 9], [16, 16], [64, 64], [255, 129], [130, 7]])
    for (const kind of ["noise", "flat", "gray", "gradient"])
      for (const alpha of [false, true]) {
        const settings = [{ isUASTC: false, qualityLevel: 128 }, { isUASTC: true, uastcLDRQualityLevel: 2 }];
        if (width === 64) {
          settings.push({ isUASTC: false, qualityLevel: 1 }, { isUASTC: false, qualityLevel: 255 });
          settings.push({ isUASTC: true, uastcLDRQualityLevel: 0, needSupercompression: false });
          settings.push({ isUASTC: true, uastcLDRQualityLevel: 3 }, { isUASTC: true, enableRDO: true, rdoQualityLevel: 3 });
        }
        for (const setting of settings) {
          const bytes = await encodeToKTX2(new Uint8Array(4), {
            imageDecoder: async () => makeImage(width, height, kind, alpha),
            isKTX2File: true, isSetKTX2SRGBTransferFunc: true, needSupercompression: true, generateMipmap: width > 100, ...setting,
          });
          save(`${kind}_${alpha ? "alpha_" : ""}${width}x${height}_${count}`, bytes);
        }
      }
  // Random blocks of each mode that are valid.
  for (const [mode, [code, bits]] of uastcModes.entries()) {
    const blocks = [];
    while (blocks.length < 256) {
      const block = Buffer.from(Array.from({ length: 16 }, random));
      block[0] = (block[0] & ~((1 << bits) - 1)) | code;
      if (transcode(transcoder, uastcFile(4, 4, block))) blocks.push(block);
    }
    save(`uastc_mode_${mode}`, uastcFile(64, 64, Buffer.concat(blocks)));
  }
  return count;
}

// ---- meshoptimizer ----

async function writeMeshoptFiles(folder) {
  await Promise.all([MeshoptEncoder.ready, MeshoptDecoder.ready]);
  let count = 0;
  const save = (stream, elements, stride, filter) => {
    const bytes = new Uint8Array(elements * stride);
    MeshoptDecoder.decodeVertexBuffer(bytes, elements, stride, stream, filter);
    const name = path.join(folder, `${elements}_${stride}_${filter}_${count++}`);
    writeFileSync(`${name}.meshopt`, stream);
    writeFileSync(`${name}.bytes`, bytes);
  };
  const valuesOf = {
    random: (view, at) => view.setUint32(at, random() * 257, true),
    floats: (view, at, i, k) => view.setFloat32(at, Math.sin(i * 0.01 + k), true),
    shorts: (view, at, i, k) => (view.setUint16(at, i * 7 + k, true), view.setUint16(at + 2, 1000 - i * 3 + (random() % 3), true)),
    steps: (view, at, i, k) => view.setUint32(at, k % 8 ? 5 : i >> 3, true),
    highBits: (view, at, i) => view.setUint32(at, ((i % 5) << 20) | (random() & 1), true),
  };
  for (const stride of [4, 8, 12, 20, 32, 100, 256])
    for (const elements of [1, 16, 17, 256, 257, 1000])
      for (const set of Object.values(valuesOf))
        for (const level of [0, 2, 3]) {
          const data = new Uint8Array(stride * elements), view = new DataView(data.buffer);
          for (let i = 0; i < elements; ++i)
            for (let k = 0; k < stride; k += 4) set(view, i * stride + k, i, k);
          save(MeshoptEncoder.encodeVertexBufferLevel(data, elements, stride, level, 1), elements, stride, "NONE");
        }
  for (const [stride, sizes] of [[4, [2, 5, 8]], [8, [2, 9, 12, 16]]])
    for (const bits of sizes) {
      const colors = Float32Array.from({ length: 4 * 500 }, () => random() / 0xffffff);
      const filtered = MeshoptEncoder.encodeFilterColor(colors, 500, stride, bits);
      save(MeshoptEncoder.encodeVertexBufferLevel(filtered, 500, stride, 2, 1), 500, stride, "COLOR");
    }
  return count;
}

// Returns a summary.
export async function generate(folder) {
  const log = console.log;
  console.log = () => {};  // the encoder prints its settings
  try {
    const images = await writeBasisFiles(folder), streams = await writeMeshoptFiles(folder);
    return `${images} images with Basis Universal, ${streams} streams of meshoptimizer`;
  } finally {
    console.log = log;
  }
}
