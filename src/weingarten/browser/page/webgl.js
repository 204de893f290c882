"use strict";
// What all that is drawn in WebGL has in common: the canvas, its programs, and the camera that they are told of.

/** The WebGL of a canvas; null where the browser lacks it, or what unpacks the scenes. */
function webgl(canvas) {
  return typeof DecompressionStream === "undefined" ? null : canvas.getContext("webgl2", { antialias: true });
}

/** What to call when a picture is out of date: it is drawn anew, once for however many calls before. */
function redrawing(draw) {
  let request = 0;
  return () => (request ||= requestAnimationFrame(() => {
    request = 0;
    draw();
  }));
}

/** Make a canvas empty, with the pixels of the screen, at most two across each of CSS; how many they are. */
function cleared(gl, canvas) {
  const dense = Math.min(window.devicePixelRatio || 1, 2);
  canvas.width = Math.round(canvas.clientWidth * dense);
  canvas.height = Math.round(canvas.clientHeight * dense);
  gl.viewport(0, 0, canvas.width, canvas.height);
  gl.enable(gl.DEPTH_TEST);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  return dense;
}

/** A program, and where its uniforms are. */
function linked(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const made = gl.createShader(kind);
    gl.shaderSource(made, source);
    gl.compileShader(made);
    if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
    gl.attachShader(program, made);
  }
  gl.linkProgram(program);
  const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS), places = {};
  for (let k = 0; k < count; k++) {
    const name = gl.getActiveUniform(program, k).name.replace("[0]", "");
    places[name] = gl.getUniformLocation(program, name);
  }
  return { program, places };
}

/** A camera's view of a canvas. target: what it turns about. perUnit: pixels of CSS that a unit length has. */
function viewOf(camera, canvas, target, perUnit) {
  const { clientWidth: width, clientHeight: height } = canvas, { x, y } = camera.view;
  const scale = [(2 * perUnit) / width, (2 * perUnit) / height], shift = [(2 * x) / width, (-2 * y) / height];
  return { axes: camera.axes(), target, scale, shift };
}

/** Tell a program of a view. cut: normal of the plane beyond which nothing is drawn, and its distance. */
function seenFrom(gl, places, { axes, target, scale, shift, cut = [0, 0, 0, 0] }) {
  gl.uniformMatrix3fv(places.axes, true, axes.flat());
  gl.uniform3fv(places.target, target);
  gl.uniform2fv(places.scale, scale);
  gl.uniform2fv(places.shift, shift);
  gl.uniform4fv(places.cut, cut);
}
