"use strict";
// The list of parts that folds, and the way to a part that is folded.
(() => {
  const parts = [...document.querySelectorAll("details.part")];
  const fold = (open) => () => parts.forEach((part) => (part.open = open));
  document.getElementById("unfold").addEventListener("click", fold(true));
  document.getElementById("fold").addEventListener("click", fold(false));

  function arrive() {
    const target = document.getElementById(location.hash.slice(1));
    if (target && target.matches("details.part")) {
      target.open = true;
      target.scrollIntoView();
    }
  }
  window.addEventListener("hashchange", arrive);
  arrive();
})();
