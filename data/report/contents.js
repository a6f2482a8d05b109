// Every page: folded parts, the contents on a narrow screen, and the button that copies a command.
"use strict";
function copyable(line) {
  const button = document.createElement("button");
  button.textContent = "Copy";
  button.type = "button";
  line.append(button);
  button.addEventListener("click", () => {
    const code = line.querySelector("code");
    const selected = document.createRange();
    selected.selectNodeContents(code);
    getSelection().removeAllRanges();
    getSelection().addRange(selected);
    if (navigator.clipboard) navigator.clipboard.writeText(code.textContent).catch(() => {});
    else document.execCommand("copy");
    button.textContent = "Copied";
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  });
}
document.querySelectorAll(".copy").forEach(copyable);
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
