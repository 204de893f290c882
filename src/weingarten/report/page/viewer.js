"use strict";
// The view in 3D. World: the unit frame of a part's scenes; view: x right, y up, z towards the viewer, parallel
// projection. Surfaces look as in the pictures: the same light, the same creases, the same colours.
(() => {
  const settings = JSON.parse(document.getElementById("viewing").textContent);
  const element = (id) => document.getElementById(id);
  const dialog = element("viewer"), canvas = element("v-canvas"), message = element("v-message");
  const partChoice = element("v-part"), meshChoice = element("v-mesh");
  const modes = [...document.querySelectorAll("input[name=v-mode]")];
  const TRUTH = -1;

  const VERTEX = `#version 300 es
    in vec3 position; in vec3 normal; in vec3 edge; in float level;
    uniform mat3 axes; uniform vec3 target; uniform vec2 scale; uniform vec2 shift;
    out vec3 n; out vec3 e; out float v;
    void main() {
      vec3 p = axes * (position - target);
      n = axes * normal; e = edge; v = level;
      gl_Position = vec4(p.xy * scale + shift, -p.z * 0.2, 1.0);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 n; in vec3 e; in float v;
    uniform vec4 lights[${settings.light.lights.length}]; uniform vec3 front; uniform vec3 back;
    uniform vec4 finish; // ambient, sheen, and shade and tint of coloured surfaces
    uniform sampler2D colours; uniform bool coloured;
    out vec4 colour;
    void main() {
      vec3 N = normalize(n);
      bool inside = !gl_FrontFacing;
      if (N.z < 0.0) N = -N;
      float light = finish.x;
      for (int k = 0; k < ${settings.light.lights.length}; k++) light += lights[k].w * max(0.0, dot(N, lights[k].xyz));
      vec3 half_way = normalize(lights[0].xyz + vec3(0.0, 0.0, 1.0));
      vec3 shaded = (inside ? back : front) * light + finish.y * pow(max(0.0, dot(N, half_way)), 40.0);
      vec3 heat = texture(colours, vec2((v * 255.0 + 0.5) / 256.0, 0.5)).rgb * (finish.z + finish.w * light);
      vec3 near = 1.0 - smoothstep(vec3(0.5), vec3(1.3), e / max(fwidth(e), vec3(1e-6)));
      float line = max(near.x, max(near.y, near.z));
      colour = vec4(clamp(coloured ? heat : shaded, 0.0, 1.0) * (1.0 - 0.35 * line), 1.0);
    }`;

  const buffers = [];
  let gl = null, program = null, places = null, corners = 0, request = 0, shown = 0;
  const view = { azimuth: 0, elevation: 0, zoom: 1, x: 0, y: 0 };
  const now = { part: 0, mesh: TRUTH, mode: settings.mode };
  const home = { azimuth: settings.azimuth, elevation: settings.elevation };

  // ---- WebGL
  function shader(kind, source) {
    const made = gl.createShader(kind);
    gl.shaderSource(made, source);
    gl.compileShader(made);
    if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
    return made;
  }

  function prepare() {
    gl = canvas.getContext("webgl2", { antialias: true });
    if (typeof DecompressionStream === "undefined") gl = null;
    if (!gl) return false;
    program = gl.createProgram();
    gl.attachShader(program, shader(gl.VERTEX_SHADER, VERTEX));
    gl.attachShader(program, shader(gl.FRAGMENT_SHADER, FRAGMENT));
    gl.linkProgram(program);
    gl.useProgram(program);
    const names = ["axes", "target", "scale", "shift", "lights", "front", "back", "finish", "coloured"];
    places = Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(program, name)]));
    const { lights, front, back, ambient, sheen, shade, tint } = settings.light;
    gl.uniform4fv(places.lights, lights.flat());
    gl.uniform3fv(places.front, front);
    gl.uniform3fv(places.back, back);
    gl.uniform4f(places.finish, ambient, sheen, shade, tint);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array(settings.colours));
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    gl.enable(gl.DEPTH_TEST);
    return true;
  }

  function upload({ corner, level, count }) {
    buffers.splice(0).forEach((buffer) => gl.deleteBuffer(buffer));
    fill(corner);
    ["position", "normal", "edge"].forEach((name, k) => attribute(name, 3, gl.FLOAT, 36, 12 * k));
    fill(level);
    attribute("level", 1, gl.UNSIGNED_BYTE, 1, 0);
    corners = count;
  }

  function fill(values) {
    buffers.push(gl.createBuffer());
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers.at(-1));
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
  }

  function attribute(name, size, kind, stride, offset) {
    const place = gl.getAttribLocation(program, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, kind, kind !== gl.FLOAT, stride, offset);
  }

  function axes() {
    const [a, e] = [view.azimuth, view.elevation].map((degrees) => (degrees * Math.PI) / 180);
    const back = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    const right = [-Math.sin(a), Math.cos(a), 0];
    const up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
    return [right, up, back];
  }

  /** Pixels of a unit length. */
  function perUnit() {
    const part = settings.parts[now.part];
    return view.zoom * Math.min(canvas.clientWidth / part.extent, canvas.clientHeight / part.tall);
  }

  function draw() {
    request = 0;
    if (!gl || !dialog.open) return;
    const dense = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    canvas.width = Math.round(width * dense);
    canvas.height = Math.round(height * dense);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const [right, up, back] = axes();
    gl.uniformMatrix3fv(places.axes, true, [...right, ...up, ...back]);
    gl.uniform3fv(places.target, settings.parts[now.part].target);
    gl.uniform2f(places.scale, (2 * perUnit()) / width, (2 * perUnit()) / height);
    gl.uniform2f(places.shift, (2 * view.x) / width, (-2 * view.y) / height);
    gl.uniform1i(places.coloured, now.mode === "shaded" ? 0 : 1);
    gl.drawArrays(gl.TRIANGLES, 0, corners);
  }

  const redraw = () => (request ||= requestAnimationFrame(draw));

  function reset() {
    Object.assign(view, home, { zoom: 1, x: 0, y: 0 });
    redraw();
  }

  // ---- what is shown
  function say(text) {
    message.textContent = text;
    message.hidden = !text;
  }

  /** What is chosen: a contender's mesh or the truth. */
  const chosen = () => {
    const part = settings.parts[now.part];
    return now.mesh === TRUTH ? part.truth : part.meshes[now.mesh];
  };

  function offer() {
    const part = settings.parts[now.part], names = part.meshes.map((mesh, k) => [k, mesh.name]);
    const options = [...(part.truth ? [[TRUTH, "truth"]] : []), ...names].map(([k, name]) => new Option(name, k));
    meshChoice.replaceChildren(...options);
    if (!options.some((option) => Number(option.value) === now.mesh)) now.mesh = Number(options[0].value);
    meshChoice.value = now.mesh;
    partChoice.value = now.part;
    for (const mode of modes) {
      mode.disabled = !(mode.value in chosen().captions);
      if (mode.disabled && now.mode === mode.value) now.mode = "shaded";
    }
    for (const mode of modes) mode.checked = mode.value === now.mode;
    const scale = element("v-scale");
    scale.hidden = now.mode === "shaded" || !part.ticks.length;
    scale.lastElementChild.replaceChildren(...part.ticks.map(([place, text]) => {
      const tick = document.createElement("span");
      tick.style.left = `${100 * place}%`;
      tick.textContent = text;
      return tick;
    }));
  }

  async function show() {
    const part = settings.parts[now.part], turn = ++shown;
    offer();
    element("v-said").textContent = chosen().captions[now.mode];
    if (!gl) return;
    const mesh = chosen(), scene = now.mode === "missed" ? part.truth.scene : mesh.scene;
    corners = 0;
    say(scene ? "" : "There is no mesh of this contender for this part.");
    if (scene) {
      const found = await packedScenes.unpacked(scene);
      if (now.mode === "missed") found.levels = await packedScenes.bytes(mesh.missed);
      if (turn !== shown) return; // something else was chosen meanwhile
      upload(packedScenes.expanded(found, settings.crease, settings.unknown));
    }
    canvas.dataset.shown = `${now.part} ${now.mesh} ${now.mode}`;
    redraw();
  }

  function open(part, mesh, mode, from = settings) {
    const other = part !== now.part || !dialog.open;
    Object.assign(now, { part, mesh, mode });
    Object.assign(home, { azimuth: Number(from.azimuth), elevation: Number(from.elevation) });
    if (!dialog.open) dialog.showModal();
    if (!gl && !prepare()) {
      say("This browser cannot draw the view in 3D: it needs WebGL2 and DecompressionStream. The pictures in the page show the same.");
    }
    if (other) reset();
    canvas.focus();
    show();
  }

  const choose = (changes) => show(Object.assign(now, changes));

  function next(steps) {
    const values = [...meshChoice.options].map((option) => Number(option.value));
    choose({ mesh: values[(values.indexOf(now.mesh) + steps + values.length) % values.length] });
  }

  function nextMode() {
    const free = modes.filter((mode) => !mode.disabled).map((mode) => mode.value);
    choose({ mode: free[(free.indexOf(now.mode) + 1) % free.length] });
  }

  // ---- pointer, wheel, keys
  function turn(right, down) {
    view.azimuth -= right;
    view.elevation = Math.max(-90, Math.min(90, view.elevation + down));
    redraw();
  }

  function move(right, down) {
    Object.assign(view, { x: view.x + right, y: view.y + down });
    redraw();
  }

  /** What is under a place of the canvas, in pixels from its middle, stays there. */
  function zoom(factor, x = 0, y = 0) {
    const changed = Math.max(0.2, Math.min(100, view.zoom * factor)) / view.zoom;
    view.zoom *= changed;
    view.x = x + (view.x - x) * changed;
    view.y = y + (view.y - y) * changed;
    redraw();
  }

  const fingers = new Map();
  const fromMiddle = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, fromMiddle(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const after = fromMiddle(event), [right, down] = [after[0] - before[0], after[1] - before[1]];
    const other = [...fingers.entries()].find(([id]) => id !== event.pointerId)?.[1];
    fingers.set(event.pointerId, after);
    if (other) {
      const apart = (place) => Math.hypot(place[0] - other[0], place[1] - other[1]);
      zoom(apart(after) / Math.max(apart(before), 1), (after[0] + other[0]) / 2, (after[1] + other[1]) / 2);
      move(right / 2, down / 2);
    } else if (event.shiftKey || event.buttons & 6) move(right, down);
    else turn(right * 0.45, down * 0.45);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", reset);
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), ...fromMiddle(event));
  }, { passive: false });

  const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const KEYS = { "+": () => zoom(1.2), "=": () => zoom(1.2), "-": () => zoom(1 / 1.2), 0: reset, e: nextMode,
    n: () => next(1), p: () => next(-1) };
  dialog.addEventListener("keydown", (event) => {
    if (event.target.matches("select, input") || event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = ARROWS[event.key], key = KEYS[event.key.toLowerCase()];
    if (!arrow && !key) return;
    event.preventDefault();
    if (key) key();
    else if (event.shiftKey) move(-20 * arrow[0], -20 * arrow[1]);
    else turn(5 * arrow[0], 5 * arrow[1]);
  });

  // ---- the page
  partChoice.append(...settings.parts.map((part, k) => new Option(part.name, k)));
  partChoice.parentNode.hidden = settings.parts.length < 2;
  meshChoice.parentNode.hidden = settings.parts.every((part) => !part.truth && part.meshes.length < 2);
  partChoice.addEventListener("change", () => {
    now.part = Number(partChoice.value);
    reset();
    show();
  });
  meshChoice.addEventListener("change", () => choose({ mesh: Number(meshChoice.value) }));
  for (const mode of modes) mode.addEventListener("change", () => choose({ mode: mode.value }));
  element("v-reset").addEventListener("click", reset);
  element("v-close").addEventListener("click", () => dialog.close());
  element("open3d").addEventListener("click", () => open(now.part, now.mesh, now.mode));
  for (const shot of document.querySelectorAll("button.shot")) {
    const { part, mesh, mode, azimuth } = shot.dataset;
    const from = azimuth === undefined ? settings : shot.dataset;
    shot.addEventListener("click", () => open(Number(part), Number(mesh), mode, from));
  }
  new ResizeObserver(redraw).observe(canvas);
})();
