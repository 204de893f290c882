"use strict";
// Where the page's data come from: its own server, or the page itself. The inverse of weingarten.view.item.
const source = (() => {
  const MOST = 300; // items that are kept
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const facts = read("facts"), kept = new Map();

  function address(name, values = {}) {
    const pairs = Object.entries(values).filter(([, value]) => value !== null);
    return pairs.length ? `${name}?${pairs.map((pair) => pair.join("=")).join("&")}` : name;
  }

  async function asked(where) {
    const answer = await fetch(where, { cache: "no-store" });
    if (!answer.ok) throw new Error(await answer.text());
    return answer;
  }

  async function bytes(where) {
    if (facts.live) return new Uint8Array(await (await asked(where)).arrayBuffer());
    return packedScenes.decoded(read(where));
  }

  async function opened(where) {
    const data = await packedScenes.inflated(await bytes(where));
    const length = new DataView(data.buffer).getUint32(0, true);
    return { ...JSON.parse(new TextDecoder().decode(data.subarray(4, 4 + length))), data: data.subarray(4 + length) };
  }

  /** An item: its values, and `data`. */
  function item(name, values) {
    const where = address(name, values);
    if (!kept.has(where)) {
      const made = opened(where);
      made.catch(() => kept.delete(where));
      kept.set(where, made);
      if (kept.size > MOST) kept.delete(kept.keys().next().value);
    }
    return kept.get(where);
  }

  const state = async () => (facts.live ? (await asked("state")).json() : read("state"));
  const forget = () => kept.clear();

  return { facts, item, state, forget };
})();
