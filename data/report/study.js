// A study's report: selection of the metric, tips of the marks, and commands of the runs.
"use strict";
// The drawings of a study, as SVG, from the page's data (docs/explanation/decisions/0023).
const drawStudy = (() => {
  const WIDTH = 360, LEVELS = 24, LETTER = 6.2;
  const log = Math.log;
  const shown = shownNumber;

  // p(x) = a + (b - a) (s(x) - s(low))/(s(high) - s(low)), s(x) = x or ln x. A range of zero width is
  // widened around its value.
  function scaleOf(low, high, isLog, a, b) {
    isLog = isLog && low > 0;
    if (!(high - low > 1e-12 * Math.max(Math.abs(low), Math.abs(high)))) {
      const half = low === 0 ? 0.5 : 0.05 * Math.abs(low);
      [low, high] = isLog ? [low / 2, high * 2] : [low - half, high + half];
    }
    const share = (x) => isLog ? log(x / low) / log(high / low) : (x - low) / (high - low);
    const at = (x) => a + (b - a) * share(x);
    at.share = (x) => Math.min(1, Math.max(0, share(x)));
    // About `count` round values within the range.
    at.ticks = (count) => {
      const inside = (v) => v >= low - 1e-9 * (isLog ? low : high - low) && v <= high + 1e-9 * (isLog ? high : high - low);
      if (isLog) {
        const first = Math.log10(low), last = Math.log10(high), isFine = last - first < 2;
        const stride = Math.max(1, Math.ceil((last - first) / count)), values = [];
        for (let n = Math.floor(first / stride) * stride; n <= Math.ceil(last); n += isFine ? 1 : stride) {
          values.push(...(isFine ? [1, 2, 5] : [1]).map((f) => f * 10 ** n).filter(inside));
        }
        if (values.length >= 2) return values;
      }
      const rough = (high - low) / count, decade = 10 ** Math.floor(Math.log10(rough));
      const step = [1, 2, 5, 10].map((f) => f * decade).find((one) => one >= rough * (1 - 1e-9)) || 10 * decade;
      const first = Math.ceil(low / step - 1e-9), values = [];
      for (let i = first; i * step <= high + 1e-9 * step; ++i) values.push(i * step);
      return values;
    };
    return at;
  }
  // A range of positive values that is wider than two and a half decades.
  const isForLog = (low, high) => low > 0 && high > 300 * low;
  const label = (value) => String(Number(value.toPrecision(6)));
  const isNumber = (value) => value !== null && value !== undefined;

  function rangeOf(values) {
    const known = values.filter(isNumber);
    return known.length ? [known.reduce((a, b) => Math.min(a, b)), known.reduce((a, b) => Math.max(a, b))] : null;
  }
  const shortened = (text, most) => text.length <= most ? text : text.slice(0, most - 1) + "…";
  const px = (value) => String(Math.round(10 * value) / 10);

  function svgElement(kind, parent, attributes, text) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", kind);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    if (text !== undefined) made.textContent = text;
    parent.append(made);
    return made;
  }
  const cross = (x, y, half) => `M${px(x - half)} ${px(y - half)}l${px(2 * half)} ${px(2 * half)}m0 ${px(-2 * half)}l${px(-2 * half)} ${px(2 * half)}`;

  // A line through the points, with gaps where there is no number.
  function linePath(points) {
    let path = "", isOn = false;
    for (const [x, y] of points) {
      if (isNumber(y)) path += `${isOn ? "L" : "M"}${px(x)} ${px(y)}`;
      isOn = isNumber(y);
    }
    return path;
  }

  class Plot {
    constructor(place, kind, width, height, about) {
      this.width = width;
      this.svg = svgElement("svg", place, {class: kind, viewBox: `0 0 ${px(width)} ${px(height)}`,
        ...(about ? {role: "img", "aria-label": about} : {"aria-hidden": "true"})});
    }
    path(name, d, parent = this.svg, more = {}) { if (d) svgElement("path", parent, {class: name, d, ...more}); }
    text(x, y, anchor, text, name) {
      svgElement("text", this.svg, {x: px(x), y: px(y), "text-anchor": anchor, ...(name ? {class: name} : {})}, text);
    }
    yGrid(area, y) {
      const few = y.ticks(5);
      for (const value of few.length < 4 ? y.ticks(10) : few) {
        this.path("grid", `M${px(area.left)} ${px(y(value))}H${px(area.right)}`);
        this.text(area.left - 5, y(value) + 3.5, "end", label(value));
      }
    }
    // Texts side by side. Texts without enough room are left out.
    below(y, places, texts, most) {
      let free = 0;
      places.forEach((place, i) => {
        const words = shortened(texts[i], most), half = 0.5 * LETTER * words.length;
        const x = Math.min(Math.max(place, half), Math.max(half, this.width - half));
        if (x - half < free) return;
        this.text(x, y, "middle", words);
        free = x + half + 4;
      });
    }
    xTicks(area, places, texts) {
      for (const place of places) this.path("tick", `M${px(place)} ${px(area.bottom)}v4`);
      this.below(area.bottom + 15, places, texts, 14);
    }
  }
  const ticksOf = (scale, count) => [scale.ticks(count).map(scale), scale.ticks(count).map(label)];

  // Lines through medians, with bands. Crosses at the bottom mark failed runs.
  function lines(place, data) {
    const all = data.lines.flat(), range = rangeOf(all.flatMap((m) => [m.y, m.low, m.high]));
    const isEmpty = !range && !data.share, [low, high] = data.share || isEmpty ? [0, 1] : range;
    const area = {left: 50, right: WIDTH - 10, top: 12, bottom: 210};
    const bottom = area.bottom - (all.some((m) => m.failed) ? 8 * data.lines.length + 4 : 0);
    const y = scaleOf(low, high, isForLog(low, high), bottom - 6, area.top + 6);
    const x = scaleOf(...rangeOf(data.at), data.log, area.left + 10, area.right - 10);
    const plot = new Plot(place, "lines", WIDTH, 250, data.y_title + " over " + data.x_title);
    if (!isEmpty) plot.yGrid(area, y);
    plot.path("axis", `M${area.left} ${area.top}V${area.bottom}H${area.right}`);
    plot.xTicks(area, ...(data.labels.length ? [data.at.map(x), data.labels] : ticksOf(x, 5)));
    plot.text((area.left + area.right) / 2, 245, "middle", shortened(data.x_title, 50), "title");
    const points = (marks, value) => marks.map((m, i) => [x(data.at[i]), isNumber(m[value]) ? y(m[value]) : null]);
    data.lines.forEach((marks, c) => {
      if (data.share) return;
      const known = marks.map((m, i) => ({...m, at: data.at[i]})).filter((m) => isNumber(m.low) && isNumber(m.high));
      if (known.length < 2) return;
      const edge = (value) => known.map((m) => `${px(x(m.at))} ${px(y(m[value]))}`);
      plot.path("band " + data.looks[c], "M" + edge("high").concat(edge("low").reverse()).join("L") + "Z");
    });
    data.lines.forEach((marks, c) => {
      plot.path("line " + data.looks[c], linePath(points(marks, "y")));
      const group = svgElement("g", plot.svg, {class: data.looks[c]});
      marks.forEach((m, i) => {
        if (!isNumber(m.y) && !m.failed) return;
        const mark = svgElement("g", group, {class: "m", "data-r": m.runs.join(","), "data-text": m.text}), at = x(data.at[i]);
        if (isNumber(m.y)) {
          if (marks.length === 1) plot.path("line", linePath([[at, y(m.low)], [at, y(m.high)]]), mark);  // the band has no width
          svgElement("circle", mark, {cx: px(at), cy: px(y(m.y)), r: 3});
        }
        if (m.failed) plot.path("x", cross(at, bottom + 8 * (c + 0.5) + 2, 3), mark);
      });
    });
    if (isEmpty) plot.text((50 + WIDTH) / 2, 125, "middle", "no run has it");
  }

  // Cells coloured by value. A dash below: some runs lack the value but did not fail. A cross: all runs
  // failed. A corner: some runs failed. If there are few cells, they show numbers.
  function heat(place, data) {
    const columns = data.x.length, rows = data.y.length, top = 12;
    const longest = Math.min(20, Math.max(...data.y.map((text) => text.length)));
    const left = Math.max(66, 8 + LETTER * longest), width = (WIDTH - left - 10) / columns;
    const height = Math.min(34, Math.max(6, 220 / rows)), bottom = top + height * rows;
    const colour = scaleOf(data.low, data.high, isForLog(data.low, data.high), 0, 1);
    const plot = new Plot(place, "heat", WIDTH, bottom + 40, data.about);
    plot.svg.setAttribute("tabindex", "0");
    plot.svg.dataset.r = "";
    plot.svg.grid = {left, bottom, width, height, columns, rows, at: 0, ...data};
    const hasNumbers = columns <= 8 && rows <= 14 && width > 30 && height > 13;
    const levels = Array(LEVELS).fill(""), texts = [];
    let dead = "", some = "", absent = "";
    data.cells.forEach(([value, runs, failed, measured], i) => {
      const x = left + width * (i % columns), y = bottom - height * (Math.floor(i / columns) + 1);
      const half = 0.3 * Math.min(width, height), middle = x + 0.5 * width;
      if (isNumber(value)) {
        const level = Math.min(LEVELS - 1, Math.floor(colour.share(value) * LEVELS));
        levels[level] += `M${px(x)} ${px(y)}h${px(width)}v${px(height)}h${px(-width)}z`;
        if (measured + failed < runs) absent += `M${px(x + 0.35 * width)} ${px(y + height - 2.5)}h${px(0.3 * width)}`;
        if (hasNumbers) texts.push([middle, y + 0.5 * height + 3.5, "middle", shown(value), level < 0.6 * LEVELS ? "on dark" : "on"]);
      } else if (failed < runs) {
        absent += `M${px(x + 0.35 * width)} ${px(y + 0.5 * height)}h${px(0.3 * width)}`;
      }
      if (runs > 0 && failed === runs) dead += cross(middle, y + 0.5 * height, half);
      else if (failed > 0) some += `M${px(x + width - half - 1)} ${px(y + 1)}h${px(half)}v${px(half)}z`;
    });
    levels.forEach((path, level) => plot.path("h" + level, path));
    plot.path("frame", `M${px(left)} ${top}H${WIDTH - 10}V${px(bottom)}H${px(left)}z`);
    texts.forEach((one) => plot.text(...one));
    for (const [name, path] of Object.entries({absent, dead, some})) plot.path(name, path);
    plot.below(bottom + 14, data.x.map((_, i) => left + width * (i + 0.5)), data.x, Math.max(14, Math.floor(width / LETTER)));
    let free = bottom + 20;
    data.y.forEach((text, row) => {
      const y = bottom - height * (row + 0.5) + 3.5;
      if (y > free) return;
      plot.text(left - 5, y, "end", shortened(text, 20));
      free = y - 13;
    });
    plot.text((left + WIDTH - 10) / 2, bottom + 35, "middle", shortened(data.x_title, 50), "title");
    plot.text(2, top - 3, "start", shortened(data.y_title, 52), "title");
    svgElement("path", plot.svg, {class: "at", d: ""});
  }

  // The colours of heat maps and lines with their values.
  function bar(place, {low, high}) {
    const scale = scaleOf(low, high, isForLog(low, high), 12, WIDTH - 24), step = (WIDTH - 36) / LEVELS;
    const plot = new Plot(place, "bar", WIDTH, 36, `colours from ${shown(low)} to ${shown(high)}`);
    for (let level = 0; level < LEVELS; ++level) {
      plot.path("h" + level, `M${px(12 + step * level)} 2h${px(step + 0.3)}v14h${px(-step - 0.3)}z`);
    }
    plot.xTicks({left: 12, right: WIDTH - 24, top: 2, bottom: 16}, ...ticksOf(scale, 5));
  }

  // 10 to 90 % as a line, the quartiles as a box, and the median, on an axis common to all rows.
  function box(place, {look, low, high, values}) {
    const x = scaleOf(low, high, isForLog(low, high), 3, 147), plot = new Plot(place, "box " + look, 150, 18);
    const [q10, q25, median, q75, q90] = values.map((value) => px(x(value)));
    plot.path("line", `M${q10} 9H${q90}`);
    plot.path("half", `M${q25} 4H${q75}V14H${q25}z`);
    plot.path("middle", `M${median} 2V16`);
  }

  // A first-order and a total index with their intervals, on an axis from 0 to 1.
  function indices(place, {look, values}) {
    const plot = new Plot(place, "box " + look, 150, 22), x = (index) => px(4 + 142 * Math.min(1.02, Math.max(-0.02, index)));
    plot.path("axis", "M4 0V22M146 0V22");
    values.forEach(([value, low, high], i) => {
      const y = 6 + 10 * i;
      plot.path(i ? "half" : "full", `M${x(0)} ${y - 3}H${x(value)}v6H${x(0)}z`);
      if (isNumber(low)) plot.path("whisker", `M${x(low)} ${y}H${x(high)}`);
    });
  }

  const kinds = {lines, heat, bar, box, indices};
  // Draws what is in a part of the page and not yet drawn.
  return (part) => part.querySelectorAll("[data-drawing]:empty").forEach((place) => {
    const data = pageData[place.dataset.drawing];
    kinds[data.kind](place, data);
  });
})();

