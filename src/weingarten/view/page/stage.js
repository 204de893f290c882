"use strict";
// The stage: surface, points and cross-section in one picture, with a triad and a ruler. Null without WebGL2.
function stageOf(canvas, facts) {
  const gl = webgl(canvas), triad = document.getElementById("triad"), ruler = document.getElementById("ruler");
  const shows = { mesh: true, points: false, cut: false, coloured: false };
  const fit = { target: [0, 0, 0], radius: 1 };
  const ROOM = 1.06, RULER = 110, PAINT = { light: [0.10, 0.37, 0.63], dark: [0.30, 0.55, 0.88] };
  const redraw = redrawing(draw), camera = orbit(canvas, facts, redraw);
  const surface = gl && surfaces(gl, facts.light), cloud = gl && clouds(gl), cut = gl && cuts(gl);
  if (!gl) {
    document.getElementById("overlay").hidden = true;
    return null;
  }

  /** All of these places are in the picture, however it is turned. */
  function fitTo(positions) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    positions.forEach((value, i) => {
      low[i % 3] = Math.min(low[i % 3], value);
      high[i % 3] = Math.max(high[i % 3], value);
    });
    fit.target = low.map((value, k) => (value + high[k]) / 2);
    let most = 0;
    for (let i = 0; i < positions.length; i += 3) {
      most = Math.max(most, Math.hypot(...fit.target.map((value, k) => positions[i + k] - value)));
    }
    fit.radius = most || 1;
    redraw();
  }

  const perUnit = () => (camera.view.zoom * Math.min(canvas.clientWidth, canvas.clientHeight)) / (2 * ROOM * fit.radius);

  function draw() {
    const dense = cleared(gl, canvas), view = viewOf(camera, canvas, fit.target, perUnit());
    if (shows.cut) view.cut = cut.away(view.axes[2]);
    const night = matchMedia("(prefers-color-scheme: dark)").matches;
    if (shows.mesh) surface.draw(view, shows.coloured);
    if (shows.points) cloud.draw(view, dense * Math.max(2, Math.min(6, 2 * Math.sqrt(camera.view.zoom))), night ? PAINT.dark : PAINT.light);
    if (shows.cut) cut.draw(view);
    measure(view.axes);
  }

  /** The triad, those that point away first, and a ruler of 1, 2 or 5 times a power of ten. */
  function measure([right, up, back]) {
    const names = ["x", "y", "z"], paints = ["#c8452f", "#3d8b3d", "#2f6bc8"];
    const order = [0, 1, 2].sort((a, b) => back[a] - back[b]);
    triad.innerHTML = order.map((k) => {
      const [x, y] = [26 * right[k], -26 * up[k]];
      return `<line x2="${x}" y2="${y}" stroke="${paints[k]}" stroke-width="2"/><text x="${1.32 * x}" y="${1.32 * y}" fill="${paints[k]}">${names[k]}</text>`;
    }).join("");
    const pixels = perUnit() / facts.frame.scale, wanted = RULER / pixels, power = 10 ** Math.floor(Math.log10(wanted));
    const length = [5, 2, 1].find((step) => step * power <= wanted) * power;
    ruler.firstElementChild.style.width = `${length * pixels}px`;
    ruler.lastElementChild.textContent = `${Number(length.toPrecision(1))} in ${facts.unit}`;
  }

  new ResizeObserver(redraw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (camera.key(event)) event.preventDefault();
  });
  camera.reset();
  return { shows, surface, cloud, cut, camera, fitTo, redraw };
}
