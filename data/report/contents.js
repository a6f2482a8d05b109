// Every page: folded parts, and the contents on a narrow screen.
"use strict";
(() => {
  // A link to a folded page of the documentation unfolds it.
  const unfold = () => {
    const target = location.hash && document.getElementById(location.hash.slice(1));
    if (target && target.tagName === "DETAILS") target.open = true;
  };
  window.addEventListener("hashchange", unfold);
  unfold();
  if (matchMedia("(max-width: 900px)").matches) document.querySelectorAll(".toc details").forEach((toc) => { toc.open = false; });
})();
