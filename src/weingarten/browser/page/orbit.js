"use strict";
// The camera of a view in 3D, turned by pointer, wheel and keys: x right, y up, z towards the viewer, parallel
// projection. start: azimuth and elevation, degrees. changed: called whenever something has to be drawn anew.
const orbit = (canvas, start, changed) => {
  const view = { azimuth: 0, elevation: 0, zoom: 1, x: 0, y: 0 };

  /** Rows: what is right, up and towards the viewer, in the world. */
  function axes() {
    const [a, e] = [view.azimuth, view.elevation].map((degrees) => (degrees * Math.PI) / 180);
    const back = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    const right = [-Math.sin(a), Math.cos(a), 0];
    const up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
    return [right, up, back];
  }

  function set(changes) {
    Object.assign(view, changes);
    changed();
  }

  const reset = () => set({ azimuth: start.azimuth, elevation: start.elevation, zoom: 1, x: 0, y: 0 });

  function turn(right, down) {
    set({ azimuth: view.azimuth - right, elevation: Math.max(-90, Math.min(90, view.elevation + down)) });
  }

  const move = (right, down) => set({ x: view.x + right, y: view.y + down });

  /** What is under a place of the canvas, in pixels from its middle, stays there. */
  function zoom(factor, x = 0, y = 0) {
    const by = Math.max(0.2, Math.min(100, view.zoom * factor)) / view.zoom;
    set({ zoom: view.zoom * by, x: x + (view.x - x) * by, y: y + (view.y - y) * by });
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
  const KEYS = { "+": () => zoom(1.2), "=": () => zoom(1.2), "-": () => zoom(1 / 1.2), 0: reset };

  /** Do what a key stands for; whether it stands for anything. */
  function key(event) {
    const arrow = ARROWS[event.key], own = KEYS[event.key];
    if (own) own();
    else if (arrow && event.shiftKey) move(-20 * arrow[0], -20 * arrow[1]);
    else if (arrow) turn(5 * arrow[0], 5 * arrow[1]);
    return Boolean(own || arrow);
  }

  return { view, axes, set, reset, key };
};
