// Maths: what pymdownx.arithmatex marked, by KaTeX.
document.addEventListener("DOMContentLoaded", () => {
  for (const place of document.querySelectorAll(".arithmatex")) {
    const text = place.textContent;  // \(…\) or \[…\]
    katex.render(text.slice(2, -2), place, {
      displayMode: text.startsWith("\\["),
      throwOnError: false,
    });
  }
});

// A number and its unit stay on one line; a table that is too wide scrolls.
for (const cell of document.querySelectorAll(".md-typeset td")) {
  if (cell.textContent.length < 20) cell.classList.add("short");
}
