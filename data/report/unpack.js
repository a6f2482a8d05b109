// Scripts and data of this page are in it compressed: they are unpacked, and the scripts run in their
// order.
"use strict";
(async () => {
  try {
    const bytes = Uint8Array.from(atob(document.getElementById("packed").textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const page = JSON.parse(await new Response(stream).text());
    // The data of each drawing, by its id.
    window.pageData = {};
    const find = (part) => {
      if (part === null || typeof part !== "object") return;
      if (part.data) pageData[part.id] = part.data;
      Object.values(part).forEach(find);
    };
    find(page.result);
    for (const text of page.scripts) {
      const script = document.createElement("script");
      script.textContent = text;
      document.body.append(script);
    }
  } catch (error) {
    document.querySelectorAll(".replay").forEach((box) => box.classList.add("still"));
    document.querySelectorAll(".replay, .plot").forEach((box) => box.append("This browser is too old for this picture: " + error.message));
  }
})();
