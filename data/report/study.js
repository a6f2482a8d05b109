// A study's report: heat maps, selection of the metric, tips of the marks, and commands
// of the runs.
"use strict";
(() => {
  const LEVELS = 24;  // colours of a heat map
  const MOST_NUMBERS = 8;  // columns of a heat map that shows them
  const data = pageData["study-runs"];
  const isNumber = (value) => value !== null && value !== undefined;

  // The place of a value in its range from 0 to 1. More than two and a half decades are logarithmic.
  function placeIn(low, high) {
    const isLog = low > 0 && high > 300 * low, f = isLog ? Math.log : (x) => x;
    const place = (value) => high > low ? Math.min(1, Math.max(0, (f(value) - f(low)) / (f(high) - f(low)))) : 0.5;
    place.back = (share) => isLog ? low * (high / low) ** share : low + share * (high - low);
    return place;
  }
  const levelOf = (share) => Math.min(LEVELS - 1, Math.floor(share * LEVELS));

  // Cells coloured by value. A cross: all runs failed. A corner: some did. A dash: no run has the value;
  // at the lower edge: some lack it, and did not fail.
  function heat(place, map) {
    const table = element("table", place), columns = map.x.length, hasNumbers = columns <= MOST_NUMBERS;
    const share = placeIn(map.low, map.high), every = Math.ceil(columns / MOST_NUMBERS);
    table.className = "heat";
    table.setAttribute("aria-label", map.about);
    element("caption", table, map.y_title + " over " + map.x_title);
    for (let row = map.y.length - 1; row >= 0; --row) {
      const line = element("tr", table);
      element("th", line, map.y[row]);
      map.cells.slice(row * columns, (row + 1) * columns).forEach(([value, runs, failed, measured, run], column) => {
        const cell = element("td", line), isDead = runs > 0 && failed === runs, level = levelOf(share(value));
        cell.dataset.r = isNumber(run) ? run : "";
        cell.dataset.text = `${map.x_title} = ${map.x[column]}, ${map.y_title} = ${map.y[row]}: ` +
          `${isNumber(value) ? shownNumber(value) : "no value"}, ${runs} runs` + (failed ? `, ${failed} failed` : "");
        if (isNumber(value)) cell.className = `h${level}` + (level < 0.6 * LEVELS ? " dark" : "");
        cell.classList.toggle("dead", isDead);
        cell.classList.toggle("some", failed > 0 && !isDead);
        cell.classList.toggle("absent", isNumber(value) && measured + failed < runs);
        if (!isNumber(value) && !isDead) cell.textContent = "–";
        if (isNumber(value) && hasNumbers) cell.textContent = shownNumber(value);
      });
    }
    const line = element("tr", table);
    element("th", line);
    map.x.forEach((text, column) => { if (column % every === 0) element("th", line, text).colSpan = Math.min(every, columns - column); });
  }

  // The colours of heat maps with their values.
  function bar(place, {low, high}) {
    const colours = element("p", place), values = element("p", place), {back} = placeIn(low, high);
    place.className = "bar";
    for (let level = 0; level < LEVELS; ++level) element("i", colours).className = "h" + level;
    for (const share of [0, 0.25, 0.5, 0.75, 1]) element("span", values, shownNumber(back(share)));
  }

  const kinds = {heat, bar};
  const tip = element("div", document.body);
  const panel = element("aside", document.body);
  tip.id = "tip";
  panel.id = "chosen";
  tip.hidden = panel.hidden = true;
  panel.setAttribute("aria-live", "polite");
  panel.setAttribute("aria-label", "Chosen runs");
  const command = document.getElementById("this-machine").dataset.command + " --replay ";
  const sections = Array.from(document.querySelectorAll(".metric"));

  // Shows one metric at a time. Without a script all are visible.
  if (sections.length > 1) {
    const chooser = document.createElement("div"), label = element("label", chooser, "Metric ");
    const select = element("select", label);
    chooser.className = "chooser";
    sections[0].before(chooser);
    for (const section of sections) select.add(new Option(section.querySelector("h2").textContent, section.id));
    const show = (id) => {
      if (!sections.some((section) => section.id === id)) return;
      for (const section of sections) {
        section.hidden = section.id !== id;
        if (!section.hidden) draw(section);
      }
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
    document.body.classList.add("chosen-by-script");
    show(sections[0].id);
    if (location.hash) follow();
  }

  // Draws a section, and makes its marks reachable by keyboard.
  function draw(section) {
    section.querySelectorAll("[data-drawing]:empty").forEach((place) => {
      const drawing = pageData[place.dataset.drawing];
      kinds[drawing.kind](place, drawing);
    });
    section.querySelectorAll("td[data-r], td [data-r]").forEach((mark) => {
      // The arrows reach the other cells of a heat map.
      mark.tabIndex = mark.matches(".heat td") && mark !== mark.closest("table").querySelector("td") ? -1 : 0;
      mark.setAttribute("role", "button");
    });
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

  // Marks with their texts and runs.
  function choose(marks) {
    panel.replaceChildren();
    const close = element("button", panel, "×");
    close.className = "close";
    close.type = "button";
    close.setAttribute("aria-label", "Close");
    close.addEventListener("click", () => { panel.hidden = true; });
    for (const {text, runs} of marks) {
      if (text) element("p", panel, text);
      for (const i of runs) {
        const run = data.runs[i];
        element("p", panel, inWords(run));
        const line = element("p", panel);
        line.className = "copy";
        element("code", line, command + run[0]);
        copyable(line);
      }
    }
    panel.hidden = marks.length === 0;
  }
  window.chooseMarks = choose;

  const textOf = (mark) => mark.dataset.text || inWords(data.runs[Number(mark.dataset.r)]);
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
    if (mark) showTip(textOf(mark), event); else tip.hidden = true;
  });
  addEventListener("scroll", () => { tip.hidden = true; }, {passive: true});

  let last = null;
  function activate(mark) {
    if (last) last.classList.remove("is-chosen");
    last = mark;
    mark.classList.add("is-chosen");
    choose([{text: mark.classList.contains("code") ? "" : textOf(mark),
             runs: mark.dataset.r === "" ? [] : [Number(mark.dataset.r)]}]);
  }
  addEventListener("click", (event) => {
    const mark = event.target.closest("[data-r]");
    if (!mark) return;
    tip.hidden = true;
    activate(mark);
  });
  const STEPS = {ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0]};
  addEventListener("keydown", (event) => {
    if (event.key === "Escape") panel.hidden = true;
    const mark = event.target.closest && event.target.closest("[data-r]"), step = STEPS[event.key];
    if (!mark) return;
    if (event.key === "Enter" || event.key === " ") {
      activate(mark);
    } else if (step && mark.matches(".heat td")) {
      const line = mark.closest("table").rows[mark.parentNode.rowIndex + step[0]];
      const next = line && line.cells[mark.cellIndex + step[1]];
      if (!next || next.dataset.r === undefined) return;
      next.focus();
      activate(next);
    } else {
      return;
    }
    event.preventDefault();
  });
  document.querySelectorAll(".metric, .metric-free").forEach((section) => { if (!section.hidden) draw(section); });
})();
