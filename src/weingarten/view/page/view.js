"use strict";
// The page: what is chosen, what is shown of it, and how the run stands.
(() => {
  const { facts } = source, element = (id) => document.getElementById(id);
  const AXES = ["x", "y", "z"], FINAL = null, EVERY = 1000, SELDOM = 5000, PLAY = 450;
  const FACING = { x: [0, 0], y: [-90, 0], z: [-90, 90] };
  const stage = stageOf(element("canvas"), facts);
  const now = { step: FINAL, by: "plain", axis: "y", place: Math.floor((facts.cuts - 1) / 2) };
  const shown = { mesh: "", colours: "", section: "", offered: "" };
  let state = null, stops = [], mesh = null, follows = true, busy = false, again = false, playing = 0, fitted = false;

  const number = (value) => value.toLocaleString("en");
  const digits = (value) => String(Number(value.toPrecision(5))).replace("-", "−");

  function say(text) {
    element("message").textContent = text;
    element("message").hidden = !text;
  }

  // ---- what is shown: one thing after another, always the last that was chosen
  async function refresh() {
    if (!stage || !state) return;
    again = busy;
    delete element("canvas").dataset.shown;
    if (busy) return;
    busy = true;
    document.body.classList.add("busy");
    try {
      await showSurface();
      await showColours();
      await showSection();
      say(stops.length || !state.status ? "" : "There is no surface yet.");
    } catch (error) {
      say(error.message);
    }
    busy = false;
    stage.redraw();
    if (again) return void refresh();
    document.body.classList.remove("busy");
    element("canvas").dataset.shown = [shown.mesh, shown.colours, stage.shows.cut ? shown.section : "whole"].join(" ");
  }

  const surfaceName = (step) => (step === FINAL ? `final${state.final}` : `step${step}`);

  async function showSurface() {
    const step = now.step, name = surfaceName(step);
    if (name === shown.mesh || !stops.includes(step)) return;
    Object.assign(shown, { mesh: "", colours: "", section: "" });
    stage.surface.clear();
    const found = await source.item("scene", { step }), unpacked = packedScenes.unpacked(found, found.data);
    mesh = { ...found, indices: unpacked.indices };
    stage.surface.upload(packedScenes.expanded(unpacked, facts.crease));
    if (!fitted) stage.fitTo(unpacked.positions);
    fitted = true;
    shown.mesh = name;
    offer(found.colourings);
    count();
  }

  async function showColours() {
    const name = now.by;
    if (!shown.mesh || name === shown.colours) return;
    if (name !== "plain") {
      const found = await source.item("colours", { by: name, step: now.step });
      const places = found.per === "face" ? (i) => Math.floor(i / 3) : (i) => mesh.indices[i];
      stage.surface.recolour(Uint8Array.from({ length: 3 * mesh.faces }, (_, i) => found.data[places(i)]));
      stage.surface.paint(facts.maps[found.map]);
      legend(found);
    }
    shown.colours = name;
    stage.shows.coloured = name !== "plain";
    element("scale").hidden = name === "plain";
  }

  async function showSection() {
    const at = Math.round((1000 * now.place) / (facts.cuts - 1)), name = `${now.axis}${at}`;
    const known = facts.live || now.step === stops.at(-1); // a page without a server has those of the last surface
    stage.shows.cut &&= known && Boolean(shown.section);
    if (!element("show-cut").checked || !facts.box || !known || !shown.mesh || name === shown.section) return;
    stage.cut.upload(await source.item("section", { axis: now.axis, at, step: now.step }));
    shown.section = name;
    stage.shows.cut = true;
  }

  // ---- panel
  function offer(colourings) {
    const key = JSON.stringify(colourings);
    if (key === shown.offered) return;
    shown.offered = key;
    const options = [["plain", "Plain"], ...colourings];
    element("by").replaceChildren(...options.map(([value, title]) => new Option(title, value)));
    if (!options.some(([value]) => value === now.by)) now.by = "plain";
    element("by").value = now.by;
    element("colouring").hidden = options.length === 1;
  }

  function legend({ map, ticks, unit, legend: names = [] }) {
    const paints = facts.maps[map], canvas = element("map"), pen = canvas.getContext("2d"), image = pen.createImageData(256, 1);
    for (let i = 0; i < 256; i++) image.data.set([...paints.slice(3 * i, 3 * i + 3), 255], 4 * i);
    pen.putImageData(image, 0, 0);
    canvas.hidden = !ticks.length;
    element("scale").querySelector(".ticks").replaceChildren(...ticksOf(ticks));
    element("scale").querySelector(".ticks").hidden = !ticks.length;
    element("unit").textContent = unit;
    element("names").replaceChildren(...names.map(([paint, name]) => {
      const row = document.createElement("li"), spot = document.createElement("i");
      spot.style.background = `rgb(${paints.slice(3 * paint, 3 * paint + 3).join(",")})`;
      row.append(spot, name);
      return row;
    }));
  }

  function count() {
    const said = [];
    if (mesh) said.push(`${number(mesh.whole)} triangles`);
    if (facts.points) said.push(`${number(facts.points)} points`);
    element("counts").textContent = said.join(" · ");
    const notes = [...state.facts, ...(mesh && mesh.note ? [mesh.note] : []), ...(facts.thinned ? [facts.thinned] : [])];
    element("notes").lastElementChild.replaceChildren(...notes.map((note) => Object.assign(document.createElement("li"), { textContent: note })));
    element("notes").hidden = !notes.length;
  }

  function cutting() {
    const on = element("show-cut").checked;
    element("cutting").hidden = !on;
    if (!facts.box) return;
    const k = AXES.indexOf(now.axis), { lower, upper } = facts.box, part = now.place / (facts.cuts - 1);
    const known = facts.live || !state || now.step === stops.at(-1);
    element("where").textContent = known ? `${now.axis} = ${digits(lower[k] + part * (upper[k] - lower[k]))}` : "of the last surface alone";
    element("spacing").textContent = `· level lines every ${digits(facts.spacing)}`;
  }

  function stepping() {
    element("stepping").hidden = !state.status || (!state.steps.length && !state.curve.step.length);
    const slider = element("step"), at = Math.max(0, stops.indexOf(now.step));
    slider.max = Math.max(0, stops.length - 1);
    slider.value = at;
    slider.disabled = element("play").disabled = stops.length < 2;
    if (!state.status) return;
    const { of } = state.status;
    element("at").textContent = !stops.length ? "" : now.step === FINAL ? "The final mesh" : `Step ${number(now.step)} of ${number(of)}, extracted coarsely`;
    curve.draw(state.curve, of, state.steps, now.step === FINAL ? null : now.step);
  }

  function standing() {
    const box = element("status");
    box.hidden = !state.status;
    if (!state.status) return;
    box.className = state.status.kind;
    box.lastElementChild.textContent = state.status.text;
  }

  // ---- how the run stands
  function take(found) {
    if (state && found.version !== state.version) return location.reload();
    if (state && found.final !== state.final) source.forget();
    state = found;
    stops = [...state.steps, ...(state.final ? [FINAL] : [])];
    if (stops.length && (follows || !stops.includes(now.step))) now.step = stops.at(-1);
    standing();
    stepping();
    count();
    refresh();
  }

  async function follow() {
    let pause = SELDOM;
    try {
      if (!document.hidden) take(await source.state());
      if (state.status && state.status.kind !== "ended") pause = EVERY;
    } catch {
      element("status").hidden = false;
      element("status").className = "silent";
      element("status").lastElementChild.textContent = "The viewer has ended; this page shows what it had.";
    }
    if (facts.live && (!state || state.status)) setTimeout(follow, pause);
  }

  function go(index) {
    now.step = stops[index];
    follows = index === stops.length - 1;
    stepping();
    cutting();
    refresh();
  }

  function play() {
    clearInterval(playing);
    element("play").textContent = playing ? "▶" : "❚❚";
    if (playing) return void (playing = 0);
    if (stops.indexOf(now.step) === stops.length - 1) go(0);
    playing = setInterval(() => {
      if (busy) return;
      go(stops.indexOf(now.step) + 1);
      if (stops.indexOf(now.step) === stops.length - 1) play();
    }, PLAY);
  }

  async function showPoints() {
    const found = await source.item("points"), places = packedScenes.places(found.data, found);
    facts.thinned = found.vertices < found.given ? `${number(found.vertices)} of the ${number(found.given)} points are drawn.` : "";
    stage.cloud.upload(places);
    stage.fitTo(places);
    fitted = true;
  }

  // ---- what may be chosen
  const curve = lossCurve(element("curve"));
  const choose = (changes) => {
    Object.assign(now, changes);
    cutting();
    refresh();
  };
  const switches = { mesh: "show-mesh", points: "show-points" };
  for (const [what, id] of Object.entries(switches)) {
    element(id).addEventListener("change", () => {
      stage.shows[what] = element(id).checked;
      stage.redraw();
    });
  }
  element("show-cut").addEventListener("change", () => {
    if (!element("show-cut").checked) stage.shows.cut = false;
    else stage.shows.cut = Boolean(shown.section);
    choose({});
  });
  element("by").addEventListener("change", () => choose({ by: element("by").value }));
  for (const one of document.querySelectorAll("input[name=axis]")) one.addEventListener("change", () => choose({ axis: one.value }));
  element("place").max = facts.cuts - 1;
  element("place").value = now.place;
  element("place").addEventListener("input", () => choose({ place: Number(element("place").value) }));
  element("step").addEventListener("input", () => go(Number(element("step").value)));
  element("play").addEventListener("click", play);

  async function begin() {
    element("name").textContent = facts.name;
    element("show-cut").closest("label").hidden = !facts.box;
    if (!stage) {
      say("This browser cannot draw the part: it needs WebGL2 and DecompressionStream.");
      for (const id of ["shows", "colouring", "reset"]) element(id).hidden = true;
    } else {
      element("reset").addEventListener("click", stage.camera.reset);
      element("face").addEventListener("click", () => {
        const [azimuth, elevation] = FACING[now.axis];
        stage.camera.set({ azimuth, elevation, x: 0, y: 0 });
      });
    }
    const first = await source.state(), meshes = Boolean(first.status || first.final);
    if (stage) {
      element("show-points").checked = stage.shows.points = Boolean(facts.points) && !meshes;
      element("show-points").closest("label").hidden = !facts.points || !meshes;
      element("show-mesh").closest("label").hidden = !meshes;
      element("shows").hidden = !meshes || !(facts.points || facts.box);
      element("colouring").hidden = true;
      if (facts.points) await showPoints();
    }
    take(first);
    cutting();
    if (facts.live && first.status) setTimeout(follow, EVERY);
  }

  begin();
})();
