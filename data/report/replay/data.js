// The data of a replay, unpacked: motions, meshes, textures.
"use strict";
const Replay = {};
(() => {
  function bytesOf(base64) {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
  }

  // A zlib stream in base64.
  async function unpacked(base64) {
    const stream = new Blob([bytesOf(base64)]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // Channels of `frames` numbers each, as src/pictures/replay_data.cpp writes them.
  function channelsOf(planes, channels, frames) {
    const count = channels * frames;
    const bytes = new Uint8Array(4 * count).map((_, i) => planes[(i % 4) * count + (i >> 2)]);
    return Array.from({length: channels}, (_, c) => new Float32Array(bytes.buffer, 4 * c * frames, frames));
  }

  // When the frames of a run are.
  class Times {
    constructor(list) {
      this.list = list;
      this.frames = list.length;
      this.begin = list[0];
      this.end = list[list.length - 1];
    }

    // The frame at or before a time, and how far it is to the next.
    place(time) {
      if (!(time > this.begin)) return {frame: 0, part: 0};
      if (time >= this.end) return {frame: this.frames - 1, part: 0};
      let frame = 0, after = this.frames - 1;
      while (after - frame > 1) {
        const middle = (frame + after) >> 1;
        if (this.list[middle] <= time) frame = middle;
        else after = middle;
      }
      return {frame, part: (time - this.list[frame]) / (this.list[after] - this.list[frame])};
    }

    timeOf(frame) { return this.list[frame]; }
  }

  const between = (column, {frame, part}) => column[frame] + part * (column[part > 0 ? frame + 1 : frame] - column[frame]);

  // Where a body, camera or light is: seven numbers, or seven channels.
  class Track {
    constructor(json, channels) {
      this.still = json.pose || null;
      if (this.still) return;
      this.columns = channels.slice(json.channel, json.channel + 7);
    }

    get moves() { return !this.still; }

    // Between two frames on the straight line, and on the short way round.
    write(place, position, rotation) {
      if (this.still) {
        const [x, y, z, w, a, b, c] = this.still;
        position.set(x, y, z);
        rotation.set(a, b, c, w);
        return;
      }
      const at = (k) => between(this.columns[k], place);
      position.set(at(0), at(1), at(2));
      rotation.set(at(4), at(5), at(6), at(3)).normalize();
    }
  }

  async function assetOf(json) {
    if (json.kind === "mesh") {
      const [vertices, normals, texcoords, faces] = await Promise.all(
        [json.vertices, json.normals, json.texcoords, json.faces].map((text) => text ? unpacked(text) : null));
      return {
        vertices: new Float32Array(vertices.buffer), normals: new Float32Array(normals.buffer),
        texcoords: texcoords && new Float32Array(texcoords.buffer),
        faces: json.wide ? new Uint32Array(faces.buffer) : new Uint16Array(faces.buffer)};
    }
    if (json.kind === "field") {
      const heights = json.heights ? new Float32Array((await unpacked(json.heights)).buffer)
                                   : new Float32Array(json.rows * json.columns);
      return {rows: json.rows, columns: json.columns, size: json.size, heights};
    }
    return {width: json.width, height: json.height, cube: json.cube, rgb: await unpacked(json.rgb)};
  }

  async function runOf(json) {
    const times = new Times(json.times);
    const channels = channelsOf(await unpacked(json.motion), json.channels, times.frames);
    const tracks = (list) => list.map((one) => new Track(one, channels));
    return {
      label: json.label, colour: json.colour, times, scene: json.scene, surfaces: json.surfaces,
      visibility: json.visibility.map((one) => ({...one, column: channels[one.channel]})),
      bodies: tracks(json.bodies), cameras: tracks(json.cameras), lights: tracks(json.lights),
      arrows: json.arrows.map((arrow) => ({...arrow, signals: arrow.values.map((one) => (place) => between(channels[one], place))})),
    };
  }

  Replay.load = async (json) => ({
    ...json,
    assets: await Promise.all(json.assets.map(assetOf)),
    runs: await Promise.all(json.runs.map(runOf)),
  });
})();