(() => {
  const data = pageData["study-runs"];
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
    drawStudy(section);
    section.querySelectorAll("td[data-r], td [data-r], .m").forEach((mark) => {
      mark.tabIndex = 0;
      mark.setAttribute("role", "button");
      if (mark.classList.contains("p")) mark.setAttribute("aria-label", "run " + inWords(data.runs[Number(mark.dataset.r)]));
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
  function cellAt(svg, event) {
    const grid = svg.grid, box = svg.getBoundingClientRect();
    const scale = svg.viewBox.baseVal.width / box.width;
    const column = Math.floor(((event.clientX - box.left) * scale - grid.left) / grid.width);
    const row = Math.floor((grid.bottom - (event.clientY - box.top) * scale) / grid.height);
    if (column < 0 || column >= grid.columns || row < 0 || row >= grid.rows) return null;
    return row * grid.columns + column;
  }
  function cellText(svg, cell) {
    const grid = svg.grid, [value, runs, failed] = grid.cells[cell];
    return `${grid.x_title} = ${grid.x[cell % grid.columns]}, ${grid.y_title} = ${grid.y[Math.floor(cell / grid.columns)]}: ` +
           `${value === null ? "no value" : Number(value.toPrecision(3))}, ${runs} runs` + (failed ? `, ${failed} failed` : "");
  }
  function frameCell(svg, cell) {
    const grid = svg.grid;
    grid.at = cell;
    const x = grid.left + grid.width * (cell % grid.columns);
    const y = grid.bottom - grid.height * (Math.floor(cell / grid.columns) + 1);
    svg.querySelector(".at").setAttribute("d", `M${x} ${y}h${grid.width}v${grid.height}h${-grid.width}z`);
  }
  function chooseCell(svg, cell) {
    frameCell(svg, cell);
    const run = svg.grid.cells[cell][4];
    choose(cellText(svg, cell), run === null ? [] : [run]);
  }

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
    choose(mark.classList.contains("code") || mark.classList.contains("p") ? "" : textOf(mark),
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
      const grid = mark.grid;
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
  document.querySelectorAll(".metric, .metric-free").forEach((section) => { if (!section.hidden) draw(section); });
})();
