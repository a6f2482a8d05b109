// A replay on the page: its picture, its camera, its controls, and its time.
"use strict";
(() => {
  const SPEEDS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
  // A narrower picture still shows all that is in the frame at this aspect ratio, as in stills.
  const FRAMED_ASPECT = 4 / 3;
  const LIGHT = {top: [200 / 255, 212 / 255, 224 / 255], bottom: [240 / 255, 243 / 255, 246 / 255]};
  const DARK = {top: [0.10, 0.12, 0.15], bottom: [0.20, 0.23, 0.27]};
  // `pixels`: for each pixel of the page. `water`: every n-th row and column of it is drawn. Without a graphics card, what moves is drawn quickly.
  const BEST = {pixels: 2, shadows: true, water: 1}, QUICK = {pixels: 0.66, shadows: false, water: 2};
  const REST_MS = 350;  // then what stands still is drawn once more, as well as can be

  const prefersDark = matchMedia("(prefers-color-scheme: dark)");

  function element(kind, className, parent, text) {
    const made = document.createElement(kind);
    made.className = className;
    if (text !== undefined) made.textContent = text;
    if (parent) parent.appendChild(made);
    return made;
  }

  const ICONS = {
    play: "M7 4v16l13-8z", pause: "M6 4h4v16H6zM14 4h4v16h-4z", back: "M6 4h3v16H6zM20 4v16l-10-8z",
    on: "M15 4h3v16h-3zM4 4v16l10-8z"};

  // A button's sign, drawn: fonts lack them.
  function icon(button, name) {
    const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    svg.setAttribute("viewBox", "0 0 24 24");
    svg.setAttribute("aria-hidden", "true");
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    path.setAttribute("d", ICONS[name]);
    svg.appendChild(path);
    button.replaceChildren(svg);
  }

  function numberText(value) {
    return value < 0.995 ? value.toFixed(2) : value < 99.95 ? value.toFixed(1) : value.toFixed(0);
  }

  function speedText(speed) {
    return speed === 1 ? "1×" : speed < 1 ? Number((1 / speed).toPrecision(3)) + "× slower"
                                          : Number(speed.toPrecision(3)) + "× faster";
  }

  function canDraw() {
    try {
      const canvas = document.createElement("canvas");
      const gl = canvas.getContext("webgl2") || canvas.getContext("webgl");
      if (!gl) return false;
      const lose = gl.getExtension("WEBGL_lose_context");
      if (lose) lose.loseContext();
      return true;
    } catch (error) {
      return false;
    }
  }

  class View {
    constructor(box) {
      this.box = box;
      box.replay = this;
      this.picture = box.querySelector(".picture");
      this.time = Number(box.dataset.time);
      this.isPlaying = false;
      this.player = null;  // the charts' view of this replay
    }

    get isReady() { return Boolean(this.stage); }

    async start() {
      if (this.starting) return this.starting;
      return this.starting = this.prepare().catch((error) => this.refuse(
        "This replay cannot be shown here: " + (error && error.message ? error.message : String(error))));
    }

    refuse(text) {
      this.box.classList.add("still");
      element("p", "refusal", this.box, text).setAttribute("role", "status");
      this.box.dataset.state = "refused";
    }

    async prepare() {
      if (typeof DecompressionStream === "undefined" || !canDraw()) {
        this.refuse("This browser cannot draw in three dimensions (it has no WebGL): here are pictures of the run instead.");
        return;
      }
      const json = pageData[this.box.dataset.replay];
      this.data = await Replay.load(json);
      this.begin = Math.min(...this.data.runs.map((run) => run.times.begin));
      this.end = Math.max(...this.data.runs.map((run) => run.times.end));
      this.speed = json.window.speed;
      const canvas = this.canvas = element("canvas", "", this.picture);
      canvas.tabIndex = 0;
      canvas.setAttribute("role", "application");
      canvas.setAttribute("aria-label", this.box.dataset.alt);
      const context = canvas.getContext("webgl2", {antialias: false, alpha: false, powerPreference: "high-performance"})
        || canvas.getContext("webgl", {antialias: false, alpha: false});
      this.renderer = new THREE.WebGLRenderer({canvas, context, antialias: false});
      this.renderer.autoClear = false;
      this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
      this.renderer.debug.checkShaderErrors = false;
      const info = context.getExtension("WEBGL_debug_renderer_info");
      const name = info ? String(context.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
      this.isSoftware = /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
      this.stage = new Replay.Stage(this.data, this.isSoftware ? 1 : 8);
      this.camera = new THREE.PerspectiveCamera(45, 1, 0.01, 100);
      this.camera.up.set(0, 0, 1);
      this.labels = element("div", "labels", this.picture);
      this.captions = element("div", "captions", this.picture);
      this.makeControls(json);
      this.makeOrbit();
      this.useCamera(json.camera);
      canvas.addEventListener("webglcontextlost", (event) => { event.preventDefault(); this.pause(); });
      canvas.addEventListener("webglcontextrestored", () => this.invalidate());
      new ResizeObserver(() => this.resize()).observe(this.picture);
      prefersDark.addEventListener("change", () => this.invalidate());
      this.box.classList.add("live");
      this.resize();
      this.seek(this.time);
      this.draw();
      this.box.dataset.state = "ready";
      this.box.dispatchEvent(new Event("ready"));
    }

    // ---- controls

    button(parent, label, sign, act) {
      const made = element("button", "", parent);
      if (sign) icon(made, sign);
      made.type = "button";
      made.title = label;
      made.setAttribute("aria-label", label);
      made.addEventListener("click", act);
      return made;
    }

    select(parent, label, options, act) {
      const made = element("select", "", parent);
      made.setAttribute("aria-label", label);
      made.title = label;
      for (const [value, text] of options) {
        const option = element("option", "", made, text);
        option.value = value;
      }
      made.addEventListener("change", () => act(made.value));
      return made;
    }

    makeControls(json) {
      const bar = element("div", "bar", this.box);
      bar.setAttribute("role", "group");
      bar.setAttribute("aria-label", "Replay");
      this.playButton = this.button(bar, "Play (space)", "play", () => this.toggle());
      this.button(bar, "One frame back (,)", "back", () => this.step(-1));
      this.button(bar, "One frame on (.)", "on", () => this.step(1));
      const track = element("div", "track", bar);
      this.slider = element("input", "slider", track);
      this.slider.type = "range";
      this.slider.setAttribute("aria-label", "Time [s]");
      Object.assign(this.slider, {min: this.begin, max: this.end, step: "any"});
      this.slider.addEventListener("input", () => { this.pause(); this.seek(Number(this.slider.value), true); });
      const part = (time) => 100 * (time - this.begin) / (this.end - this.begin) + "%";
      const window = element("i", "window", track);
      window.style.left = part(json.window.from);
      window.style.right = 100 - 100 * (json.window.to - this.begin) / (this.end - this.begin) + "%";
      for (const moment of json.moments) {
        const mark = this.button(track, moment.caption, null, () => { this.pause(); this.seek(moment.time, true); });
        mark.className = "moment";
        mark.style.left = part(moment.time);
      }
      this.clock = element("output", "clock", bar);
      const speeds = Array.from(new Set([...SPEEDS, json.window.speed])).sort((a, b) => a - b);
      this.speedChoice = this.select(bar, "Speed", speeds.map((v) => [v, speedText(v)]), (v) => this.setSpeed(Number(v)));
      this.speedChoice.value = String(this.speed);
      const {scene} = this.data.runs[0];
      const cameras = [["-1", "whole scene"], ...scene.cameras.map((c, i) => [String(i), c.name || "camera " + (i + 1)]),
                       ["free", "free"]];
      this.cameraChoice = this.select(bar, "Camera", cameras, (v) => v === "free" ? this.freeCamera() : this.useCamera(Number(v)));
      const more = element("details", "more", bar);
      element("summary", "", more, "Show");
      const menu = element("div", "menu", more);
      if (this.data.runs.some((run) => run.arrows.length > 0)) {
        const label = element("label", "", menu);
        this.forces = Object.assign(element("input", "", label), {type: "checkbox", checked: true});
        label.append(" forces (A)");
        this.forces.addEventListener("change", () => { this.stage.showsForces = this.forces.checked; this.seek(this.time); });
      }
      element("p", "keys-help", menu, "Drag to turn, right drag or two fingers to move, wheel or pinch to zoom. Keys: space plays, , and . step, "
              + "← → a second, [ ] slower and faster, 1–9 cameras, 0 back to the camera.");
      this.box.addEventListener("keydown", (event) => this.key(event));
      this.makeCaptions();
    }

    makeCaptions() {
      this.captions.textContent = "";
      this.runLabels = this.data.runs.map((run, i) => {
        const caption = element("div", "caption", this.captions);
        if (this.data.runs.length > 1) element("i", "", caption).style.background = `var(--c${run.colour})`;
        element("b", "", caption, run.label);
        return caption;
      });
    }

    key(event) {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const isTyped = /^(SELECT|INPUT)$/.test(event.target.tagName);
      if (isTyped && event.target !== this.slider && event.key !== "Escape") return;
      if (event.target.tagName === "BUTTON" && (event.key === " " || event.key === "Enter")) return;
      const by = (seconds) => { this.pause(); this.seek(this.time + seconds, true); };
      switch (event.key) {
        case " ": this.toggle(); break;
        case ",": this.step(-1); break;
        case ".": this.step(1); break;
        case "ArrowLeft": by(event.shiftKey ? -10 : -this.speed); break;
        case "ArrowRight": by(event.shiftKey ? 10 : this.speed); break;
        case "Home": by(this.begin - this.time); break;
        case "End": by(this.end - this.time); break;
        case "a": case "A": if (this.forces) this.forces.click(); break;
        case "[": this.changeSpeed(-1); break;
        case "]": this.changeSpeed(1); break;
        case "0": this.useCamera(this.data.camera); break;
        default: {
          const camera = Number(event.key) - 1;
          if (!(camera >= 0 && camera < this.data.runs[0].scene.cameras.length)) return;
          this.useCamera(camera);
        }
      }
      event.preventDefault();
    }

    setSpeed(speed) {
      this.speed = speed;
      this.speedChoice.value = String(speed);
      this.showTime();
    }

    changeSpeed(by) {
      const index = this.speedChoice.selectedIndex + by;
      const option = this.speedChoice.options[Math.min(Math.max(index, 0), this.speedChoice.options.length - 1)];
      this.setSpeed(Number(option.value));
    }

    // ---- time

    toggle() { if (this.isPlaying) this.pause(); else this.play(); }

    play() {
      if (this.time >= this.end - 1e-9) this.seek(this.data.window.from, true);
      this.isPlaying = true;
      icon(this.playButton, "pause");
      this.playButton.title = "Pause (space)";
      this.playButton.setAttribute("aria-label", this.playButton.title);
      this.lastTick = null;
      this.invalidate();
    }

    pause() {
      if (!this.isPlaying) return;
      this.isPlaying = false;
      icon(this.playButton, "play");
      this.playButton.title = "Play (space)";
      this.playButton.setAttribute("aria-label", this.playButton.title);
      this.invalidate();
    }

    step(by) {
      this.pause();
      const {times} = this.data.runs[0];
      const {frame, part} = times.place(this.time);
      const next = by < 0 && part > 1e-6 ? frame : frame + by;
      this.seek(times.timeOf(Math.min(Math.max(next, 0), times.frames - 1)), true);
    }

    // `tells`: the page's charts too.
    seek(time, tells) {
      if (!this.isReady) {
        this.time = time;
        return;
      }
      this.time = Math.min(Math.max(time, this.begin), this.end);
      this.stage.pose(this.time);
      this.showTime();
      if (tells && this.player) this.player.told(this.time);
      this.invalidate();
    }

    showTime() {
      this.slider.value = String(this.time);
      this.slider.setAttribute("aria-valuetext", this.time.toFixed(3) + " s");
      this.clock.textContent = "t = " + this.time.toFixed(3) + " s";
    }

    // ---- cameras

    makeOrbit() {
      const orbit = this.orbit = new THREE.OrbitControls(this.camera, this.canvas);
      orbit.enableKeys = false;
      orbit.screenSpacePanning = true;
      orbit.enableDamping = false;
      orbit.addEventListener("change", () => this.invalidate());
      // A drag or a turn of the wheel takes the model's camera over.
      for (const event of ["mousedown", "touchstart", "wheel"]) {
        this.canvas.addEventListener(event, () => this.freeCamera(), {capture: true, passive: true});
      }
    }

    cameraPose(number) {
      const {scene} = this.data.runs[0];
      const position = new THREE.Vector3(), rotation = new THREE.Quaternion();
      if (number < 0) {
        const [x, y, z, w, a, b, c] = scene.free.pose;
        return {position: position.set(x, y, z), rotation: rotation.set(a, b, c, w), fovy: scene.free.fovy};
      }
      this.data.runs[0].cameras[number].write(this.stage.actors[0].frame, position, rotation);
      return {position, rotation, fovy: scene.cameras[number].fovy};
    }

    useCamera(number) {
      this.fixed = number;
      this.cameraChoice.value = String(number);
      this.invalidate();
    }

    // From where the model's camera stands.
    freeCamera() {
      if (this.fixed === null) return;
      this.placeCamera();
      this.fixed = null;
      this.cameraChoice.value = "free";
      const ball = this.stage.ball();
      const forward = new THREE.Vector3(0, 0, -1).applyQuaternion(this.camera.quaternion);
      const depth = ball.center.clone().sub(this.camera.position).dot(forward);
      const {extent} = this.data.runs[0].scene;
      this.orbit.target.copy(this.camera.position).addScaledVector(forward, depth > 0.02 * extent ? depth : Math.max(ball.radius, 0.02 * extent));
      this.orbit.update();
      this.invalidate();
    }

    placeCamera() {
      const {camera} = this;
      if (this.fixed !== null) {
        const {position, rotation, fovy} = this.cameraPose(this.fixed);
        camera.position.copy(position);
        camera.quaternion.copy(rotation);
        this.fovy = fovy;
      }
      const {scene} = this.data.runs[0];
      camera.near = scene.near;
      camera.far = scene.far;
      if (this.fixed === null) {
        const way = camera.position.distanceTo(this.orbit.target);
        camera.near = Math.min(scene.near, 0.05 * way);
        camera.far = Math.max(scene.far, 3 * way);
      }
    }

    setAspect(aspect) {
      const {camera} = this;
      const half = Math.tan(0.5 * this.fovy * Math.PI / 180) * (aspect < FRAMED_ASPECT ? FRAMED_ASPECT / aspect : 1);
      camera.fov = 2 * Math.atan(half) * 180 / Math.PI;
      camera.aspect = aspect;
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
    }

    // ---- drawing

    resize() {
      if (!this.isReady) return;
      this.width = Math.max(2, this.picture.clientWidth);
      this.height = Math.max(2, this.picture.clientHeight);
      this.canvas.style.width = this.width + "px";
      this.canvas.style.height = this.height + "px";
      this.invalidate();
    }

    draw(best) {
      const {renderer, stage} = this;
      const quality = best || !this.isSoftware ? BEST : QUICK;
      if (renderer.getPixelRatio() !== quality.pixels) renderer.setPixelRatio(quality.pixels);
      const size = renderer.getSize(new THREE.Vector2());
      if (size.x !== this.width || size.y !== this.height) renderer.setSize(this.width, this.height, false);
      renderer.shadowMap.enabled = quality.shadows;
      if (stage.shadows !== quality.shadows) {
        stage.shadows = quality.shadows;
        stage.poseLights();
      }
      stage.thinWater(quality.water);
      const tone = prefersDark.matches && !matchMedia("print").matches ? DARK : LIGHT;
      stage.setBackdrop(tone.top, tone.bottom);
      this.placeCamera();
      this.labels.textContent = "";
      renderer.clear();
      this.setAspect(this.width / this.height);
      stage.appear();
      renderer.render(stage.scene, this.camera);
      this.label();
      if (!this.box.dataset.firstMs) this.box.dataset.firstMs = String(Math.round(performance.now()));
    }

    // The numbers beyond the tips of the arrows.
    label() {
      const most = {x: this.width, y: this.height};
      for (const actor of this.stage.showsForces ? this.stage.actors : []) {
        for (const arrow of actor.arrows) {
          if (!arrow.json.unit || !arrow.object.visible || arrow.from.distanceTo(arrow.to) < 0.004) continue;
          const from = this.project(arrow.from), to = this.project(arrow.to);
          if (!from || !to) continue;
          const text = numberText(arrow.value) + " " + arrow.json.unit;
          const half = {x: 0.31 * 15 * text.length, y: 9}, length = Math.max(Math.hypot(to.x - from.x, to.y - from.y), 1);
          const along = {x: (to.x - from.x) / length, y: (to.y - from.y) / length};
          const reach = Math.abs(along.x) * half.x + Math.abs(along.y) * half.y + 6;
          const inside = (k) => Math.min(Math.max(to[k] + reach * along[k], half[k]), most[k] - half[k]) + "px";
          const made = element("span", "force", this.labels, text);
          Object.assign(made.style, {left: inside("x"), top: inside("y"),
                                     color: `rgb(${arrow.colour.map((v) => Math.round(255 * v)).join(",")})`});
        }
      }
    }

    // In pixels; nothing for what is behind the camera.
    project(point) {
      const p = point.clone().applyMatrix4(this.camera.matrixWorldInverse);
      if (p.z > -this.camera.near) return null;
      const scale = 0.5 * this.height * this.camera.projectionMatrix.elements[5] / -p.z;
      return {x: 0.5 * this.width + scale * p.x, y: 0.5 * this.height - scale * p.y};
    }

    invalidate() {
      if (!this.isReady) return;
      clearTimeout(this.resting);
      if (this.waiting) return;
      this.waiting = requestAnimationFrame((now) => {
        this.waiting = null;
        this.tick(now);
      });
    }

    tick(now) {
      if (this.isPlaying) {
        if (this.lastTick !== null) {
          const passed = now - this.lastTick;
          const time = this.time + Math.min(passed, 250) / 1000 * this.speed;
          if (time >= this.end) this.pause();
          this.lastTick = now;
          this.seek(time, true);
        } else {
          this.lastTick = now;
        }
      }
      this.draw();
      if (this.isPlaying) this.invalidate();
      else this.resting = setTimeout(() => this.rest(), REST_MS);
    }

    // A still picture has the best quality.
    rest() {
      if (this.isReady && !this.isPlaying && !this.waiting) this.draw(true);
    }
  }

  const boxes = Array.from(document.querySelectorAll(".replay"));
  // Space plays wherever the focus is, but for what it acts on itself.
  document.addEventListener("keydown", (event) => {
    if (event.key !== " " || event.target.closest(".replay.live, button, select, input, textarea, summary")) return;
    const live = boxes.map((box) => box.replay).filter((view) => view.isReady);
    if (live.length === 0) return;
    const middle = (view) => { const at = view.box.getBoundingClientRect(); return Math.abs(at.top + at.bottom - innerHeight); };
    live.sort((a, b) => middle(a) - middle(b))[0].toggle();
    event.preventDefault();
  });
  for (const box of boxes) {
    const view = new View(box);
    if (box.dataset.group && window.pagePlayers) {
      view.player = pagePlayers.add(box.dataset.group, {seek: (time) => { view.pause(); view.seek(time); }, begin: view.time});
    }
  }
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) entry.target.replay.start();
  }, {rootMargin: "200px"});
  boxes.forEach((box) => seen.observe(box));
})();
