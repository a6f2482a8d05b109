// A study's report: selection of the metric, and commands of the runs.
"use strict";
(() => {
  const data = pageData["study-runs"];
  const panel = element("aside", document.body);
  panel.id = "chosen";
  panel.hidden = true;
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
    document.body.classList.add("chosen-by-script");
    show(sections[0].id);
    if (location.hash) follow();
  }

  // Marks are reachable by keyboard.
  document.querySelectorAll("[data-r]").forEach((mark) => {
    mark.tabIndex = 0;
    mark.setAttribute("role", "button");
  });

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

  function chooseRun(event) {
    const mark = event.target.closest?.("[data-r]");
    if (!mark) return;
    choose([{runs: [Number(mark.dataset.r)]}]);
    event.preventDefault();
  }
  addEventListener("click", chooseRun);
  addEventListener("keydown", (event) => {
    if (event.key === "Escape") panel.hidden = true;
    if (event.key === "Enter" || event.key === " ") chooseRun(event);
  });
})();
