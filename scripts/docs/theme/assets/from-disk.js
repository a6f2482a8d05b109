// Read from a disk (file://) a browser gives a page neither workers nor JSON. Search then gets its
// index as a script, and its worker as a frame; from a server nothing of this is used.
if (location.protocol === "file:") {
  const base = new URL("..", document.currentScript.src);
  window.__search = {
    index: new Promise((resolve) => {
      window.breakwaterSearchIndex = resolve;
      const script = document.createElement("script");
      script.src = new URL("search/search_index.js", base);
      document.head.append(script);
    }),
  };
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      frame.title = "search";
      document.body.append(frame);
      this.scope = frame.contentWindow;
      this.scope.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      this.ready = new Promise((resolve) => {
        const script = this.scope.document.createElement("script");
        script.src = url;
        script.onload = resolve;
        this.scope.document.body.append(script);
      });
    }
    postMessage(data) {
      this.ready.then(() => this.scope.dispatchEvent(new MessageEvent("message", { data })));
    }
  };
}
