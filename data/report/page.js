// Draws the first charts at once and the others when the page scrolls to them. Keeps time axes
// and replays together.
"use strict";
(() => {
  const FIRST_CHARTS = 8;  // charts drawn before the first scroll
  const groups = new Map();  // name → charts and players that show the same moment
  const axes = new Map();    // name → charts with the same time window

  function groupOf(name) {
    if (!groups.has(name)) groups.set(name, {charts: [], time: null, players: []});
    return groups.get(name);
  }

  function axisOf(name) {
    if (!axes.has(name)) axes.set(name, {charts: [], window: null, busy: false});
    return axes.get(name);
  }

  // Numbers from their differences in whole units. A null is a gap.
  function numbers(differences, first, unit) {
    let sum = 0;
    return Float64Array.from(differences, (by) => by === null ? NaN : first + unit * (sum += by));
  }

  // The linearly interpolated value of a series at a time.
  function sampler(t, v) {
    let i = 0;
    return (time) => {
      if (t.length === 0 || time < t[0] || time > t[t.length - 1]) return null;
      while (i + 1 < t.length && t[i + 1] <= time) ++i;
      if (t[i] === time || i + 1 === t.length) return Number.isFinite(v[i]) ? v[i] : null;
      const value = v[i] + (v[i + 1] - v[i]) * (time - t[i]) / (t[i + 1] - t[i]);
      return Number.isFinite(value) ? value : null;
    };
  }

  // The values where a series has marks and no line.
  function marked(t, v) {
    const values = new Map(Array.from(t, (time, i) => [time, v[i]]));
    return (time) => values.get(time) ?? null;
  }

  function rowsOf(series, x) {
    const times = new Set();
    const all = series.map((s) => ({t: numbers(s.t, x.from, x.step), v: numbers(s.v, s.from, s.step)}));
    for (const s of all) for (const t of s.t) times.add(t);
    const samplers = all.map((s, i) => (series[i].line === false ? marked : sampler)(s.t, s.v));
    return Array.from(times).sort((a, b) => a - b).map((t) => [t, ...samplers.map((f) => f(t))]);
  }

  const shown = (value) => {
    if (value === null || value === undefined) return "";
    const size = Math.abs(value);
    return size !== 0 && (size < 1e-3 || size >= 1e5) ? value.toExponential(2)
                                                      : String(Number(value.toPrecision(4)));
  };

  const dark = matchMedia("(prefers-color-scheme: dark)");

  const cssValue = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const coloursOf = (series) => series.map((s) => cssValue("--c" + s.colour));

  function dashOf(series) {
    const lengths = cssValue("--d" + series.dash);
    return lengths === "none" ? null : lengths.split(" ").map(Number);
  }

  const lineColours = () => ({gridLineColor: cssValue("--line"), axisLineColor: cssValue("--soft")});

  // At round values, four of them or more.
  function fourTicks(low, high) {
    const raw = (high - low) / 4, power = 10 ** Math.floor(Math.log10(raw));
    // The library leaves out what is at the upper end.
    const countOf = (step) => Math.ceil(high / step - 1e-9) - Math.ceil(low / step - 1e-9);
    const step = [10, 5, 2, 1, 0.5, 0.2].map((f) => f * power).find((one) => countOf(one) >= 4);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const first = Math.ceil(low / step - 1e-9);
    return Array.from({length: countOf(step)}, (_, i) => {
      const v = Math.min(Math.max((first + i) * step, low), high), size = Math.max(Math.abs(low), Math.abs(high));
      return {v, label: size >= 1e5 || size < 1e-3 ? v === 0 ? "0" : v.toExponential(1) : v.toFixed(digits)};
    });
  }

  // Ticks of decimal logarithms: as many a decade as there is room for.
  const logTicks = (spacing) => (low, high, pixels) => {
    const ticks = [], room = pixels / spacing, stride = Math.max(1, Math.ceil((high - low) / room));
    const factors = [[1, 2, 5], [1, 3]].find((some) => some.length * (high - low) <= room + 1) || [1];
    for (let n = Math.floor(low / stride) * stride; n <= high; n += stride) {
      for (const f of factors) {
        const v = n + Math.log10(f);
        if (v >= low - 1e-9 && v <= high + 1e-9) ticks.push({v, label: shown(f * 10 ** n)});
      }
    }
    return ticks.length > 1 ? ticks : fourTicks(low, high).map((tick) => ({v: tick.v, label: shown(10 ** tick.v)}));
  };

  const MARKS = {
    dot: (context, x, y) => context.arc(x, y, 3, 0, 7),
    cross: (context, x, y) => { context.moveTo(x - 3, y - 3); context.lineTo(x + 3, y + 3); context.moveTo(x - 3, y + 3); context.lineTo(x + 3, y - 3); },
  };
  // At the series' own places: between them its line has values too.
  function drawMark(kind, own, rows) {
    return (graph, name, context, x, y, colour, size, row) => {
      if (!own.has(rows[row][0])) return;
      context.beginPath();
      context.setLineDash([]);
      context.strokeStyle = context.fillStyle = colour;
      MARKS[kind](context, x, y);
      if (kind === "dot") context.fill(); else context.stroke();
    };
  }

  // The range of values and a margin.
  function padded(all) {
    const low = all.reduce((a, b) => Math.min(a, b)), high = all.reduce((a, b) => Math.max(a, b));
    const margin = 0.04 * (high - low) || 0.05 * Math.abs(high) || 0.5;
    return [low - margin, high + margin];
  }

  function element(kind, className, parent) {
    const made = document.createElement(kind);
    made.className = className;
    if (parent) parent.appendChild(made);
    return made;
  }

  // The state of one drawn chart.
  class Chart {
    constructor(box) {
      this.box = box;
      box.chart = this;
      this.plot = box.querySelector(".plot");
      this.group = groupOf(box.dataset.group);
      this.axis = axisOf(box.dataset.axis);
      const data = pageData[box.dataset.chart];
      if (this.axis.charts.length === 0 && data.window) this.axis.window = data.window;
      this.data = data;
      this.x = data.x || {from: 0, step: 1e-6};
      this.series = data.series;
      this.colours = coloursOf(data.series);
      this.rows = rowsOf(data.series, this.x);
      this.makeKeys(box.querySelector(".keys"));
      this.graph = new Dygraph(this.plot, this.rows, {
        labels: ["time", ...data.series.map((s, i) => i + " " + s.label)],
        colors: this.colours,
        visibility: data.series.map((s) => !s.off),
        series: Object.fromEntries(data.series.map((s, i) => [i + " " + s.label, {strokePattern: dashOf(s), ...this.marksOf(s)}])),
        legend: "never",
        connectSeparatedPoints: false,
        strokeWidth: 1.4,
        highlightCircleSize: 3,
        ...lineColours(),
        axisLabelFontSize: 11,
        labelsKMB: false,
        digitsAfterDecimal: 4,
        maxNumberWidth: 7,
        includeZero: false,
        dateWindow: this.axis.window || this.wholeWindow(),
        valueRange: this.wholeRange(),
        xRangePad: data.x ? 12 : 0,
        axes: {y: {axisLabelWidth: 54, ticker: data.log ? logTicks(25) : fourTicks},
               x: {drawGrid: true, ...(data.x ? {ticker: this.x.labels ? () => this.x.labels.map(([v, label]) => ({v, label}))
                                                           : data.x.log ? logTicks(50) : fourTicks} : {})}},
        underlayCallback: (context, area, graph) => this.underlay(context, area, graph),
        highlightCallback: (event, time) => this.isPlayed ? this.showValues(time) : setTime(this.group, time),
        unhighlightCallback: () => this.isPlayed ? this.showValues(this.group.time) : setTime(this.group, null),
        drawCallback: (graph, isFirst) => { if (!isFirst) this.drawn(); },
        clickCallback: (event, time) => setTime(this.group, time, this),
      });
      this.cursor = element("div", "cursor", this.plot);
      this.cursor.hidden = true;
      this.plot.addEventListener("keydown", (event) => this.key(event));
      this.group.charts.push(this);
      this.axis.charts.push(this);
      this.placeCursor();
      if (this.isPlayed) this.showValues(this.group.time);
      box.dataset.drawn = "yes";
    }

    // The points of a band's edge, "low" or "high".
    edge(series, name) {
      const x = this.xOf(series), y = numbers(series[name] || [], series.from, series.step);
      return Array.from(y, (value, i) => [x[i], value]).filter(([, value]) => Number.isFinite(value));
    }

    // Over another quantity than time all values are in sight, those of lines and bands too.
    wholeRange() {
      if (!this.data.x) return null;
      const all = this.data.lines.concat(...this.rows.map((row) => row.slice(1)),
        ...this.series.flatMap((s) => [...this.edge(s, "low"), ...this.edge(s, "high")].map(([, y]) => y)))
        .filter((value) => value !== null && Number.isFinite(value));
      return all.length === 0 ? null : padded(all);
    }

    // One value of another quantity has no range of its own.
    wholeWindow() {
      return this.data.x && this.rows.length === 1 ? padded([this.rows[0][0]]) : null;
    }

    get isPlayed() { return this.group.players.length > 0; }

    // Draws with the current colours and width.
    redraw() {
      this.colours = coloursOf(this.series);
      this.graph.updateOptions({colors: this.colours, ...lineColours()}, true);
      this.graph.resize();
      this.placeCursor();
    }

    makeKeys(keys) {
      this.clock = element("output", "time", keys);
      this.values = this.series.map((series, i) => {
        const key = element("button", "key", keys);
        key.type = "button";
        key.title = series.about;
        key.setAttribute("aria-pressed", String(!series.off));
        key.className += ` c${series.colour} d${series.dash}` + (series.line === false ? " mark" : "");
        element("i", "", key);
        element("span", "", key).textContent = series.label;
        key.addEventListener("click", () => {
          const on = key.getAttribute("aria-pressed") !== "true";
          key.setAttribute("aria-pressed", String(on));
          this.graph.setVisibility(i, on);
        });
        return element("span", "value", key);
      });
    }

    underlay(context, area, graph) {
      context.save();
      this.series.forEach((series, i) => {
        const around = series.low && graph.visibility()[i] ? this.edge(series, "low").concat(this.edge(series, "high").reverse()) : [];
        context.globalAlpha = 0.16;
        context.fillStyle = context.strokeStyle = this.colours[i];
        context.beginPath();
        around.forEach(([x, y], k) => context[k ? "lineTo" : "moveTo"](graph.toDomXCoord(x), graph.toDomYCoord(y)));
        context.fill();
        context.stroke();  // one value has a band without width
        context.globalAlpha = 1;
      });
      context.strokeStyle = cssValue("--soft");
      context.setLineDash([5, 4]);
      for (const value of this.data.lines) {
        const y = graph.toDomYCoord(value);
        if (y < area.y || y > area.y + area.h) continue;
        context.beginPath();
        context.moveTo(area.x, y);
        context.lineTo(area.x + area.w, y);
        context.stroke();
      }
      context.restore();
    }

    // A zoom of one chart zooms all charts of its axis.
    drawn() {
      this.placeCursor();
      if (this.axis.busy) return;
      const range = this.graph.isZoomed("x") ? this.graph.xAxisRange() : null;
      const known = this.axis.window;
      const isSame = range === null || known === null ? range === known
                                                      : range[0] === known[0] && range[1] === known[1];
      if (!isSame) zoom(this.axis, range, this);
    }

    setWindow(range) { this.graph.updateOptions({dateWindow: range}); }

    textOfX(x) {
      const named = (this.x.labels || []).find(([at]) => Math.abs(at - x) <= this.x.step);
      return named ? named[1] : shown(this.x.log ? 10 ** x : x);
    }

    // The value of a series, and what its mark says.
    textAt(time, i) {
      const series = this.series[i], value = time === null ? null : this.at(time, i + 1);
      const place = value === null || !series.names?.length ? -1 : this.placeOf(series, time);
      return shown(value !== null && this.data.log ? 10 ** value : value) + (place >= 0 ? " " + series.names[place] : "");
    }

    showValues(time) {
      this.clock.textContent = time === null ? ""
        : this.x.title ? this.x.title + ": " + this.textOfX(time) : "t = " + Number(time.toPrecision(6)) + " s";
      this.series.forEach((series, i) => { this.values[i].textContent = this.textAt(time, i); });
    }

    xOf(series) { return numbers(series.t, this.x.from, this.x.step); }

    placeOf(series, x) { return this.xOf(series).indexOf(x); }

    marksOf(series) {
      if (!series.marks) return {};
      const draw = drawMark(series.marks, new Set(this.xOf(series)), this.rows);
      return {drawPoints: true, drawPointCallback: draw, drawHighlightPointCallback: draw,
              ...(series.line === false ? {strokeWidth: 0} : {})};
    }

    at(time, column) {
      const rows = this.rows;
      let low = 0, high = rows.length - 1;
      if (high < 0 || time < rows[0][0] || time > rows[high][0]) return null;
      if (time === rows[high][0]) return rows[high][column];
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (rows[middle][0] <= time) low = middle; else high = middle;
      }
      const [a, b] = [rows[low], rows[high]];
      if (a[column] === null || b[column] === null || a[0] === b[0]) return a[column];
      return a[column] + (b[column] - a[column]) * (time - a[0]) / (b[0] - a[0]);
    }

    placeCursor() {
      const time = this.group.time;
      const range = this.graph.xAxisRange();
      const inside = time !== null && time >= range[0] && time <= range[1];
      this.cursor.hidden = !inside;
      if (inside) this.cursor.style.left = this.graph.toDomXCoord(time) + "px";
    }

    key(event) {
      const [from, to] = this.graph.xAxisRange();
      const step = (to - from) / (event.shiftKey ? 10 : 100);
      const time = this.group.time === null ? (from + to) / 2 : this.group.time;
      // The next value of another quantity.
      const nextOf = (by) => this.data.x ? (by > 0 ? this.rows.find(([x]) => x > time) : this.rows.findLast(([x]) => x < time))?.[0] ?? time
                                         : time + by * step;
      const zoomTo = (factor) => zoom(this.axis, [time - (time - from) * factor, time + (to - time) * factor], null);
      switch (event.key) {
        case "ArrowLeft": setTime(this.group, nextOf(-1), this); break;
        case "ArrowRight": setTime(this.group, nextOf(1), this); break;
        case "+": zoomTo(0.6); break;
        case "-": zoomTo(1.6); break;
        case "0": case "Escape": zoom(this.axis, null, null); break;
        default: return;
      }
      event.preventDefault();
    }
  }

  function zoom(axis, range, from) {
    axis.window = range;
    axis.busy = true;
    for (const chart of axis.charts) if (chart !== from) chart.setWindow(range);
    axis.busy = false;
    for (const chart of axis.charts) chart.placeCursor();
  }

  // `from` is the chart or the player that moved. Without it the players stay where they are.
  function setTime(group, time, from) {
    group.time = time;
    for (const chart of group.charts) {
      chart.placeCursor();
      chart.showValues(time);
    }
    if (!from || time === null) return;
    for (const player of group.players) if (player !== from) player.seek(time);
  }

  // For replays: a player has seek(time). It reports its own time with told().
  window.pagePlayers = {
    add: (name, player) => {
      const group = groupOf(name);
      group.players.push(player);
      group.time = player.begin;
      player.told = (time) => setTime(group, time, player);
      return player;
    },
  };

  const charts = Array.from(document.querySelectorAll(".chart"));
  const draw = (box) => { if (!box.dataset.drawn) new Chart(box); };
  // Draws the other charts when the page scrolls to them, or they are unfolded.
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) draw(entry.target);
  }, {rootMargin: "800px"});

  const redrawAll = () => charts.forEach((box) => { if (box.chart) box.chart.redraw(); });
  // Chromium prints a canvas as it was before, so redrawing is too late. The charts are made
  // smaller.
  window.addEventListener("beforeprint", () => {
    charts.forEach(draw);
    document.body.classList.add("paper");
    for (const {chart} of charts) {
      if (!chart) continue;
      const plot = chart.plot;
      plot.style.zoom = Math.min(1, plot.clientWidth / plot.firstElementChild.offsetWidth);
    }
  });
  window.addEventListener("afterprint", () => {
    document.body.classList.remove("paper");
    for (const {chart} of charts) if (chart) chart.plot.style.zoom = "";
    redrawAll();
  });
  dark.addEventListener("change", redrawAll);
  // The scripts behind this one add the players.
  setTimeout(() => {
    charts.filter((box) => box.offsetParent).slice(0, FIRST_CHARTS).forEach(draw);
    charts.forEach((box) => seen.observe(box));
    document.querySelectorAll("button.range").forEach((button) => button.addEventListener("click", () => {
      const axis = axisOf(button.dataset.axis);
      const whole = axis.window !== null;
      zoom(axis, whole ? null : [Number(button.dataset.from), Number(button.dataset.to)], null);
      button.textContent = whole ? button.dataset.close : button.dataset.far;
    }));
  }, 0);
})();
