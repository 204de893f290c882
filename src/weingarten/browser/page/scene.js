"use strict";
// Meshes for the view in 3D: unpacked from the page, with normals that are smooth but for creases.
const packedScenes = (() => {
  const THIN = 10; // a face that is no higher than so many steps of a position has no direction of its own
  const SHIFT = 4194304; // an edge's key is the lesser vertex times this plus the greater one
  const LINE = Math.cos((50 * Math.PI) / 180); // an edge this sharp gets a line, if it goes on at both ends

  // the inverse of weingarten.report.scene
  const decoded = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

  async function inflated(packed) {
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  function numbers(data, start, count, size) {
    const found = new Int32Array(count);
    for (let i = 0; i < count; i++) {
      let value = 0;
      for (let k = 0; k < size; k++) value |= data[start + k * count + i] << (8 * k);
      found[i] = value & 1 ? -((value + 1) >> 1) : value >> 1;
    }
    return found;
  }

  function summed(values) {
    for (let i = 1; i < values.length; i++) values[i] += values[i - 1];
    return values;
  }

  function places(data, { vertices, low, step }) {
    const positions = new Float32Array(3 * vertices);
    for (let axis = 0; axis < 3; axis++) {
      const steps = summed(numbers(data, 2 * axis * vertices, vertices, 2));
      for (let i = 0; i < vertices; i++) positions[3 * i + axis] = low[axis] + steps[i] * step;
    }
    return positions;
  }

  function unpacked(scene, data) {
    const { vertices, faces, step } = scene, positions = places(data, scene);
    const start = 6 * vertices, indices = new Uint32Array(3 * faces);
    const first = summed(numbers(data, start, faces, 3));
    const second = numbers(data, start + 3 * faces, faces, 3), third = numbers(data, start + 6 * faces, faces, 3);
    for (let f = 0; f < faces; f++) indices.set([first[f], first[f] + second[f], first[f] + third[f]], 3 * f);
    return { positions, indices, step, levels: data.subarray(start + 9 * faces) };
  }

  function crossed({ positions, indices }) {
    const found = new Float32Array(indices.length);
    for (let f = 0; f < indices.length; f += 3) {
      const [a, b, c] = [3 * indices[f], 3 * indices[f + 1], 3 * indices[f + 2]];
      const u = [0, 1, 2].map((k) => positions[b + k] - positions[a + k]);
      const w = [0, 1, 2].map((k) => positions[c + k] - positions[a + k]);
      found.set([u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]], f);
    }
    return found;
  }

  function longest({ positions, indices }, f) {
    const side = (one, other) => Math.hypot(...[0, 1, 2].map((k) => positions[3 * one + k] - positions[3 * other + k]));
    const [a, b, c] = indices.subarray(f, f + 3);
    return Math.max(side(a, b), side(b, c), side(c, a));
  }

  /** What WebGL is given: for every corner place, normal and distances to creases (9 numbers), and its level.
   *  unknown: whether level 0 says that nothing is known there, which then holds for the whole face. */
  function expanded(mesh, crease, unknown = false) {
    const { positions, indices, levels, step } = mesh, count = indices.length, around = new Map(), edges = new Map();
    const cross = crossed(mesh), length = new Float32Array(count / 3), thin = new Uint8Array(count / 3);
    for (let f = 0; f < count; f += 3) {
      length[f / 3] = Math.hypot(cross[f], cross[f + 1], cross[f + 2]) || 1e-30;
      thin[f / 3] = length[f / 3] < THIN * step * longest(mesh, f);
    }
    for (let i = 0; i < count; i++) {
      const face = Math.floor(i / 3), from = indices[i], to = indices[3 * face + ((i + 1) % 3)];
      const key = Math.min(from, to) * SHIFT + Math.max(from, to);
      (around.get(from) || around.set(from, []).get(from)).push(face);
      (edges.get(key) || edges.set(key, []).get(key)).push(face);
    }
    const alike = (f, g, least) => {
      if (thin[f] || thin[g]) return true;
      const dot = cross[3 * f] * cross[3 * g] + cross[3 * f + 1] * cross[3 * g + 1] + cross[3 * f + 2] * cross[3 * g + 2];
      return dot > least * length[f] * length[g];
    };
    const lines = new Set(), ends = new Uint16Array(positions.length / 3);
    for (const [key, both] of edges) {
      if (both.length === 2 && alike(both[0], both[1], LINE)) continue;
      lines.add(key);
      for (const end of [Math.floor(key / SHIFT), key % SHIFT]) ends[end]++;
    }
    const lined = (from, to) => ends[from] > 1 && ends[to] > 1 && lines.has(Math.min(from, to) * SHIFT + Math.max(from, to));
    const corner = new Float32Array(9 * count), level = new Uint8Array(count);
    for (let i = 0; i < count; i++) {
      const face = Math.floor(i / 3), vertex = indices[i];
      corner.set(positions.subarray(3 * vertex, 3 * vertex + 3), 9 * i);
      for (const other of around.get(vertex)) {
        if (other === face || alike(face, other, crease)) {
          for (let k = 0; k < 3; k++) corner[9 * i + 3 + k] += cross[3 * other + k] / (thin[other] ? 1 : Math.sqrt(length[other]));
        }
      }
      for (let k = 0; k < 3; k++) {
        const from = indices[3 * face + ((k + 1) % 3)], to = indices[3 * face + ((k + 2) % 3)];
        corner[9 * i + 6 + k] = i % 3 !== k && lined(from, to) ? 0 : 1;
      }
      level[i] = levels.length ? levels[vertex] : 0;
    }
    for (let i = 0; unknown && i < count; i += 3) {
      if (Math.min(level[i], level[i + 1], level[i + 2]) === 0) level.fill(0, i, i + 3);
    }
    return { corner, level, count };
  }

  return { decoded, inflated, numbers, summed, places, unpacked, expanded };
})();
