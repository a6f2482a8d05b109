// Button of pages with drawn charts: it copies a command.
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
