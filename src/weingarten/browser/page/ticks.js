"use strict";
/** The ticks of a scale of colours, from their places on it, 0 to 1, and what they say. */
const ticksOf = (ticks) => ticks.map(([place, text]) => {
  const tick = document.createElement("span");
  tick.style.left = `${100 * place}%`;
  tick.textContent = text;
  return tick;
});
