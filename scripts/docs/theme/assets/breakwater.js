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

// The head of a table in .sortable sorts by its column: numbers by value, then words, then empty cells.
const kTen = "⁰¹²³⁴⁵⁶⁷⁸⁹";
function valueOf(cell) {
  const text = cell.textContent.trim().replace("−", "-");
  const number = text.match(/^[<~± ]*(-?[\d.]+(?:e-?\d+)?)(?:·10(⁻?)([⁰¹²³⁴⁵⁶⁷⁸⁹]+))?/);
  if (!number) return text && text !== "–" ? [1, text] : [2, ""];
  const power = number[3] ? [...number[3]].reduce((sum, digit) => 10 * sum + kTen.indexOf(digit), 0) : 0;
  return [0, Number(number[1]) * 10 ** (number[2] ? -power : power)];
}
function compare([kind, a], [otherKind, b]) {
  if (kind !== otherKind) return kind - otherKind;
  return kind === 0 ? a - b : a.localeCompare(b);
}
for (const head of document.querySelectorAll(".sortable th")) {
  const button = document.createElement("button");
  button.append(...head.childNodes);
  head.append(button);
  button.addEventListener("click", () => {
    const rises = head.ariaSort !== "ascending", body = head.closest("table").tBodies[0];
    for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
    head.ariaSort = rises ? "ascending" : "descending";
    body.append(...[...body.rows].sort((a, b) =>
        (rises ? 1 : -1) * compare(valueOf(a.cells[head.cellIndex]), valueOf(b.cells[head.cellIndex]))));
  });
}
