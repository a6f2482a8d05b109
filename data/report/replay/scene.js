// The runs of a replay as one scene of three.js, posed at any time.
"use strict";
(() => {
  // Its identity's, as the page has it now.
  const runColour = (run) => getComputedStyle(document.documentElement).getPropertyValue("--c" + run.colour).trim();
  const GHOST_OPACITY = 0.42;
  const SHORTEST_ARROW_M = 1e-4;

  const vector = ([x, y, z]) => new THREE.Vector3(x, y, z);

  function place(object, [x, y, z, w, a, b, c]) {
    object.position.set(x, y, z);
    object.quaternion.set(a, b, c, w);
  }

  // How often a texture is repeated for one metre.
  function repeatsOf(geom) {
    return [0, 1].map((k) => geom.uniform || !(geom.size[k] > 0) ? geom.repeat[k] : geom.repeat[k] / geom.size[k]);
  }

  // Water as a grid in the world whose heights are the sum of its waves. Waves of one direction are
  // one table over the way along it.
  class Water {
    constructor(geom, asset, waves, material) {
      this.groups = [];
      for (const [amplitude, kx, ky, omega, phase, before, after, from, to] of waves) {
        const k = Math.hypot(kx, ky), dx = k > 0 ? kx / k : 1, dy = k > 0 ? ky / k : 0;
        let group = this.groups.find((g) => Math.abs(g.dx - dx) + Math.abs(g.dy - dy) < 1e-9);
        if (!group) this.groups.push(group = {dx, dy, waves: []});
        group.waves.push({amplitude, k, omega, phase, before, after, from, to});
      }
      const frame = new THREE.Object3D();
      place(frame, geom.pose);
      frame.updateMatrix();
      const {rows, columns, size} = asset;
      const flat = new Float32Array(3 * rows * columns);
      const local = new Float32Array(3 * rows * columns);
      const point = new THREE.Vector3();
      for (let r = 0; r < rows; ++r) {
        for (let c = 0; c < columns; ++c) {
          const i = 3 * (r * columns + c);
          point.set(size[0] * (2 * c / (columns - 1) - 1), size[1] * (2 * r / (rows - 1) - 1), 0);
          local.set([point.x, point.y, 0], i);
          point.applyMatrix4(frame.matrix);
          flat.set([point.x, point.y, 0], i);
        }
      }
      // The finest that is worth it: ten points to the shortest wave, as far as the grid goes.
      this.reach = Math.hypot(size[0], size[1]) + Math.hypot(geom.pose[0], geom.pose[1]);
      const shortest = Math.max(...this.groups.flatMap((g) => g.waves.map((w) => w.k)), 1e-6);
      this.entries = Math.min(4096, Math.max(64, Math.ceil(2 * this.reach * shortest / 0.6)));
      for (const group of this.groups) group.height = new Float64Array(this.entries);
      this.flips = frame.matrix.elements[10] < 0;
      this.grid = {rows, columns};
      this.indices = new Map();
      this.geometry = Replay.shapes.geometry(flat, new Float32Array(flat.length), this.index(1));
      this.indices.set(1, this.geometry.index);
      // The texture lies in the geom's own frame.
      this.geometry.setAttribute("uv", new THREE.BufferAttribute(new Float32Array(2 * rows * columns), 2));
      this.local = local;
      this.mesh = new THREE.Mesh(this.geometry, material);
      this.mesh.frustumCulled = false;
      this.mesh.renderOrder = 1;
    }

    index(every) {
      const index = Replay.shapes.gridIndex(this.grid.rows, this.grid.columns, every);
      if (this.flips) for (let i = 0; i < index.length; i += 3) [index[i + 1], index[i + 2]] = [index[i + 2], index[i + 1]];
      return index;
    }

    // Draws every so many rows and columns: without a graphics card triangles cost more than pixels.
    thin(every) {
      if (!this.indices.has(every)) this.indices.set(every, new THREE.BufferAttribute(this.index(every), 1));
      if (this.geometry.index === this.indices.get(every)) return;
      this.geometry.setIndex(this.indices.get(every));
      this.geometry.computeVertexNormals();  // the shown vertices alone
    }

    uvBy([sx, sy]) {
      const uv = this.geometry.attributes.uv;
      for (let i = 0; i < uv.count; ++i) uv.setXY(i, 0.5 * sx * this.local[3 * i] - 0.5, -0.5 * sy * this.local[3 * i + 1] - 0.5);
    }

    pose(time) {
      const step = 2 * this.reach / (this.entries - 1);
      for (const group of this.groups) {
        group.height.fill(0);
        for (const wave of group.waves) {
          const part = wave.to > wave.from ? Math.min(Math.max((time - wave.from) / (wave.to - wave.from), 0), 1)
                                           : time > wave.from ? 1 : 0;
          const a = wave.amplitude * (wave.before + part * (wave.after - wave.before));
          if (a === 0) continue;
          // cos and sin of equally spaced angles, by turning the first one on.
          const first = -wave.k * this.reach - wave.omega * time + wave.phase;
          const cs = Math.cos(wave.k * step), sn = Math.sin(wave.k * step);
          let c = Math.cos(first), s = Math.sin(first);
          for (let i = 0; i < this.entries; ++i) {
            group.height[i] += a * c;
            [c, s] = [c * cs - s * sn, s * cs + c * sn];
          }
        }
      }
      const position = this.geometry.attributes.position, p = position.array;
      for (let i = 0; i < p.length; i += 3) {
        p[i + 2] = 0;
        for (const group of this.groups) {
          const exact = (p[i] * group.dx + p[i + 1] * group.dy + this.reach) / step;
          const k = Math.min(Math.max(Math.floor(exact), 0), this.entries - 2), part = exact - k;
          p[i + 2] += group.height[k] + part * (group.height[k + 1] - group.height[k]);
        }
      }
      position.needsUpdate = true;
      this.geometry.computeVertexNormals();
    }
  }

  class Arrow {
    constructor(json, shared) {
      this.json = json;
      this.object = new THREE.Group();
      const material = Replay.shading.material(
        {rgba: [...json.colour, 1], emission: 0.45, specular: 0.5, shininess: 0.5}, shared);
      this.material = material;
      this.shaft = new THREE.Mesh(Replay.shapes.cylinder(0.006, 0.5).translate(0, 0, 0.5), material);
      this.tip = new THREE.Mesh(Replay.shapes.cone(0.0105, 1), material);
      this.mark = new THREE.Mesh(Replay.shapes.sphere(), material);
      this.mark.scale.setScalar(json.mark || 1);
      this.object.add(this.shaft, this.tip);
      this.from = new THREE.Vector3();
      this.to = new THREE.Vector3();
      this.site = new THREE.Vector3();
      this.value = 0;
    }

    paint(colour) {
      this.colour = colour;
      this.material.uniforms.colour.value.fromArray(colour);
    }

    pose(run, frame, bodies, showsForces) {
      const {json} = this;
      const body = bodies[json.body];
      const [x, y, z, w, a, b, c] = json.site;
      this.site.set(x, y, z).applyQuaternion(body.quaternion).add(body.position);
      const values = json.signals.map((at) => at(frame));
      const force = vector(json.along.map((factor, k) => factor * (values.length === 3 ? values[k] : values[0])));
      this.value = force.length();
      const reach = force.clone().multiplyScalar(json.scale);
      if (json.inSite) {
        reach.applyQuaternion(new THREE.Quaternion(a, b, c, w)).applyQuaternion(body.quaternion);
      }
      this.from.copy(this.site).add(vector(json.offset));
      this.to.copy(this.from).add(reach);
      const length = reach.length();
      const isSeen = showsForces && length > SHORTEST_ARROW_M;
      this.object.visible = isSeen;
      this.mark.visible = showsForces && json.mark > 0 && this.value > 0;
      this.mark.position.copy(this.site);
      if (!isSeen) return;
      this.object.position.copy(this.from);
      this.object.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), reach.divideScalar(length));
      this.shaft.scale.set(1, 1, length * 2 / 3);
      this.tip.scale.set(1, 1, length / 3);
      this.tip.position.z = length * 2 / 3;
    }
  }

  // One run in the scene.
  class Actor {
    constructor(run, data, stage) {
      this.run = run;
      this.colour = runColour(run);
      this.root = new THREE.Group();
      this.bodies = run.scene.bodies.map(() => new THREE.Group());
      for (const body of this.bodies) this.root.add(body);
      this.meshes = [];
      this.waters = [];
      for (const geom of run.scene.geoms) this.addGeom(geom, data, stage);
      this.visibility = run.visibility.map((one) => ({...one, shape: this.meshes.find((m) => m.geom.id === one.geom)}));
      this.arrows = run.arrows.map((json) => new Arrow(json, stage.shared));
      for (const arrow of this.arrows) this.root.add(arrow.object, arrow.mark);
    }

    addGeom(geom, data, stage) {
      const asset = geom.asset === undefined ? null : data.assets[geom.asset];
      const waves = this.run.surfaces.find((surface) => surface.geom === geom.name);
      const texture = geom.texture >= 0 ? stage.textureOf(geom.texture) : null;
      const given = Boolean(asset && asset.texcoords) || Boolean(waves);
      const repeats = texture && (texture.isCubeTexture
        ? (geom.uniform ? [1, 1, 1] : geom.size.map((v) => v > 0 ? 1 / v : 1)) : repeatsOf(geom));
      const look = {...geom, repeats, givenUv: given, water: waves ? 0.78 : 0, bothSides: Boolean(waves)};
      const material = Replay.shading.material(look, stage.shared, texture);
      const moves = this.run.bodies[geom.body].moves;
      let mesh;
      if (waves) {
        const water = new Water(geom, asset, waves.waves, material);
        if (texture) water.uvBy(repeatsOf(geom));
        this.waters.push(water);
        mesh = water.mesh;
        this.root.add(mesh);
      } else {
        mesh = new THREE.Mesh(Replay.shapes.of(geom, asset, stage.far), material);
        place(mesh, geom.pose);
        this.bodies[geom.body].add(mesh);
      }
      mesh.receiveShadow = !waves;
      mesh.geometry.computeBoundingSphere();
      const ghost = Replay.shading.material(
        {...geom, rgba: [...new THREE.Color(this.colour).toArray(), GHOST_OPACITY], emission: 0.1}, stage.shared);
      // Where it coincides with the whole run, that one is seen.
      Object.assign(ghost, {depthWrite: true, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4});
      const isBounded = !waves && geom.shape !== "plane" && geom.shape !== "field";
      mesh.castShadow = isBounded && geom.rgba[3] > 0.5;
      this.meshes.push({geom, mesh, material, ghost, moves, isBounded, casts: mesh.castShadow});
    }

    pose(time, showsForces) {
      const {run} = this;
      const frame = this.frame = run.times.place(time);
      run.bodies.forEach((track, i) => track.write(frame, this.bodies[i].position, this.bodies[i].quaternion));
      for (const one of this.visibility) one.shape.hidden = one.column[frame.frame] === 0;
      for (const water of this.waters) water.pose(Math.min(Math.max(time, run.times.begin), run.times.end));
      for (const arrow of this.arrows) arrow.pose(run, frame, this.bodies, showsForces);
    }

    // "whole": as it is; "ghost": what moves, in the run's colour.
    appear(how, shadows) {
      for (const arrow of this.arrows) arrow.paint(how === "ghost" ? new THREE.Color(this.colour).toArray() : arrow.json.colour);
      for (const one of this.meshes) {
        const {mesh, material, ghost, moves, casts} = one;
        mesh.material = how === "ghost" ? ghost : material;
        mesh.visible = !one.hidden && (how === "whole" || moves);
        mesh.castShadow = shadows && casts && how === "whole";
        mesh.receiveShadow = how === "whole" && !this.waters.some((w) => w.mesh === mesh);
      }
    }

    // A ball around what moves now, in the world.
    ball() {
      const ball = new THREE.Sphere(new THREE.Vector3(), -1);
      for (const {mesh, moves, isBounded, geom} of this.meshes) {
        if (!moves || !isBounded) continue;
        const body = this.bodies[geom.body];
        const own = mesh.geometry.boundingSphere;
        const centre = own.center.clone().applyQuaternion(mesh.quaternion).add(mesh.position)
          .applyQuaternion(body.quaternion).add(body.position);
        include(ball, centre, own.radius);
      }
      return ball;
    }
  }

  // The smallest ball around two, in place of the first.
  function include(ball, centre, radius) {
    if (ball.radius < 0) {
      ball.center.copy(centre);
      ball.radius = radius;
      return;
    }
    const way = centre.distanceTo(ball.center);
    if (way + radius <= ball.radius) return;
    if (way + ball.radius <= radius) {
      ball.center.copy(centre);
      ball.radius = radius;
      return;
    }
    const whole = 0.5 * (way + radius + ball.radius);
    ball.center.lerp(centre, (whole - ball.radius) / way);
    ball.radius = whole;
  }

  class Stage {
    constructor(data, anisotropy) {
      this.data = data;
      this.anisotropy = anisotropy;
      this.textures = new Map();
      this.scene = new THREE.Scene();
      this.shared = Replay.shading.lightUniforms();
      const {scene} = data.runs[0];
      this.far = scene.far;
      this.actors = data.runs.map((run) => new Actor(run, data, this));
      for (const actor of this.actors) this.scene.add(actor.root);
      this.backdrop = Replay.shading.backdrop();
      this.backdrop.visible = scene.sky < 0;  // a sky hides it
      this.scene.add(this.backdrop);
      if (scene.sky >= 0) this.scene.add(Replay.shading.sky(this.textureOf(scene.sky)));
      this.makeLights(scene);
      this.showsForces = true;
      this.shadows = true;
    }

    textureOf(asset) {
      if (!this.textures.has(asset)) {
        const data = this.data.assets[asset];
        this.textures.set(asset, data.cube ? Replay.shading.cube(data) : Replay.shading.picture(data, this.anisotropy));
      }
      return this.textures.get(asset);
    }

    makeLights(scene) {
      const {shared} = this;
      const {headlight, lights} = scene;
      const ambient = vector(headlight.ambient);
      shared.headDiffuse.value.fromArray(headlight.diffuse);
      shared.headSpecular.value.fromArray(headlight.specular);
      if (lights.length === 0 && headlight.diffuse.every((v) => v === 0)) ambient.addScalar(0.3);
      this.lights = [];
      // Lights with shadows come first, as three.js sorts them.
      const order = lights.map((light, i) => ({light, i})).sort((a, b) => Number(b.light.shadow) - Number(a.light.shadow));
      for (const {light, i} of order) {
        ambient.add(vector(light.ambient));
        const colour = new THREE.Color(...light.diffuse);
        const made = light.directional ? new THREE.DirectionalLight(colour, 1)
                                       : new THREE.SpotLight(colour, 1, 0, Math.min(light.cutoff, 89) * Math.PI / 180, 0, light.exponent);
        (light.directional ? shared.directionalSpecular : shared.spotSpecular).value.push(vector(light.specular));
        (light.directional ? shared.directionalApart : shared.spotApart).value.push(light.shadow ? 1 : 0);
        made.target = new THREE.Object3D();
        made.shadow.mapSize.set(2048, 2048);
        this.scene.add(made, made.target);
        this.lights.push({made, json: light, track: this.data.runs[0].lights[i]});
      }
      shared.ambient.value.copy(ambient);
    }

    poseLights() {
      const ball = this.ball();
      const position = new THREE.Vector3(), rotation = new THREE.Quaternion();
      for (const {made, json, track} of this.lights) {
        track.write(this.actors[0].frame, position, rotation);
        const direction = new THREE.Vector3(0, 0, -1).applyQuaternion(rotation);
        made.castShadow = this.shadows && json.shadow;
        if (json.directional) {
          // Its map is fitted to what moves and what stands near.
          const r = 1.1 * ball.radius;
          made.target.position.copy(ball.center);
          made.position.copy(ball.center).addScaledVector(direction, -4 * r);
          if (made.castShadow) {
            Object.assign(made.shadow.camera, {left: -r, right: r, top: r, bottom: -r, near: 0.5 * r, far: 12 * r});
            made.shadow.bias = -0.0006;
            made.shadow.camera.updateProjectionMatrix();
          }
        } else {
          made.position.copy(position);
          made.target.position.copy(position).add(direction);
          if (made.castShadow) {
            Object.assign(made.shadow.camera, {near: 0.05 * ball.radius, far: 4 * (ball.radius + position.distanceTo(ball.center))});
            made.shadow.bias = -0.0006;
          }
        }
        made.updateMatrixWorld();
        made.target.updateMatrixWorld();
      }
    }

    // A ball around what moves, and what bounded things stand near it.
    ball() {
      const ball = this.actors[0].ball();
      if (ball.radius < 0) {
        ball.center.fromArray(this.data.runs[0].scene.centre);
        ball.radius = this.data.runs[0].scene.extent;
        return ball;
      }
      const reach = 3 * ball.radius, middle = ball.center.clone();
      for (const {mesh, moves, isBounded, geom} of this.actors[0].meshes) {
        if (moves || !isBounded) continue;
        const own = mesh.geometry.boundingSphere;
        const centre = vector(geom.pose).add(this.actors[0].bodies[geom.body].position);
        if (own.radius < reach && centre.distanceTo(middle) < reach) include(ball, centre, own.radius);
      }
      return ball;
    }

    pose(time) {
      for (const actor of this.actors) actor.pose(time, this.showsForces);
      this.poseLights();
    }

    // The first run as it is, the others as ghosts.
    appear() {
      this.actors.forEach((actor, i) => actor.appear(i === 0 ? "whole" : "ghost", this.shadows));
    }

    thinWater(every) {
      for (const actor of this.actors) for (const water of actor.waters) water.thin(every);
    }

    setBackdrop(top, bottom) {
      this.backdrop.material.uniforms.top.value.fromArray(top);
      this.backdrop.material.uniforms.bottom.value.fromArray(bottom);
    }
  }

  Replay.Stage = Stage;
})();
