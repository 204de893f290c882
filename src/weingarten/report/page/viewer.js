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

  let gl = null, surface = null, request = 0, shown = 0;
  const now = { part: 0, mesh: TRUTH, mode: "shaded" };
  const redraw = () => (request ||= requestAnimationFrame(draw));
  const camera = orbit(canvas, settings, redraw);

  function prepare() {
    gl = canvas.getContext("webgl2", { antialias: true });
    if (typeof DecompressionStream === "undefined") gl = null;
    if (!gl) return false;
    surface = surfaces(gl, settings.light);
    surface.paint(settings.colours);
    gl.enable(gl.DEPTH_TEST);
    return true;
  }

  /** Pixels of a unit length. */
  function perUnit() {
    const part = settings.parts[now.part];
    return camera.view.zoom * Math.min(canvas.clientWidth / part.extent, canvas.clientHeight / part.tall);
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
    const scale = [(2 * perUnit()) / width, (2 * perUnit()) / height];
    const shift = [(2 * camera.view.x) / width, (-2 * camera.view.y) / height];
    const target = settings.parts[now.part].target;
    surface.draw({ axes: camera.axes(), target, scale, shift }, now.mode !== "shaded");
  }

  // ---- what is shown
  function say(text) {
    message.textContent = text;
    message.hidden = !text;
  }

  function offer() {
    const part = settings.parts[now.part], names = part.meshes.map((mesh, k) => [k, mesh.name]);
    const options = [...(part.truth ? [[TRUTH, "truth"]] : []), ...names].map(([k, name]) => new Option(name, k));
    meshChoice.replaceChildren(...options);
    if (!options.some((option) => Number(option.value) === now.mesh)) now.mesh = Number(options[0].value);
    meshChoice.value = now.mesh;
    partChoice.value = now.part;
    for (const mode of modes) {
      mode.disabled = mode.value !== "shaded" && (now.mesh === TRUTH || !part.meshes[now.mesh].missed);
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

  function caption(part) {
    if (now.mesh === TRUTH) return `${part.name}: the truth`;
    const name = part.meshes[now.mesh].name;
    if (now.mode === "error") return `${part.name}: ${name}, distance of the mesh to the truth, ${part.unit}`;
    if (now.mode === "missed") return `${part.name}: the truth, distance to the mesh of ${name}, ${part.unit}`;
    return `${part.name}: ${name}`;
  }

  async function show() {
    const part = settings.parts[now.part], turn = ++shown;
    offer();
    element("v-said").textContent = caption(part);
    if (!gl) return;
    const mesh = now.mesh === TRUTH ? null : part.meshes[now.mesh];
    const scene = now.mode === "missed" || !mesh ? part.truth : mesh.scene;
    surface.clear();
    say(scene ? "" : "There is no mesh of this contender for this part.");
    if (scene) {
      const found = packedScenes.unpacked(scene, await packedScenes.bytes(scene.id));
      if (now.mode === "missed") found.levels = await packedScenes.bytes(mesh.missed);
      if (turn !== shown) return; // something else was chosen meanwhile
      surface.upload(packedScenes.expanded(found, settings.crease));
    }
    canvas.dataset.shown = `${now.part} ${now.mesh} ${now.mode}`;
    redraw();
  }

  function open(part, mesh, mode) {
    const other = part !== now.part || !dialog.open;
    Object.assign(now, { part, mesh, mode });
    if (!dialog.open) dialog.showModal();
    if (!gl && !prepare()) {
      say("This browser cannot draw the view in 3D: it needs WebGL2 and DecompressionStream. The pictures in the page show the same.");
    }
    if (other) camera.reset();
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

  const KEYS = { e: nextMode, n: () => next(1), p: () => next(-1) };
  dialog.addEventListener("keydown", (event) => {
    if (event.target.matches("select, input") || event.ctrlKey || event.metaKey || event.altKey) return;
    const key = KEYS[event.key.toLowerCase()];
    if (key) key();
    if (key || camera.key(event)) event.preventDefault();
  });

  // ---- the page
  partChoice.append(...settings.parts.map((part, k) => new Option(part.name, k)));
  partChoice.addEventListener("change", () => {
    now.part = Number(partChoice.value);
    camera.reset();
    show();
  });
  meshChoice.addEventListener("change", () => choose({ mesh: Number(meshChoice.value) }));
  for (const mode of modes) mode.addEventListener("change", () => choose({ mode: mode.value }));
  element("v-reset").addEventListener("click", camera.reset);
  element("v-close").addEventListener("click", () => dialog.close());
  element("open3d").addEventListener("click", () => open(now.part, now.mesh, now.mode));
  for (const shot of document.querySelectorAll("button.shot")) {
    const { part, mesh, mode } = shot.dataset;
    shot.addEventListener("click", () => open(Number(part), Number(mesh), mode));
  }
  new ResizeObserver(redraw).observe(canvas);
})();
