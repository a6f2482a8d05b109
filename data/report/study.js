// A study's report: selection of the metric, tips of the marks, and commands of the runs.
"use strict";
(() => {
  const data = pageData["study-runs"];
  const tip = document.getElementById("tip");
  const panel = document.getElementById("chosen");
  const command = document.getElementById("this-machine").dataset.command + " --replay ";
  const sections = Array.from(document.querySelectorAll(".metric"));

  // Shows one metric at a time. Without a script all are visible.
  const chooser = document.querySelector(".chooser");
  if (chooser && sections.length > 1) {
    const select = chooser.querySelector("select");
    for (const section of sections) select.add(new Option(section.dataset.name, section.id));
    const show = (id) => {
      if (!sections.some((section) => section.id === id)) return;
      for (const section of sections) section.hidden = section.id !== id;
      select.value = id;
    };
    select.addEventListener("change", () => {
      show(select.value);
      history.replaceState(null, "", "#" + select.value);
    });
    const follow = () => {
      show(location.hash.slice(1));
      const target = document.getElementById(location.hash.slice(1));
      if (target) target.scrollIntoView();
    };
    window.addEventListener("hashchange", follow);
    chooser.hidden = false;
    document.body.classList.add("chosen-by-script");
    show(sections[0].id);
    if (location.hash) follow();
  }

  function element(kind, parent, text) {
    const made = document.createElement(kind);
    if (text !== undefined) made.textContent = text;
    parent.appendChild(made);
    return made;
  }

  function inWords(run) {
    const [key, candidate, seed, ...values] = run;
    const parts = [data.candidates[candidate]];
    if (seed !== "") parts.push("seed " + seed);
    values.forEach((value, i) => parts.push(data.keys[i] + " = " + value));
    return key + ": " + parts.join(", ");
  }

  // The tip of a mark and its runs.
  function choose(text, runs) {
    panel.replaceChildren();
    const close = element("button", panel, "×");
    close.className = "close";
    close.type = "button";
    close.setAttribute("aria-label", "Close");
    close.addEventListener("click", () => { panel.hidden = true; });
    if (text) element("p", panel, text);
    for (const i of runs) {
      const run = data.runs[i];
      element("p", panel, inWords(run));
      const line = element("p", panel);
      line.className = "copy";
      element("code", line, command + run[0]);
      copyable(line);
    }
    panel.hidden = false;
  }

  // The cell of a heat map at a point of the window, or with a number.
  const grids = new Map();
  function gridOf(svg) {
    if (grids.has(svg)) return grids.get(svg);
    const [left, bottom, width, height, columns, rows] = svg.dataset.grid.split(" ").map(Number);
    const grid = {left, bottom, width, height, columns, rows, at: 0,
                  x: svg.dataset.x.split("\n"), y: svg.dataset.y.split("\n"),
                  values: svg.dataset.v.split(" "), counts: svg.dataset.n.split(" "),
                  runs: svg.dataset.r.split(" ")};
    grids.set(svg, grid);
    return grid;
  }
  function cellAt(svg, event) {
    const grid = gridOf(svg), box = svg.getBoundingClientRect();
    const scale = svg.viewBox.baseVal.width / box.width;
    const column = Math.floor(((event.clientX - box.left) * scale - grid.left) / grid.width);
    const row = Math.floor((grid.bottom - (event.clientY - box.top) * scale) / grid.height);
    if (column < 0 || column >= grid.columns || row < 0 || row >= grid.rows) return null;
    return row * grid.columns + column;
  }
  function cellText(svg, cell) {
    const grid = gridOf(svg);
    const [failed, runs] = grid.counts[cell].split("/");
    return svg.dataset.xTitle + " = " + grid.x[cell % grid.columns] + ", " +
           svg.dataset.yTitle + " = " + grid.y[Math.floor(cell / grid.columns)] + ": " +
           (grid.values[cell] === "-" ? "no value" : grid.values[cell]) + ", " + runs + " runs" +
           (failed === "0" ? "" : ", " + failed + " failed");
  }
  function frameCell(svg, cell) {
    const grid = gridOf(svg);
    grid.at = cell;
    const x = grid.left + grid.width * (cell % grid.columns);
    const y = grid.bottom - grid.height * (Math.floor(cell / grid.columns) + 1);
    svg.querySelector(".at").setAttribute("d", `M${x} ${y}h${grid.width}v${grid.height}h${-grid.width}z`);
  }
  function chooseCell(svg, cell) {
    frameCell(svg, cell);
    const run = gridOf(svg).runs[cell];
    choose(cellText(svg, cell), run === "-" ? [] : [Number(run)]);
  }

  // The text of a mark. A <title> would show a second, slower tip.
  function textOf(mark) {
    const title = mark.querySelector("title");
    if (title) {
      mark.dataset.text = title.textContent;
      title.remove();
    }
    return mark.dataset.text || inWords(data.runs[Number(mark.dataset.r)]);
  }
  function showTip(text, event) {
    tip.textContent = text;
    tip.hidden = false;
    const box = tip.getBoundingClientRect();
    tip.style.left = Math.max(4, Math.min(event.clientX + 12, innerWidth - box.width - 4)) + "px";
    tip.style.top = (event.clientY + 18 + box.height < innerHeight ? event.clientY + 18
                                                                  : event.clientY - box.height - 10) + "px";
  }
  addEventListener("pointermove", (event) => {
    if (event.pointerType === "touch") return;
    const target = event.target.closest ? event.target : null;
    const mark = target && target.closest("[data-r]");
    if (!mark) {
      tip.hidden = true;
    } else if (mark.classList.contains("heat")) {
      const cell = cellAt(mark, event);
      if (cell === null) tip.hidden = true; else showTip(cellText(mark, cell), event);
    } else {
      showTip(textOf(mark), event);
    }
  });
  addEventListener("scroll", () => { tip.hidden = true; }, {passive: true});

  let last = null;
  function activate(mark) {
    if (last) last.classList.remove("is-chosen");
    last = mark;
    mark.classList.add("is-chosen");
    choose(mark.tagName === "CODE" || mark.classList.contains("p") ? "" : textOf(mark),
           mark.dataset.r === "" ? [] : mark.dataset.r.split(",").map(Number));
  }
  addEventListener("click", (event) => {
    const mark = event.target.closest("[data-r]");
    if (!mark) return;
    tip.hidden = true;
    if (!mark.classList.contains("heat")) {
      activate(mark);
      return;
    }
    const cell = cellAt(mark, event);
    if (cell !== null) chooseCell(mark, cell);
  });
  addEventListener("keydown", (event) => {
    if (event.key === "Escape") panel.hidden = true;
    const mark = event.target.closest && event.target.closest("[data-r]");
    if (!mark) return;
    const isEnter = event.key === "Enter" || event.key === " ";
    if (!mark.classList.contains("heat")) {
      if (!isEnter) return;
      activate(mark);
    } else {
      const grid = gridOf(mark);
      let column = grid.at % grid.columns, row = Math.floor(grid.at / grid.columns);
      if (event.key === "ArrowLeft") column = Math.max(0, column - 1);
      else if (event.key === "ArrowRight") column = Math.min(grid.columns - 1, column + 1);
      else if (event.key === "ArrowUp") row = Math.min(grid.rows - 1, row + 1);
      else if (event.key === "ArrowDown") row = Math.max(0, row - 1);
      else if (!isEnter) return;
      chooseCell(mark, row * grid.columns + column);
    }
    event.preventDefault();
  });
  // Makes marks reachable by keyboard.
  document.querySelectorAll("td [data-r], .m, .p").forEach((mark) => {
    mark.tabIndex = 0;
    mark.setAttribute("role", "button");
    if (mark.classList.contains("p")) mark.setAttribute("aria-label", "run " + inWords(data.runs[Number(mark.dataset.r)]));
  });
})();
