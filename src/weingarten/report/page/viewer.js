"use strict";
// The view in 3D: which part, which mesh, in which colours. World: the unit frame of a part's scenes.
(() => {
  const settings = JSON.parse(document.getElementById("viewing").textContent);
  const element = (id) => document.getElementById(id);
  const dialog = element("viewer"), canvas = element("v-canvas"), message = element("v-message");
  const partChoice = element("v-part"), meshChoice = element("v-mesh");
  const modes = [...document.querySelectorAll("input[name=v-mode]")];
  const TRUTH = -1;

  const now = { part: 0, mesh: TRUTH, mode: settings.mode };
  const home = { azimuth: settings.azimuth, elevation: settings.elevation };
  const redraw = redrawing(draw), camera = orbit(canvas, home, redraw);
  let gl = null, surface = null, shown = 0;

  function prepare() {
    gl = webgl(canvas);
    if (!gl) return false;
    surface = surfaces(gl, settings.light);
    surface.paint(settings.colours);
    return true;
  }

  function draw() {
    if (!gl || !dialog.open) return;
    const { target, extent, tall } = settings.parts[now.part];
    const perUnit = camera.view.zoom * Math.min(canvas.clientWidth / extent, canvas.clientHeight / tall);
    cleared(gl, canvas);
    surface.draw(viewOf(camera, canvas, target, perUnit), now.mode !== "shaded");
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
    scale.lastElementChild.replaceChildren(...ticksOf(part.ticks));
  }

  const bytes = (id) => packedScenes.inflated(packedScenes.decoded(element(id).textContent));

  async function show() {
    const part = settings.parts[now.part], turn = ++shown;
    offer();
    element("v-said").textContent = chosen().captions[now.mode];
    if (!gl) return;
    const mesh = chosen(), scene = now.mode === "missed" ? part.truth.scene : mesh.scene;
    surface.clear();
    say(scene ? "" : "There is no mesh of this contender for this part.");
    if (scene) {
      const found = packedScenes.unpacked(scene, await bytes(scene.id));
      if (now.mode === "missed") found.levels = await bytes(mesh.missed);
      if (turn !== shown) return; // something else was chosen meanwhile
      surface.upload(packedScenes.expanded(found, settings.crease, settings.unknown));
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
    const own = KEYS[event.key.toLowerCase()];
    if (own) own();
    else if (!camera.key(event)) return;
    event.preventDefault();
  });

  // ---- the page
  partChoice.append(...settings.parts.map((part, k) => new Option(part.name, k)));
  partChoice.parentNode.hidden = settings.parts.length < 2;
  meshChoice.parentNode.hidden = settings.parts.every((part) => !part.truth && part.meshes.length < 2);
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
    const { part, mesh, mode, azimuth } = shot.dataset;
    const from = azimuth === undefined ? settings : shot.dataset;
    shot.addEventListener("click", () => open(Number(part), Number(mesh), mode, from));
  }
  new ResizeObserver(redraw).observe(canvas);
})();
