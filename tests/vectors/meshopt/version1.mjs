// Writes NAME.enc and NAME.raw of version 1 with meshoptimizer's own encoder: npm install meshoptimizer@1.3.0
import { MeshoptEncoder } from "meshoptimizer";
import { writeFileSync } from "node:fs";

await MeshoptEncoder.ready;

function save(name, encoded, raw) {
    writeFileSync(name + ".enc", encoded);
    writeFileSync(name + ".raw", raw);
}

// A small generator: the same numbers everywhere.
let state = 9;
const next = () => (state = (Math.imul(state, 1103515245) + 12345) >>> 1);

// 300 vertices of 20 bytes, the second block with a group that is not full: floats, of which the encoder
// takes exclusive ors, 16-bit numbers, bytes, noise, and a constant.
const vertices = new DataView(new ArrayBuffer(300 * 20));
for (let i = 0; i < 300; i++) {
    vertices.setFloat32(20 * i, Math.cos(i / 50), true);
    vertices.setUint16(20 * i + 4, 300 * i, true);
    vertices.setUint16(20 * i + 6, 65535 - 170 * i, true);
    vertices.setUint8(20 * i + 8, i >> 4);
    vertices.setUint8(20 * i + 9, i & 1);
    vertices.setUint32(20 * i + 12, i < 40 ? next() : i % 70 == 0 ? next() : 0, true);
    vertices.setUint32(20 * i + 16, 77, true);
}
const raw = new Uint8Array(vertices.buffer);
save("vertices1", MeshoptEncoder.encodeVertexBufferLevel(raw, 300, 20, 3, 1), raw);

// Colours of 8 bits: what the filter makes of them, and the floats.
const colors = new Float32Array(64 * 4).map((_, i) => (i % 4 == 3 ? 1 - i / 512 : (next() % 1000) / 999));
save("colors", MeshoptEncoder.encodeFilterColor(colors, 64, 4, 8), new Uint8Array(colors.buffer));
