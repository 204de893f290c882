"use strict";
// Points in WebGL: small discs, a little nearer than they are, so that those on a surface are seen.
function clouds(gl) {
  const VERTEX = `#version 300 es
    in vec3 position;
    uniform mat3 axes; uniform vec3 target; uniform vec2 scale; uniform vec2 shift; uniform vec4 cut; uniform float size;
    out float beyond;
    void main() {
      vec3 p = axes * (position - target);
      beyond = dot(position, cut.xyz) - cut.w;
      gl_Position = vec4(p.xy * scale + shift, -(p.z + 0.006) * 0.2, 1.0);
      gl_PointSize = size;
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in float beyond; uniform vec3 paint; out vec4 colour;
    void main() {
      vec2 from = 2.0 * gl_PointCoord - 1.0;
      if (beyond > 0.0 || dot(from, from) > 1.0) discard;
      colour = vec4(paint * (1.0 - 0.25 * dot(from, from)), 1.0);
    }`;
  const { program, places } = linked(gl, VERTEX, FRAGMENT), array = gl.createVertexArray(), buffer = gl.createBuffer();
  let count = 0;
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.enableVertexAttribArray(gl.getAttribLocation(program, "position"));
  gl.vertexAttribPointer(gl.getAttribLocation(program, "position"), 3, gl.FLOAT, false, 12, 0);
  gl.bindVertexArray(null);

  function upload(positions) {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, positions, gl.STATIC_DRAW);
    count = positions.length / 3;
  }

  /** size: pixels across. paint: red, green, blue. */
  function draw(view, size, paint) {
    gl.useProgram(program);
    gl.bindVertexArray(array);
    seenFrom(gl, places, view);
    gl.uniform1f(places.size, size);
    gl.uniform3fv(places.paint, paint);
    gl.drawArrays(gl.POINTS, 0, count);
    gl.bindVertexArray(null);
  }

  return { upload, draw };
}
