"use strict";
// Tables that sort by a click on a head.
(() => {
  const value = (cell) => (cell.dataset.value === undefined ? null : Number(cell.dataset.value));

  function compare(one, other, column, sign) {
    const [a, b] = [one.cells[column], other.cells[column]];
    const [x, y] = [value(a), value(b)];
    if (x !== null && y !== null) return sign * (x - y);
    if (x !== null || y !== null) return x === null ? 1 : -1; // what has no value comes last
    return sign * a.textContent.localeCompare(b.textContent, "en", { numeric: true });
  }

  function sort(table, head) {
    const column = head.cellIndex;
    const sign = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    for (const other of head.parentNode.cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
    const body = table.tBodies[0];
    const rows = [...body.rows];
    const free = rows.filter((row) => !row.classList.contains("pinned"));
    free.sort((one, other) => compare(one, other, column, sign));
    body.append(...free, ...rows.filter((row) => row.classList.contains("pinned")));
  }

  for (const table of document.querySelectorAll("table.sortable")) {
    for (const head of table.tHead.rows[0].cells) {
      head.firstElementChild.addEventListener("click", () => sort(table, head));
    }
  }
})();
