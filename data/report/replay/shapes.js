// Shapes as MuJoCo has them: their axis is z, their sizes are half lengths.
"use strict";
(() => {
  const SLICES = 40;

  function geometry(position, normal, index, uv) {
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(new Float32Array(position), 3));
    made.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(normal), 3));
    if (uv) made.setAttribute("uv", new THREE.BufferAttribute(new Float32Array(uv), 2));
    made.setIndex(index instanceof Uint32Array || index instanceof Uint16Array ? new THREE.BufferAttribute(index, 1)
                                                                              : index);
    return made;
  }

  // The library's axis is y.
  const upright = (made) => made.rotateX(Math.PI / 2);

  function sphere() { return upright(new THREE.SphereBufferGeometry(1, SLICES, SLICES / 2)); }

  function capsule(radius, half) {
    const profile = Array.from({length: SLICES / 2 + 2}, (_, i) => {
      const isUpper = i > SLICES / 4, angle = Math.PI * (2 * (i - isUpper) / SLICES - 0.5);
      return new THREE.Vector2(radius * Math.cos(angle), radius * Math.sin(angle) + (isUpper ? half : -half));
    });
    return upright(new THREE.LatheBufferGeometry(profile, SLICES));
  }

  function cylinder(radius, half) { return upright(new THREE.CylinderBufferGeometry(radius, radius, 2 * half, SLICES)); }

  // From z = 0 to its tip at z = length.
  function cone(radius, length) {
    return upright(new THREE.ConeBufferGeometry(radius, length, SLICES)).translate(0, 0, length / 2);
  }

  // A size of 0 goes on as far as one sees.
  function plane([x, y], far) { return new THREE.PlaneBufferGeometry(2 * (x || far), 2 * (y || far)); }

  // Every n-th row and column, and the last ones.
  function gridIndex(rows, columns, every = 1) {
    const taken = (count) => [...Array.from({length: Math.ceil((count - 1) / every)}, (_, i) => i * every), count - 1];
    const down = taken(rows), across = taken(columns);
    const index = new Uint32Array(6 * (down.length - 1) * (across.length - 1));
    let at = 0;
    for (let r = 0; r + 1 < down.length; ++r) {
      for (let c = 0; c + 1 < across.length; ++c) {
        const a = down[r] * columns + across[c], b = down[r] * columns + across[c + 1];
        const d = down[r + 1] * columns + across[c], e = down[r + 1] * columns + across[c + 1];
        index.set([a, b, e, a, e, d], at);
        at += 6;
      }
    }
    return index;
  }

  function field({rows, columns, size, heights}) {
    const position = new Float32Array(3 * rows * columns);
    for (let r = 0; r < rows; ++r) {
      for (let c = 0; c < columns; ++c) {
        const i = r * columns + c;
        position[3 * i] = size[0] * (2 * c / (columns - 1) - 1);
        position[3 * i + 1] = size[1] * (2 * r / (rows - 1) - 1);
        position[3 * i + 2] = size[2] * heights[i];
      }
    }
    const made = geometry(position, new Float32Array(position.length), gridIndex(rows, columns));
    made.computeVertexNormals();
    return made;
  }

  // An edge is sharp where the normal of a vertex differs much from that of the face, as in MuJoCo. A mesh with
  // texture coordinates has correct normals.
  const SHARP = 0.8;

  function mesh({vertices, normals, texcoords, faces}) {
    if (texcoords) return geometry(vertices, normals, faces, texcoords);
    const position = new Float32Array(3 * faces.length), normal = new Float32Array(3 * faces.length);
    const [a, b, c, n] = Array.from({length: 4}, () => new THREE.Vector3());
    for (let f = 0; f < faces.length; f += 3) {
      [a, b, c].forEach((corner, k) => corner.fromArray(vertices, 3 * faces[f + k]));
      const face = b.clone().sub(a).cross(c.clone().sub(a)).normalize();
      [a, b, c].forEach((corner, k) => {
        n.fromArray(normals, 3 * faces[f + k]);
        corner.toArray(position, 3 * (f + k));
        (n.dot(face) < SHARP ? face : n).toArray(normal, 3 * (f + k));
      });
    }
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(position, 3));
    made.setAttribute("normal", new THREE.BufferAttribute(normal, 3));
    return made;
  }

  function of(geom, asset, far) {
    const [x, y, z] = geom.size;
    switch (geom.shape) {
      case "plane": return plane(geom.size, far);
      case "sphere": return sphere().scale(x, x, x);
      case "capsule": return capsule(x, y);
      case "cylinder": return cylinder(x, y);
      case "ellipsoid": return sphere().scale(x, y, z);
      case "box": return new THREE.BoxBufferGeometry(2 * x, 2 * y, 2 * z);
      case "field": return field(asset);
      default: return mesh(asset);
    }
  }

  Replay.shapes = {of, sphere, cylinder, cone, geometry, gridIndex};
})();
