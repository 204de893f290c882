"use strict";
// The loss over the steps, on a logarithmic axis, with the snapshots below and the step that is shown.
function lossCurve(plot) {
  const NAMES = "http://www.w3.org/2000/svg", WIDTH = 300, TOP = 8, BASE = 84, LEFT = 34, RIGHT = 292;

  function made(kind, attributes, text = "") {
    const one = document.createElementNS(NAMES, kind);
    for (const [name, value] of Object.entries(attributes)) one.setAttribute(name, value);
    one.textContent = text;
    return one;
  }

  /** curve: steps and losses. of: steps planned. steps: of the snapshots. at: the step that is shown. */
  function draw({ step, loss }, of, steps, at) {
    plot.setAttribute("viewBox", `0 0 ${WIDTH} 108`);
    const x = (value) => LEFT + ((RIGHT - LEFT) * value) / Math.max(of, 1), parts = [];
    parts.push(made("line", { class: "axis", x1: LEFT, x2: RIGHT, y1: BASE, y2: BASE }));
    if (step.length) {
      const sorted = [...loss].sort((a, b) => a - b), low = Math.log10(sorted[0]), high = Math.log10(sorted.at(-1));
      const room = Math.max(high - low, 0.1), y = (value) => BASE - 6 - ((BASE - 6 - TOP) * (Math.log10(value) - low)) / room;
      const powers = Array.from({ length: Math.floor(high) - Math.floor(low) + 1 }, (_, k) => 10 ** (Math.floor(low) + k));
      for (const value of powers.flatMap((power) => (high - low > 2 ? [power] : [power, 2 * power, 5 * power]))) {
        if (Math.log10(value) < low || Math.log10(value) > high) continue;
        const height = y(value);
        parts.push(made("line", { class: "grid", x1: LEFT, x2: RIGHT, y1: height, y2: height }));
        parts.push(made("text", { x: LEFT - 5, y: height + 3, "text-anchor": "end" }, String(Number(value.toPrecision(1)))));
      }
      const points = step.map((value, k) => `${x(value).toFixed(1)},${y(loss[k]).toFixed(1)}`).join(" ");
      parts.push(made("polyline", { class: "loss", points }));
    }
    for (const value of steps) parts.push(made("line", { class: value === at ? "tick now" : "tick", x1: x(value), x2: x(value), y1: BASE, y2: BASE + 5 }));
    if (at !== null) parts.push(made("line", { class: "at", x1: x(at), x2: x(at), y1: TOP, y2: BASE }));
    parts.push(made("text", { x: LEFT, y: 102 }, "0"), made("text", { x: RIGHT, y: 102, "text-anchor": "end" }, of.toLocaleString("en")));
    parts.push(made("text", { x: (LEFT + RIGHT) / 2, y: 102, "text-anchor": "middle" }, "steps · loss above, snapshots as ticks"));
    plot.replaceChildren(...parts);
  }

  return { draw };
}
