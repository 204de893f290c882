"use strict";
// Surfaces in WebGL, as in the pictures: the same light, the same creases, the same colours.

/** One surface at a time. light: of weingarten.report.looks. */
function surfaces(gl, light) {
  const VERTEX = `#version 300 es
    in vec3 position; in vec3 normal; in vec3 edge; in float level;
    uniform mat3 axes; uniform vec3 target; uniform vec2 scale; uniform vec2 shift; uniform vec4 cut;
    out vec3 n; out vec3 e; out float v; out float beyond;
    void main() {
      vec3 p = axes * (position - target);
      n = axes * normal; e = edge; v = level; beyond = dot(position, cut.xyz) - cut.w;
      gl_Position = vec4(p.xy * scale + shift, -p.z * 0.2, 1.0);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 n; in vec3 e; in float v; in float beyond;
    uniform vec4 lights[${light.lights.length}]; uniform vec3 front; uniform vec3 back;
    uniform vec4 finish; // ambient, sheen, and shade and tint of coloured surfaces
    uniform sampler2D colours; uniform bool coloured;
    out vec4 colour;
    void main() {
      if (beyond > 0.0) discard;
      vec3 N = normalize(n);
      bool inside = !gl_FrontFacing;
      if (N.z < 0.0) N = -N;
      float light = finish.x;
      for (int k = 0; k < ${light.lights.length}; k++) light += lights[k].w * max(0.0, dot(N, lights[k].xyz));
      vec3 half_way = normalize(lights[0].xyz + vec3(0.0, 0.0, 1.0));
      vec3 shaded = (inside ? back : front) * light + finish.y * pow(max(0.0, dot(N, half_way)), 40.0);
      vec3 heat = texture(colours, vec2((v * 255.0 + 0.5) / 256.0, 0.5)).rgb * (finish.z + finish.w * light);
      vec3 near = 1.0 - smoothstep(vec3(0.5), vec3(1.3), e / max(fwidth(e), vec3(1e-6)));
      float line = max(near.x, max(near.y, near.z));
      colour = vec4(clamp(coloured ? heat : shaded, 0.0, 1.0) * (1.0 - 0.35 * line), 1.0);
    }`;
  const { program, places } = linked(gl, VERTEX, FRAGMENT);
  const array = gl.createVertexArray(), map = gl.createTexture(), buffers = { corner: gl.createBuffer(), level: gl.createBuffer() };
  let corners = 0;
  gl.useProgram(program);
  gl.uniform4fv(places.lights, light.lights.flat());
  gl.uniform3fv(places.front, light.front);
  gl.uniform3fv(places.back, light.back);
  gl.uniform4f(places.finish, light.ambient, light.sheen, light.shade, light.tint);
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffers.corner);
  ["position", "normal", "edge"].forEach((name, k) => attribute(name, 3, gl.FLOAT, 36, 12 * k));
  gl.bindBuffer(gl.ARRAY_BUFFER, buffers.level);
  attribute("level", 1, gl.UNSIGNED_BYTE, 1, 0);
  gl.bindVertexArray(null);

  function attribute(name, size, kind, stride, offset) {
    const place = gl.getAttribLocation(program, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, kind, kind !== gl.FLOAT, stride, offset);
  }

  function fill(buffer, values) {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
  }

  /** Of 256 colours, three bytes each. */
  function paint(colours) {
    gl.bindTexture(gl.TEXTURE_2D, map);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array(colours));
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  }

  /** What packedScenes.expanded gives. */
  function upload({ corner, level, count }) {
    fill(buffers.corner, corner);
    fill(buffers.level, level);
    corners = count;
  }

  /** Other levels of the corners. */
  const recolour = (level) => fill(buffers.level, level);
  const clear = () => (corners = 0);

  function draw(view, coloured) {
    if (!corners) return;
    gl.useProgram(program);
    gl.bindVertexArray(array);
    gl.bindTexture(gl.TEXTURE_2D, map);
    seenFrom(gl, places, view);
    gl.uniform1i(places.coloured, coloured ? 1 : 0);
    gl.drawArrays(gl.TRIANGLES, 0, corners);
    gl.bindVertexArray(null);
  }

  return { paint, upload, recolour, clear, draw };
}
