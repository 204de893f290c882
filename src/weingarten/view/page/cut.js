"use strict";
// A cross-section of the field in WebGL: blue within, orange without, level lines, the zero level dark. Without, one
// sees through it to what is left of the part.
function cuts(gl) {
  const VERTEX = `#version 300 es
    in vec2 corner;
    uniform mat3 axes; uniform vec3 target; uniform vec2 scale; uniform vec2 shift;
    uniform vec3 low; uniform vec3 across; uniform vec3 up; uniform vec2 lattice;
    out vec2 place;
    void main() {
      vec3 p = axes * (low + corner.x * across + corner.y * up - target);
      place = (corner * (lattice - 1.0) + 0.5) / lattice;
      gl_Position = vec4(p.xy * scale + shift, -(p.z + 0.004) * 0.2, 1.0);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec2 place; uniform sampler2D values; uniform float spacing; out vec4 colour;
    void main() {
      float k = texture(values, place).r / spacing;
      float wide = max(fwidth(k), 1e-6), depth = clamp(abs(k) / 8.0, 0.0, 1.0);
      bool within = k < 0.0;
      vec3 tint = within ? mix(vec3(0.80, 0.89, 0.97), vec3(0.27, 0.52, 0.77), depth) : mix(vec3(0.99, 0.93, 0.84), vec3(0.93, 0.66, 0.38), depth);
      float line = (1.0 - smoothstep(0.5, 1.3, abs(fract(k - 0.5) - 0.5) / wide)) * (1.0 - smoothstep(0.25, 0.6, wide));
      float zero = 1.0 - smoothstep(1.0, 1.9, abs(k) / wide);
      float solid = within ? 1.0 : 0.34;
      vec3 ink = within ? vec3(0.10, 0.30, 0.52) : vec3(0.66, 0.36, 0.08);
      colour = vec4(mix(mix(tint, ink, 0.75 * line), vec3(0.05, 0.07, 0.10), zero), max(max(solid, 0.7 * line), zero));
    }`;
  const { program, places } = linked(gl, VERTEX, FRAGMENT), array = gl.createVertexArray(), map = gl.createTexture();
  let own = null;
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([0, 0, 1, 0, 0, 1, 1, 1]), gl.STATIC_DRAW);
  gl.enableVertexAttribArray(gl.getAttribLocation(program, "corner"));
  gl.vertexAttribPointer(gl.getAttribLocation(program, "corner"), 2, gl.FLOAT, false, 8, 0);
  gl.bindVertexArray(null);

  /** What weingarten.view.section gives. */
  function upload(section) {
    const { columns, rows, step, data } = section;
    const steps = packedScenes.summed(packedScenes.numbers(data, 0, columns * rows, 2));
    gl.bindTexture(gl.TEXTURE_2D, map);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R16F, columns, rows, 0, gl.RED, gl.FLOAT, Float32Array.from(steps, (value) => value * step));
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    own = section;
  }

  /** The half-space that is cut away, the viewer's: normal, and distance from the origin. */
  function away(back) {
    const side = back[own.axis] >= 0 ? 1 : -1, normal = [0, 0, 0];
    normal[own.axis] = side;
    return [...normal, side * own.low[own.axis] + 1e-4];
  }

  function draw(view) {
    const [a, b] = [0, 1, 2].filter((k) => k !== own.axis), across = [0, 0, 0], up = [0, 0, 0];
    across[a] = own.high[a] - own.low[a];
    up[b] = own.high[b] - own.low[b];
    gl.useProgram(program);
    gl.bindVertexArray(array);
    gl.bindTexture(gl.TEXTURE_2D, map);
    seenFrom(gl, places, view);
    gl.uniform3fv(places.low, own.low);
    gl.uniform3fv(places.across, across);
    gl.uniform3fv(places.up, up);
    gl.uniform2f(places.lattice, own.columns, own.rows);
    gl.uniform1f(places.spacing, own.spacing);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
  }

  return { upload, away, draw };
}
