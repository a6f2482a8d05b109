// One page of an analysis: its command is copied by a click.
"use strict";
for (const line of document.querySelectorAll(".copy")) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = "Copy";
  button.addEventListener("click", () => navigator.clipboard.writeText(line.querySelector("code").textContent)
    .then(() => { button.textContent = "Copied"; }, () => { button.textContent = "Not allowed"; }));
  line.append(button);
}
