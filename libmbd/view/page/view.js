// The page of `mbd view`. What it shows stands in three elements of the page: #drawing (JSON: parts, and where they are
// in the nodes), #history (JSON: columns of history.csv), #frames (base64: single precision, a frame after the other).
// Everything here is relative to the scene's centre, so that single precision is enough far from the origin.
'use strict';
(() => {
  const by = id => document.getElementById(id);
  const text = id => by(id).textContent;
  const D = JSON.parse(text('drawing'));
  const H = JSON.parse(text('history'));
  const decode = base64 => {
    const bytes = atob(base64.trim()), all = new Uint8Array(bytes.length);
    for (let i = 0; i < bytes.length; ++i) all[i] = bytes.charCodeAt(i);
    return new Float32Array(all.buffer);
  };
  const motion = D.motion;  // absent: a model
  const frames = motion ? motion.keys.length : 1;
  const keys = motion ? motion.keys : [0];
  const numbers = motion ? decode(text('frames')) : null;
  by('frames').textContent = '';
  const isTime = D.key === 'time';
  const centre = D.centre, size = D.size;
  const reference = decode(D.nodes), nodes = reference.length / 7;

  // ---- poses ------------------------------------------------------------------------------------------------------
  // Positions [m] from the centre and unit quaternions x y z w, by node.
  const refP = new Float64Array(3 * nodes), refQ = new Float64Array(4 * nodes);
  for (let n = 0; n < nodes; ++n) {
    for (let i = 0; i < 3; ++i) refP[3 * n + i] = reference[7 * n + i];
    for (let i = 0; i < 4; ++i) refQ[4 * n + i] = reference[7 * n + 3 + i];
  }
  for (let i = 0; i < 3; ++i) refP[i] = -centre[i];  // the ground, exactly
  const exactP = refP.slice(), exactQ = refQ.slice();  // of the frame
  const P = refP.slice(), Q = refQ.slice();            // as drawn
  let frame = 0, shownKey = keys[0], scale = 1;

  const multiply = (a, b) => [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]];
  const turn = (q, v) => {
    const [x, y, z, w] = q;
    const a = 2 * (y * v[2] - z * v[1]), b = 2 * (z * v[0] - x * v[2]), c = 2 * (x * v[1] - y * v[0]);
    return [v[0] + w * a + y * c - z * b, v[1] + w * b + z * a - x * c, v[2] + w * c + x * b - y * a];
  };
  const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const times = (s, a) => [s * a[0], s * a[1], s * a[2]];
  const norm = a => Math.hypot(...a);
  const nodeQ = (q, n) => [q[4 * n], q[4 * n + 1], q[4 * n + 2], q[4 * n + 3]];
  const nodeP = (p, n) => [p[3 * n], p[3 * n + 1], p[3 * n + 2]];
  // A place [node, r, q] in poses: {r, q}.
  const placeIn = (p, q, at) => {
    const turned = nodeQ(q, at[0]);
    return {r: add(nodeP(p, at[0]), turn(turned, at.slice(1, 4))), q: multiply(turned, at.slice(4, 8))};
  };
  const place = at => placeIn(P, Q, at);

  const size_ = motion ? motion.pose + motion.twist + motion.resultant + motion.joint : 0;
  const offset = f => f * size_;

  // The poses between frame f and the next, at the fraction u.
  function load(f, u, p, q) {
    if (!numbers) return;
    const a = offset(f), b = u > 0 ? offset(f + 1) : a;
    for (let n = 1; n < nodes; ++n) {
      const i = a + 7 * (n - 1), j = b + 7 * (n - 1);
      for (let k = 0; k < 3; ++k) p[3 * n + k] = numbers[i + k] + (u > 0 ? u * (numbers[j + k] - numbers[i + k]) : 0);
      let dot = 0, length = 0;
      for (let k = 0; k < 4; ++k) dot += numbers[i + 3 + k] * numbers[j + 3 + k];
      const s = dot < 0 ? -1 : 1;
      for (let k = 0; k < 4; ++k) {
        const c = (1 - u) * numbers[i + 3 + k] + u * s * numbers[j + 3 + k];
        q[4 * n + k] = c;
        length += c * c;
      }
      length = Math.sqrt(length) || 1;
      for (let k = 0; k < 4; ++k) q[4 * n + k] /= length;
    }
  }

  // Displacements and rotations from the reference configuration, times the scale.
  function exaggerate() {
    P.set(exactP);
    Q.set(exactQ);
    if (scale === 1) return;
    for (let n = 1; n < nodes; ++n) {
      for (let k = 0; k < 3; ++k) P[3 * n + k] = refP[3 * n + k] + scale * (exactP[3 * n + k] - refP[3 * n + k]);
      const r = nodeQ(refQ, n);
      let d = multiply([-r[0], -r[1], -r[2], r[3]], nodeQ(exactQ, n));
      if (d[3] < 0) d = d.map(c => -c);
      const sine = Math.hypot(d[0], d[1], d[2]), half = scale * Math.atan2(sine, d[3]);
      const factor = sine > 1e-12 ? Math.sin(half) / sine : scale;
      const turned = multiply(r, [factor * d[0], factor * d[1], factor * d[2], Math.cos(half)]);
      for (let k = 0; k < 4; ++k) Q[4 * n + k] = turned[k];
    }
  }

  // ---- the picture ------------------------------------------------------------------------------------------------
  const canvas = by('canvas');
  let renderer = null;
  try {
    renderer = new THREE.WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
  } catch (error) {
    by('notice').textContent = 'This browser draws no 3-D pictures (no WebGL). Numbers and curves are below.';
    by('notice').hidden = false;
  }
  const scene = new THREE.Scene(), world = new THREE.Group();
  scene.add(world);
  const gravity = D.parts.find(p => p.kind === 'gravity');
  const up = [0, 0, 1];
  if (gravity && norm(gravity.along) > 0) {
    const g = times(-1 / norm(gravity.along), gravity.along);
    const most = g.reduce((best, c, i) => Math.abs(c) > Math.abs(g[best]) ? i : best, 0);
    up.fill(0);
    up[most] = Math.sign(g[most]);
  }
  const camera = new THREE.PerspectiveCamera(35, 1, size / 1000, size * 1000);
  camera.up.set(...up);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.enableKeys = false;
  controls.screenSpacePanning = true;
  scene.add(new THREE.HemisphereLight(0xffffff, 0x777788, 0.75));
  const sun = new THREE.DirectionalLight(0xffffff, 0.5);
  camera.add(sun);
  sun.position.set(0.6, 1, 1);
  scene.add(camera);

  const codeOf = text => text ? parseInt(text.slice(1), 16) || 1 : undefined;  // of #rrggbb; black is nearly so
  const palette = {beam: 0x4f7fb5, body: 0xc98a2b, joint: 0x3d8f5f, spring: 0x8a5fb0, load: 0xc0392b, moment: 0xa0398c,
    mass: 0x7a5230, motion: 0x1f8fa3, record: 0xd1478c, gap: 0xff2a1a, ghost: 0x8c96a3, chosen: 0xff9d00,
    reaction: 0x7d1fd1, second: 0xd6336c};
  const unit = 0.014 * size;  // of glyphs, or more of those that would not be seen
  const e2 = new THREE.Vector3(0, 1, 0), way = new THREE.Vector3();  // way: of what is being turned

  const parts = D.parts.map((part, index) =>
    ({...part, index, objects: [], update: [], visible: true, anchor: null, paint: part.run ? undefined : codeOf(part.colour),
      colour: part.run ? palette.second : codeOf(part.colour) || palette[part.kind] || palette.joint}));
  const partOfName = name => parts.find(p => p.name === name && p.kind !== 'record') || parts.find(p => p.name === name);
  const lineOf = name => parts.find(p => p.kind === 'beam' && p.name === name);

  const material = (colour, more) => new THREE.MeshLambertMaterial({color: colour, ...more});
  function mark(part, object) {
    object.traverse(o => {
      o.userData.part = part.index;
      if (!part.run || !o.material) return;  // of two runs the second is seen through
      o.material.transparent = true;
      o.material.opacity = 0.42;
      o.material.depthWrite = false;
      o.material.polygonOffset = true;  // where both are at one place the first is seen
      o.material.polygonOffsetFactor = 2;
      o.material.polygonOffsetUnits = 8;
      o.renderOrder = 1;
    });
  }
  function put(part, object, follow) {
    mark(part, object);
    part.objects.push(object);
    inWorld(object);
    if (follow) part.update.push(() => follow(object));
    return object;
  }
  // Solids of one shape and kind of material are drawn by one call, whatever their poses, sizes and colours: thousands of
  // calls a picture are what a page is slow by. What stands for each (to be placed, painted, clicked on) is not in the scene.
  const solids = [];  // {object, meshes}: meshes are all that is drawn of the object
  const batches = new Map();
  const canBatch = renderer && (renderer.capabilities.isWebGL2 || renderer.extensions.get('ANGLE_instanced_arrays'));
  function inWorld(object) {
    const meshes = [];
    object.traverse(o => { if (o.isMesh) meshes.push(o); });
    if (meshes.length === 0 || !canBatch) world.add(object);
    else solids.push({object, meshes});
  }
  function batchOf(mesh) {
    const m = mesh.material;
    const key = [mesh.geometry.uuid, mesh.renderOrder, m.side, m.transparent, m.opacity, m.depthTest, m.depthWrite, m.polygonOffset].join();
    if (!batches.has(key)) batches.set(key, {mesh, count: 0, now: 0});
    return batches.get(key);
  }
  function makeBatches() {
    for (const {meshes} of solids)
      for (const mesh of meshes) ++(mesh.userData.batch = batchOf(mesh)).count;
    for (const batch of batches.values()) {
      const shape = batch.mesh.geometry, geometry = new THREE.BufferGeometry();
      geometry.setIndex(shape.index);
      for (const name of ['position', 'normal']) geometry.setAttribute(name, shape.attributes[name]);
      batch.colours = new THREE.InstancedBufferAttribute(new Float32Array(3 * batch.count), 3);
      geometry.setAttribute('color', batch.colours);
      const painted = batch.mesh.material.clone();
      painted.color.setHex(0xffffff);
      painted.vertexColors = THREE.VertexColors;
      batch.drawn = new THREE.InstancedMesh(geometry, painted, batch.count);
      batch.drawn.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
      batch.drawn.frustumCulled = false;
      batch.drawn.renderOrder = batch.mesh.renderOrder;
      world.add(batch.drawn);
    }
  }
  const copy = (from, into, at) => {  // is any other than it was?
    let other = false;
    for (let i = 0; i < from.length; ++i) {
      const value = Math.fround(from[i]);  // as it is kept
      if (into[at + i] !== value) into[at + i] = value, other = true;
    }
    return other;
  };
  function fillBatches() {
    for (const batch of batches.values()) batch.now = 0, batch.moved = batch.painted = false;
    for (const {object, meshes} of solids) {
      if (!object.visible) continue;
      object.updateMatrixWorld();
      for (const mesh of meshes) {
        const batch = mesh.userData.batch, i = batch.now++, c = mesh.material.color;
        batch.moved = copy(mesh.matrixWorld.elements, batch.drawn.instanceMatrix.array, 16 * i) || batch.moved;
        batch.painted = copy([c.r, c.g, c.b], batch.colours.array, 3 * i) || batch.painted;
      }
    }
    for (const batch of batches.values()) {
      batch.drawn.count = batch.now;
      batch.drawn.visible = batch.now > 0;
      if (batch.moved) batch.drawn.instanceMatrix.needsUpdate = true;
      if (batch.painted) batch.colours.needsUpdate = true;
    }
  }
  const stand = (object, pose) => {
    object.position.set(...pose.r);
    object.quaternion.set(...pose.q);
  };
  // Shapes of size 1, one of a kind, and solids that are these, scaled. Where a scale is not the same along all axes, the
  // normals of the shape stand along them or are equally scaled.
  const shapes = new Map();
  function shape(name, make) {
    if (!shapes.has(name)) shapes.set(name, make());
    return shapes.get(name);
  }
  const solid = (geometry, scale, colour, more) => {
    const mesh = new THREE.Mesh(geometry, material(colour, more));
    mesh.scale.set(...scale);
    return mesh;
  };
  // Cylinders of three.js lie along y.
  const cylinder = (radius, length, axis, colour, more, sides = 20) => solid(shape('cylinder ' + axis + sides, () => {
    const geometry = new THREE.CylinderBufferGeometry(1, 1, 1, sides);
    if (axis === 'x') geometry.rotateZ(-Math.PI / 2);
    if (axis === 'z') geometry.rotateX(Math.PI / 2);
    return geometry;
  }), ['x', 'y', 'z'].map(a => a === axis ? length : radius), colour, more);
  const ball = (radius, colour, more, sides = 20) =>
    solid(shape('ball ' + sides, () => new THREE.SphereBufferGeometry(1, sides, 0.7 * sides)), [radius, radius, radius], colour, more);
  const box = (sides, colour, more) => solid(shape('box', () => new THREE.BoxBufferGeometry(1, 1, 1)), sides, colour, more);

  // --- beams: a cubic between two nodes, along the first axes of their sections; sections swept along it
  const most = 45000;  // points of surfaces, so that a picture takes some milliseconds
  const count = () => parts.filter(p => p.kind === 'beam').reduce((n, p) => n + p.points.length - 1, 0);
  const every = Math.ceil(count() * 8 / (3 * most));  // of tens of thousands of nodes each second one, or fewer
  if (every > 1)
    for (const p of parts)
      if (p.kind === 'beam') {
        const some = list => list.filter((x, i) => i % every === 0 || i === list.length - 1);
        p.points = some(p.points);
        p.s = some(p.s);
        if (p.sides && p.sides.length > 1) p.sides = some(p.sides);
      }
  const intervals = count();
  const round = intervals > 400 ? 8 : 14;
  const pieces = Math.max(1, Math.min(6, Math.floor(most / round / Math.max(1, intervals))));
  const thinnest = 0.0022 * size;

  // Of points of a curve: {r: [[x, y, z], …], q: [[x, y, z, w], …]}; into `line`, if given.
  const emptyLine = count => ({r: Array.from({length: count}, () => [0, 0, 0]), q: Array.from({length: count}, () => [0, 0, 0, 1])});
  function centreLine(part, p, q, line) {
    const n = part.points.length, ends = part.ends;
    if (!line) line = emptyLine((n - 1) * pieces + 1);
    for (let i = 0; i < n; ++i) {  // poses of the sections, as place() has them
      const at = part.points[i], e = ends[i], m = at[0];
      const x = q[4 * m], y = q[4 * m + 1], z = q[4 * m + 2], w = q[4 * m + 3];
      const a = 2 * (y * at[3] - z * at[2]), b = 2 * (z * at[1] - x * at[3]), c = 2 * (x * at[2] - y * at[1]);
      e[0] = p[3 * m] + at[1] + w * a + y * c - z * b;
      e[1] = p[3 * m + 1] + at[2] + w * b + z * a - x * c;
      e[2] = p[3 * m + 2] + at[3] + w * c + x * b - y * a;
      const X = e[3] = w * at[4] + x * at[7] + y * at[6] - z * at[5], Y = e[4] = w * at[5] - x * at[6] + y * at[7] + z * at[4];
      const Z = e[5] = w * at[6] + x * at[5] - y * at[4] + z * at[7], W = e[6] = w * at[7] - x * at[4] - y * at[5] - z * at[6];
      e[7] = 1 - 2 * (Y * Y + Z * Z);  // the first axis of the section
      e[8] = 2 * (X * Y + W * Z);
      e[9] = 2 * (X * Z - W * Y);
    }
    for (let i = 0, o = 0; i + 1 < n; ++i) {
      const A = ends[i], B = ends[i + 1], L = part.spans[i];
      const sign = A[3] * B[3] + A[4] * B[4] + A[5] * B[5] + A[6] * B[6] < 0 ? -1 : 1;
      for (let k = i === 0 ? 0 : 1; k <= pieces; ++k, ++o) {
        const s = k / pieces, t = 1 - s, r = line.r[o], h = line.q[o];
        const ca = t * t * (1 + 2 * s), cb = s * s * (1 + 2 * t), da = L * s * t * t, db = -L * s * s * t;
        for (let j = 0; j < 3; ++j) r[j] = ca * A[j] + cb * B[j] + da * A[7 + j] + db * B[7 + j];
        let l = 0;
        for (let j = 0; j < 4; ++j) h[j] = t * A[3 + j] + s * sign * B[3 + j], l += h[j] * h[j];
        l = 1 / (Math.sqrt(l) || 1);
        for (let j = 0; j < 4; ++j) h[j] *= l;
      }
    }
    return line;
  }

  const pairs = flat => flat.filter((x, i) => i % 2 === 0).map((x, i) => [x, flat[2 * i + 1]]);
  // Two points an edge of an outline, with normals: one for both where it is smooth.
  function rimOf(outline, h2, h3) {
    const rim = pairs(outline.rim), smooth = Math.cos(0.6), before = [];
    outline.next.forEach((j, i) => before[j] = i);
    const normals = rim.map((a, i) => {
      const b = rim[outline.next[i]], y = h3 * (b[1] - a[1]), z = -h2 * (b[0] - a[0]), l = Math.hypot(y, z) || 1;
      return [y / l, z / l];
    });
    const between = (i, j) => {
      const a = normals[i], b = normals[j];
      if (a[0] * b[0] + a[1] * b[1] < smooth) return a;
      const l = Math.hypot(a[0] + b[0], a[1] + b[1]);
      return [(a[0] + b[0]) / l, (a[1] + b[1]) / l];
    };
    return rim.flatMap((a, i) => [[...a, ...between(i, before[i])], [...rim[outline.next[i]], ...between(i, outline.next[i])]]);
  }

  const tint = new THREE.Color(), flat = [0, 0, 0], shaded = [0, 0, 0];  // of the beam that is being drawn
  function makeBeam(part) {
    const first = part.points.map(at => placeIn(refP, refQ, at));
    part.spans = first.slice(1).map((h, i) => norm(minus(h.r, first[i].r)));
    part.fine = [];  // s of the points of the curve
    part.s.slice(1).forEach((s, i) => {
      for (let k = i === 0 ? 0 : 1; k <= pieces; ++k) part.fine.push(part.s[i] + (s - part.s[i]) * k / pieces);
    });
    part.painted = 'nothing yet';
    part.ends = part.points.map(() => new Float64Array(10));
    part.now = centreLine(part, refP, refQ);
    part.scratch = centreLine(part, refP, refQ);
    part.shown = new Float64Array(part.fine.length);  // the quantity of its colours
    part.reference = centreLine(part, refP, refQ).r;
    const count = part.fine.length;
    const sides = part.fine.map(s => {
      if (!part.sides) return [thinnest, thinnest, 1];
      if (part.sides.length === 1) return part.sides[0].map((side, k) => k < 2 ? Math.max(thinnest, side) : side);
      let i = 0;
      while (i + 2 < part.s.length && part.s[i + 1] < s) ++i;
      const u = (s - part.s[i]) / (part.s[i + 1] - part.s[i]);
      const [a, b] = [part.sides[i], part.sides[i + 1]];
      return [Math.max(thinnest, a[0] + u * (b[0] - a[0])), Math.max(thinnest, a[1] + u * (b[1] - a[1])), a[2]];
    });
    part.thickness = k => sides[k].slice(0, 2);
    // Points of a section and their normals, for half sides of 1.
    const ring = [], outline = part.outline ? D.outlines[part.outline] : null;
    if (outline)
      ring.push(...rimOf(outline, 0.5 * sides[0][0], 0.5 * sides[0][1]));
    else if (sides[0][2])
      for (let i = 0; i < round; ++i) {
        const c = Math.cos(2 * i * Math.PI / round), s = Math.sin(2 * i * Math.PI / round);
        ring.push([c, s, c, s]);
      }
    else
      for (const [y, z] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) ring.push([y + z, z - y, y, z], [y - z, z + y, y, z]);
    // What closes the ends: polygons, each of points of `lid`.
    const lid = outline ? outline.caps.flatMap(pairs) : ring;
    const polygons = outline ? outline.caps.map(cap => cap.length / 2) : [ring.length];
    const m = ring.length, total = count * m + 2 * lid.length;
    const index = [];
    const wraps = sides[0][2] && !outline ? 1 : 2;  // corners of a rectangle are two points each
    for (let k = 0; k + 1 < count; ++k)
      for (let i = 0; i < m; i += wraps) {
        const j = wraps === 1 ? (i + 1) % m : i + 1, a = k * m + i, b = k * m + j;
        index.push(a, b, a + m, b, b + m, a + m);
      }
    for (const [start, flip] of [[count * m, true], [count * m + lid.length, false]]) {
      let base = start;
      for (const corners of polygons) {
        for (let i = 1; i + 1 < corners; ++i) index.push(base, base + (flip ? i + 1 : i), base + (flip ? i : i + 1));
        base += corners;
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(indices(total, index));
    const mesh = new THREE.Mesh(geometry, material(0xffffff, {vertexColors: THREE.VertexColors, side: THREE.DoubleSide}));
    mark(part, mesh);
    part.objects.push(mesh);
    const surface = {part, mesh, total, index, whole: null, from: 0};
    surfaces.push(surface);
    const around = outline ? D.outlines[part.outline].next.flatMap((j, i) => [i, j]) : [];  // points of the outline, of the ring
    part.sweep = () => {
      const [position, normal, colour] = ['position', 'normal', 'color'].map(name => geometry.attributes[name].array);
      const line = centreLine(part, P, Q, part.now);
      const values = part.values ? part.values(line) : null;
      const over = chosen !== part && part.over ? part.over() : null;  // stresses differ around a section
      const colours = (part.values || part.over) !== part.painted || chosen === part || part.was || values || over;  // else they stay
      part.painted = part.values || part.over;
      part.was = chosen === part;
      const plain = tint.setHex(chosen === part ? palette.chosen : part.run ? palette.second : part.paint || (part.rigid ? palette.body : palette.beam));
      flat[0] = plain.r, flat[1] = plain.g, flat[2] = plain.b;
      for (let k = 0, o = 0; k < count + 2; ++k) {
        const at = k < count ? k : k === count ? 0 : count - 1;
        const r = line.r[at], side = sides[at], h2 = 0.5 * side[0], h3 = 0.5 * side[1];
        const q = line.q[at], x = q[0], y = q[1], z = q[2], w = q[3];
        const b10 = 1 - 2 * (y * y + z * z), b11 = 2 * (x * y + w * z), b12 = 2 * (x * z - w * y);
        const b20 = 2 * (x * y - w * z), b21 = 1 - 2 * (x * x + z * z), b22 = 2 * (y * z + w * x);
        const b30 = 2 * (x * z + w * y), b31 = 2 * (y * z - w * x), b32 = 1 - 2 * (x * x + y * y);
        const c = !colours ? null : values && chosen !== part ? shade(values[at], shaded) : flat;
        const cap = k < count ? 0 : k === count ? -1 : 1, points = cap ? lid : ring;
        for (let i = 0; i < points.length; ++i, o += 3) {
          const g = points[i], u = h2 * g[0], v = h3 * g[1];
          position[o] = r[0] + u * b20 + v * b30;
          position[o + 1] = r[1] + u * b21 + v * b31;
          position[o + 2] = r[2] + u * b22 + v * b32;
          normal[o] = cap ? cap * b10 : g[2] * b20 + g[3] * b30;
          normal[o + 1] = cap ? cap * b11 : g[2] * b21 + g[3] * b31;
          normal[o + 2] = cap ? cap * b12 : g[2] * b22 + g[3] * b32;
          if (over && !cap) shade(over(at, around[i]), shaded);
          const paint = over && !cap ? shaded : c;
          if (paint) colour[o] = paint[0], colour[o + 1] = paint[1], colour[o + 2] = paint[2];
        }
      }
      for (const name of ['position', 'normal', 'color'])
        if (name !== 'color' || colours) surface.whole.attributes[name].needsUpdate = true;
      geometry.boundingSphere = null;  // for clicks
    };
    part.update.push(part.sweep);
    part.anchor = () => part.now.r[Math.floor(count / 2)];
    part.points_ = () => part.now.r;
  }
  // The surfaces of all beams of a run are drawn by one call: the arrays of each are a stretch of those of all. So are the
  // curves where they were at first.
  const surfaces = [], joined = [];
  let ghosts = null, stale = false;  // stale: what is visible is other than is drawn
  const indices = (points, of) => new (points > 65535 ? THREE.Uint32BufferAttribute : THREE.Uint16BufferAttribute)(of, 1);
  const sum = (list, of) => list.reduce((n, x) => n + of(x), 0);
  function joinSurfaces() {
    for (const run of new Set(surfaces.map(s => s.part.run))) {
      const those = surfaces.filter(s => s.part.run === run), points = sum(those, s => s.total);
      const geometry = new THREE.BufferGeometry();
      geometry.setIndex(indices(points, sum(those, s => s.index.length)));
      for (const name of ['position', 'normal', 'color']) {
        const all = new Float32Array(3 * points);
        geometry.setAttribute(name, new THREE.BufferAttribute(all, 3).setUsage(THREE.DynamicDrawUsage));
        let from = 0;
        for (const s of those) {
          s.mesh.geometry.setAttribute(name, new THREE.BufferAttribute(all.subarray(3 * from, 3 * (from + s.total)), 3));
          s.whole = geometry;
          s.from = from;
          from += s.total;
        }
      }
      const mesh = new THREE.Mesh(geometry, those[0].mesh.material);
      mesh.frustumCulled = false;
      mesh.renderOrder = those[0].mesh.renderOrder;
      world.add(mesh);
      joined.push({mesh, those});
    }
    const references = surfaces.flatMap(s => s.part.reference), curves = new THREE.BufferGeometry();
    curves.setFromPoints(references.map(r => new THREE.Vector3(...r)));
    curves.setIndex(indices(references.length, 2 * references.length));
    ghosts = new THREE.LineSegments(curves, new THREE.LineBasicMaterial({color: palette.ghost}));
    ghosts.frustumCulled = false;
    world.add(ghosts);
    stale = true;
  }
  function showSurfaces() {
    stale = false;
    const draw = (mesh, count) => {
      mesh.geometry.index.needsUpdate = true;
      mesh.geometry.setDrawRange(0, count);
    };
    for (const {mesh, those} of joined) {
      let n = 0;
      for (const s of those) if (s.part.visible) for (const i of s.index) mesh.geometry.index.array[n++] = s.from + i;
      draw(mesh, n);
    }
    let n = 0, from = 0;
    for (const {part} of surfaces) {
      for (let i = 1; part.visible && i < part.reference.length; ++i) {
        ghosts.geometry.index.array[n++] = from + i - 1;
        ghosts.geometry.index.array[n++] = from + i;
      }
      from += part.reference.length;
    }
    draw(ghosts, n);
  }

  // A point of a beam: {r, q} now.
  function onBeam(name, s) {
    const part = lineOf(name);
    if (!part) return {r: [0, 0, 0], q: [0, 0, 0, 1]};
    let i = 0;
    while (i + 2 < part.fine.length && part.fine[i + 1] < s) ++i;
    const u = Math.min(1, Math.max(0, (s - part.fine[i]) / (part.fine[i + 1] - part.fine[i])));
    const a = part.now.r[i], b = part.now.r[i + 1];
    return {r: add(times(1 - u, a), times(u, b)), q: part.now.q[u < 0.5 ? i : i + 1]};
  }
  const poseOf = part => part.at ? place(part.at) : onBeam(part.on.beam, part.on.s);

  // Glyphs stand out of the beams they are at.
  let girths = null;
  const cell = r => r.map(c => Math.round(c / (1e-3 * size))).join();
  function unitAt(place) {
    if (!girths) {
      girths = new Map();
      for (const p of parts)
        if (p.kind === 'beam' && p.sides)
          p.reference.forEach((r, k) => girths.set(cell(r), Math.max(girths.get(cell(r)) || 0, Math.min(...p.thickness(k)))));
    }
    return Math.max(unit, Math.min(0.7 * (girths.get(cell(place)) || 0), 0.06 * size));
  }
  // Where joints, springs and loads are at what moves with the node of a body, in the body's axes.
  function armsOf(part) {
    const own = placeIn(refP, refQ, part.at), back = [-own.q[0], -own.q[1], -own.q[2], own.q[3]], all = [];
    for (const other of parts)
      for (const at of [other.a, other.b, other.kind === 'load' || other.kind === 'mass' ? other.at : null])
        if (at && at[0] === part.at[0] && at[0] !== 0) {
          const r = turn(back, minus(placeIn(refP, refQ, at).r, own.r));
          if (!all.some(x => norm(minus(x, r)) < 1e-6 * size)) all.push(r);
        }
    return all;
  }
  const unitOf = part => unitAt(placeIn(refP, refQ, part.b || part.at || [0, 0, 0, 0, 0, 0, 0, 1]).r);

  function formOf(form, part) {
    const colour = part.run ? part.colour : codeOf(form.colour) || part.colour;
    let mesh;
    if (form.kind === 'box') mesh = box(form.sides, colour);
    else if (form.kind === 'sphere') mesh = ball(form.sides[0] / 2, colour, {}, 40);
    else if (form.kind === 'cylinder') mesh = cylinder(form.sides[0] / 2, form.sides[2], 'z', colour, {}, 48);
    else {
      const indexed = new THREE.BufferGeometry();
      indexed.setAttribute('position', new THREE.BufferAttribute(new Float32Array(form.points), 3));
      indexed.setIndex(form.triangles);
      const geometry = indexed.toNonIndexed();  // its faces are flat
      geometry.computeVertexNormals();
      mesh = new THREE.Mesh(geometry, material(colour, {side: THREE.DoubleSide}));
    }
    mesh.position.set(form.pose[0], form.pose[1], form.pose[2]);
    mesh.quaternion.set(form.pose[3], form.pose[4], form.pose[5], form.pose[6]);
    return mesh;
  }

  function makeBody(part) {
    const group = new THREE.Group(), arms = part.at && part.at[0] !== 0 ? armsOf(part) : [];
    let most = Math.max(...part.box);
    // A link: what it joins is to be seen.
    const largest = (arms.length > 1 ? 0.12 : arms.length > 0 ? 0.25 : 1) * size;
    if (most > largest) {
      part.box = part.box.map(s => s * largest / most);
      most = largest;
      part.facts.push(['not to scale', 'drawn smaller, for all else to be seen']);
    }
    const glass = arms.length > 0 ? {transparent: true, opacity: 0.7} : {};
    const c = part.centre;
    for (const form of part.forms || []) group.add(formOf(form, part));
    if (!part.forms) group.add(ball(0.6 * unit, part.colour));
    if (part.forms) {
      // What is stated is seen as it is.
    } else if (most > 0.02 * unit) {
      const side = part.box.map(s => Math.min(Math.max(s, 0.04 * most, 0.4 * unit), 1.5 * size));
      const mesh = part.shape === 'box' ? box(side, part.colour, glass)
        : part.shape === 'sphere' ? ball(side[0] / 2, part.colour, glass)
        : cylinder(side[0] / 2, side[2], 'z', part.colour, glass, 40);
      mesh.position.set(c[0], c[1], c[2]);
      mesh.quaternion.set(c[3], c[4], c[5], c[6]);
      group.add(mesh);
    } else {
      const mesh = ball(1.5 * unit, part.colour);
      mesh.position.set(c[0], c[1], c[2]);
      group.add(mesh);
    }
    for (const end of part.forms ? [] : [[0, 0, 0], ...arms]) {
      const d = minus(end, c.slice(0, 3)), arm = norm(d);
      if (arm < unit) continue;
      const rod = cylinder(0.42 * unit, arm, 'y', part.colour);
      rod.quaternion.setFromUnitVectors(e2, new THREE.Vector3(...times(1 / arm, d)));
      rod.position.set(...add(c.slice(0, 3), times(0.5, d)));
      group.add(rod);
    }
    put(part, group, o => stand(o, poseOf(part)));
    part.anchor = () => {
      const h = poseOf(part);
      return add(h.r, turn(h.q, c.slice(0, 3)));
    };
  }

  const between = (object, a, b) => {  // a cylinder along y from a to b
    const d = minus(b, a), l = norm(d);
    object.visible = l > 1e-9 * size;
    if (!object.visible) return;
    object.position.set(...times(0.5, add(a, b)));
    object.quaternion.setFromUnitVectors(e2, way.set(...times(1 / l, d)));
    object.scale.y = l;
  };

  function makeJoint(part) {
    const kind = part.element, colour = part.colour, group = new THREE.Group(), unit = unitOf(part);
    const disc = (radius, length, axis) => {
      const mesh = cylinder(radius * unit, length * unit, axis, colour);
      group.add(mesh);
      return mesh;
    };
    const axis = (length, name) => disc(0.28, length, name);
    const block = (x, y, z) => group.add(box([x * unit, y * unit, z * unit], colour));
    const knob = radius => group.add(ball(radius * unit, colour));
    if (kind === 'revolute') disc(1, 2.2, 'z'), axis(6, 'z');
    else if (kind === 'cylindrical') disc(0.8, 3.4, 'z'), axis(8, 'z');
    else if (kind === 'screw') {
      disc(0.8, 2.2, 'z');
      for (const z of [-1.6, -0.8, 0, 0.8, 1.6]) disc(1.1, 0.25, 'z').position.z = z * unit;
      axis(8, 'z');
    } else if (kind === 'prismatic') block(1.6, 1.6, 3.2), axis(8, 'z');
    else if (kind === 'universal') axis(5, 'z'), axis(5, 'x'), knob(0.7);
    else if (kind === 'planar') disc(2.4, 0.3, 'z'), axis(4, 'z');
    else if (kind === 'point_on_line') axis(14, 'z'), knob(0.8);
    else if (kind === 'fixed') block(1.5, 1.5, 1.5);
    else knob(1.1);
    put(part, group, o => stand(o, place(part.b)));
    put(part, cylinder(0.3 * unit, 1, 'y', part.gap ? palette.gap : colour), o => between(o, place(part.a).r, place(part.b).r));
    if (part.gap) {
      const end = ball(0.9 * unit, palette.gap);
      end.renderOrder = 1;
      put(part, end, o => stand(o, place(part.a)));
    }
    part.anchor = () => place(part.b).r;
  }

  function makeSpring(part) {
    const turns = 9, points = [];
    const geometry = new THREE.BufferGeometry();
    const position = new Float32Array(3 * (turns * 8 + 3));
    geometry.setAttribute('position', new THREE.BufferAttribute(position, 3).setUsage(THREE.DynamicDrawUsage));
    const line = new THREE.Line(geometry, new THREE.LineBasicMaterial({color: part.colour}));
    line.frustumCulled = false;
    put(part, line, () => {
      const a = place(part.a).r, b = place(part.b).r, d = minus(b, a), l = norm(d);
      let u = l > 0 ? times(1 / l, d) : [0, 0, 1];
      const other = Math.abs(u[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
      let v = [u[1] * other[2] - u[2] * other[1], u[2] * other[0] - u[0] * other[2], u[0] * other[1] - u[1] * other[0]];
      v = times(1 / norm(v), v);
      const w = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const n = turns * 8 + 3;
      for (let i = 0; i < n; ++i) {
        const inside = i > 0 && i < n - 1, angle = 2 * Math.PI * i / 8, f = i / (n - 1);
        const radius = inside ? unit : 0;
        for (let j = 0; j < 3; ++j)
          position[3 * i + j] = a[j] + f * d[j] + radius * (Math.cos(angle) * v[j] + Math.sin(angle) * w[j]);
      }
      geometry.attributes.position.needsUpdate = true;
      geometry.boundingSphere = null;
    });
    const knob = o => put(part, ball(0.7 * unit, part.colour), m => stand(m, place(o)));
    knob(part.a);
    knob(part.b);
    part.anchor = () => times(0.5, add(place(part.a).r, place(part.b).r));
  }

  function arrowObject(colour, heads, length, radius, before) {  // before: all else
    const group = new THREE.Group(), more = before ? {depthTest: false, transparent: true, opacity: 0.9} : {};
    const shaft = cylinder(radius, length - 5 * radius, 'y', colour, more);
    shaft.position.y = -length / 2 - 2.5 * radius;
    group.add(shaft);
    if (before) shaft.renderOrder = 2;
    for (let i = 0; i < heads; ++i) {
      const head = solid(shape('head', () => new THREE.ConeBufferGeometry(2.8, 6, 16)), [radius, radius, radius], colour, more);
      head.position.y = -3 * radius - 5 * radius * i;
      if (before) head.renderOrder = 2;
      group.add(head);
    }
    return group;
  }

  function makeLoad(part) {
    for (const arrow of part.arrows) {
      if (norm(arrow.along) === 0) continue;
      const along_beam = arrow.beam !== undefined;
      const object = arrowObject(arrow.moment ? palette.moment : palette.load, arrow.moment ? 2 : 1,
        (along_beam ? 0.06 : 0.12) * size, (along_beam ? 0.2 : 0.3) * unit, true);
      const where = () => {
        const h = along_beam ? onBeam(arrow.beam, arrow.s) : poseOf(part);
        return {r: along_beam ? h.r : add(h.r, turn(h.q, part.offset)), q: h.q};
      };
      put(part, object, o => {
        const h = where();
        const d = arrow.follows ? turn(h.q, arrow.along) : arrow.along, l = (along_beam ? 0.06 : 0.12) * size;
        o.position.set(...add(h.r, times(l, d)));  // it begins where the load acts
        o.quaternion.setFromUnitVectors(e2, way.set(...d));
      });
      part.anchor = () => {
        const h = where(), d = arrow.follows ? turn(h.q, arrow.along) : arrow.along;
        return add(h.r, times((along_beam ? 0.04 : 0.08) * size, d));
      };
    }
  }

  function makeMark(part) {
    const unit = unitOf(part);
    const equally = s => [s, s, s];
    const mesh = part.kind === 'record' ? solid(shape('octahedron', () => new THREE.OctahedronBufferGeometry(1)), equally(0.95 * unit), part.colour)
      : part.kind === 'mass' ? ball(1.2 * unit, part.colour)
      : solid(shape('torus', () => new THREE.TorusBufferGeometry(1.6, 0.25, 8, 24)), equally(unit), part.colour);
    const where = () => {
      const h = poseOf(part);
      return part.offset ? {r: add(h.r, turn(h.q, part.offset)), q: h.q} : h;
    };
    put(part, mesh, o => stand(o, where()));
    part.anchor = () => where().r;
  }

  // ---- the ground -------------------------------------------------------------------------------------------------
  const ground = new THREE.Group();
  function letter(word, colour) {
    const c = document.createElement('canvas');
    c.width = c.height = 64;
    const g = c.getContext('2d');
    g.font = 'bold 46px sans-serif';
    g.textAlign = 'center';
    g.textBaseline = 'middle';
    g.fillStyle = colour;
    g.fillText(word, 32, 34);
    const sprite = new THREE.Sprite(new THREE.SpriteMaterial({map: new THREE.CanvasTexture(c), depthTest: false, transparent: true}));
    sprite.scale.set(3.2 * unit, 3.2 * unit, 1);
    return sprite;
  }
  function makeGround(low, high) {
    const spread = Math.max(high[0] - low[0], high[1] - low[1], high[2] - low[2], 0.5 * size);
    const step = Math.pow(10, Math.floor(Math.log10(spread / 3)));
    const cell = spread / step > 12 ? 2 * step : step;
    const n = 2 * Math.ceil(0.65 * spread / cell) + 2;
    const grid = new THREE.GridHelper(n * cell, n, 0x808a96, 0x808a96);
    grid.material.transparent = true;
    grid.material.opacity = 0.28;
    grid.material.depthWrite = false;
    const axis = up.findIndex(c => c !== 0);
    grid.quaternion.setFromUnitVectors(e2, new THREE.Vector3(...up));
    const middle = [0, 1, 2].map(i => 0.5 * (low[i] + high[i]));
    // Lines at whole numbers of cells of the inertial axes.
    const at = middle.map((c, i) => Math.round((c + centre[i]) / cell) * cell - centre[i]);
    at[axis] = (up[axis] > 0 ? low[axis] : high[axis]) - up[axis] * 0.02 * spread;
    if (Math.abs(at[axis] + centre[axis]) < 0.1 * spread) at[axis] = -centre[axis] - up[axis] * 0.004 * spread;
    grid.position.set(...at);
    ground.add(grid);
    by('grid').parentElement.title = 'cells of ' + short(cell) + ' m';
    const origin = times(-1, centre), length = 0.12 * size;
    if (norm(origin) < 3 * size)
      [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((direction, i) => {
        const colour = [0xd0342c, 0x2f9e44, 0x2b6fd6][i];
        const arrow = arrowObject(colour, 1, length, 0.16 * unit);
        arrow.position.set(...add(origin, times(length, direction)));
        arrow.quaternion.setFromUnitVectors(e2, new THREE.Vector3(...direction));
        ground.add(arrow);
        const word = letter(String(i + 1), '#' + colour.toString(16).padStart(6, '0'));
        word.position.set(...add(origin, times(length + 2.2 * unit, direction)));
        ground.add(word);
      });
    world.add(ground);
  }

  // ---- colours ----------------------------------------------------------------------------------------------------
  // Dark blue over green to yellow, even in lightness.
  const stops = [[0.17, 0.12, 0.42], [0.19, 0.33, 0.60], [0.13, 0.51, 0.60], [0.22, 0.66, 0.48], [0.55, 0.79, 0.31], [0.97, 0.89, 0.20]];
  let low = 0, high = 1;
  function shade(value, into) {
    const u = Math.min(1, Math.max(0, high > low ? (value - low) / (high - low) : 0)) * (stops.length - 1);
    const i = Math.min(stops.length - 2, Math.floor(u)), f = u - i, a = stops[i], b = stops[i + 1];
    for (let k = 0; k < 3; ++k) into[k] = a[k] + f * (b[k] - a[k]);
    return into;
  }
  // Linear between values at s; both s and `fine` rise.
  function spread(s, values, fine, into) {
    const last = s.length - 1;
    for (let k = 0, i = 1; k < fine.length; ++k) {
      const x = fine[k];
      while (i < last && x > s[i]) ++i;
      into[k] = x <= s[0] || last === 0 ? values[0] : x >= s[last] ? values[last]
        : values[i - 1] + (values[i] - values[i - 1]) * (x - s[i - 1]) / (s[i] - s[i - 1] || 1);
    }
    return into;
  }
  let first = 0;  // of resultants
  for (const p of parts) if (p.kind === 'beam') { p.firstStation = first; if (p.stations) first += p.stations.length; }
  const speedAt = (f, at) => {
    if (at[0] === 0) return 0;
    const o = offset(f) + motion.pose + 6 * (at[0] - 1), x = at.slice(1, 4);
    const v = [0, 1, 2].map(k => numbers[o + k]), w = [3, 4, 5].map(k => numbers[o + k]);
    return norm(add(v, [w[1] * x[2] - w[2] * x[1], w[2] * x[0] - w[0] * x[2], w[0] * x[1] - w[1] * x[0]]));
  };
  // At the stations: how(r, i, o) of the six numbers of station i in r, from o on.
  const atStations = [];
  function resultant(f, part, how) {
    for (let i = 0; i < part.stations.length; ++i)
      atStations[i] = how(numbers, i, offset(f) + motion.pose + motion.twist + 6 * (part.firstStation + i));
    return atStations;
  }
  const ofBeams = how => ({beams: true, of: (part, f) => part.stations && part.stations.length
    ? spread(part.stations, resultant(f, part, how), part.fine, part.shown) : null});
  const quantities = {'': null};
  quantities.displacement = {label: 'displacement', unit: 'm', exact: true};  // of the curve that is drawn
  if (motion && motion.twist)
    quantities.velocity = {label: 'velocity', unit: 'm/s', of: (part, f) =>
      spread(part.s, part.points.map(at => speedAt(f, at)), part.fine, part.shown)};
  if (motion && motion.resultant) {
    quantities.N = {label: 'axial force N', unit: 'N', ...ofBeams((r, i, o) => r[o])};
    quantities.Q = {label: 'shear force |Q|', unit: 'N', ...ofBeams((r, i, o) => Math.sqrt(r[o + 1] * r[o + 1] + r[o + 2] * r[o + 2]))};
    quantities.T = {label: 'torque M1', unit: 'N.m', ...ofBeams((r, i, o) => r[o + 3])};
    quantities.M = {label: 'bending moment |M|', unit: 'N.m', ...ofBeams((r, i, o) => Math.sqrt(r[o + 4] * r[o + 4] + r[o + 5] * r[o + 5]))};
  }
  // Half of S C S at a station, of compliances that are upper halves by rows.
  const energyOf = (half, r, o) => {
    let sum = 0;
    for (let i = 0, k = 0; i < 6; ++i) for (let j = i; j < 6; ++j) sum += (i === j ? 0.5 : 1) * half[k++] * r[o + i] * r[o + j];
    return sum;
  };
  if (motion && motion.resultant && parts.some(p => p.compliance && !p.run))
    quantities.energy = {label: 'strain energy per length', unit: 'J/m', beams: true, of: (part, f) => {
      if (!part.compliance || !part.stations || !part.stations.length) return null;
      const one = part.compliance.length === 1;
      return spread(part.stations, resultant(f, part, (r, i, o) => energyOf(part.compliance[one ? 0 : i], r, o)), part.fine, part.shown);
    }};
  // Stresses on the surface: how(S, data, o), S the six resultants at a point of the curve, o where what is known of a
  // point of the outline begins. End faces have none.
  const onSurface = (key, per, how) => {
    const of = part => {
      const outline = part.outline && !part.run ? D.outlines[part.outline] : null;
      return outline && outline[key] && part.stations && part.stations.length ? outline[key] : null;
    };
    return {beams: true, of, count: part => D.outlines[part.outline].next.length, at: (part, f) => {
      const data = of(part), lines = [];
      part.six = part.six || Array.from({length: 6}, () => new Float64Array(part.fine.length));
      for (let c = 0; c < 6; ++c) lines.push(spread(part.stations, resultant(f, part, (r, i, o) => r[o + c]), part.fine, part.six[c]));
      return (k, i) => how(lines, k, data, per * i);
    }};
  };
  if (motion && motion.resultant && D.outlines) {
    const known = Object.values(D.outlines);
    if (known.some(o => o.von_mises))
      quantities.von_mises = {label: 'von Mises stress', unit: 'Pa', surface: onSurface('von_mises', 21, (S, k, A, o) => {
        let sum = 0;
        for (let i = 0; i < 6; ++i) for (let j = i; j < 6; ++j) sum += (i === j ? 1 : 2) * A[o++] * S[i][k] * S[j][k];
        return Math.sqrt(Math.max(0, sum));
      })};
    if (known.some(o => o.fibres))
      quantities.fibres = {label: 'stress along fibres', unit: 'Pa', surface: onSurface('fibres', 6, (S, k, b, o) => {
        let sum = 0;
        for (let i = 0; i < 6; ++i) sum += b[o + i] * S[i][k];
        return sum;
      })};
  }
  const scratchP = refP.slice(), scratchQ = refQ.slice();
  function displaced(line, part, by = 1) {  // of the curve that is drawn
    for (let k = 0; k < part.shown.length; ++k) {
      const r = line.r[k], from = part.reference[k], x = r[0] - from[0], y = r[1] - from[1], z = r[2] - from[2];
      part.shown[k] = Math.sqrt(x * x + y * y + z * z) / by;
    }
    return part.shown;
  }
  // The range of a quantity over some frames.
  function range(quantity, some) {
    low = Infinity, high = -Infinity;
    for (const f of some) {
      if (quantity.exact) load(f, 0, scratchP, scratchQ);
      for (const p of parts) {
        if (p.kind !== 'beam' || p.run) continue;
        if (quantity.surface) {
          if (!quantity.surface.of(p)) continue;
          const at = quantity.surface.at(p, f), around = quantity.surface.count(p);
          for (let k = 0; k < p.fine.length; ++k)
            for (let i = 0; i < around; ++i) {
              const v = at(k, i);
              low = Math.min(low, v), high = Math.max(high, v);
            }
          continue;
        }
        const values = quantity.exact
          ? displaced(centreLine(p, scratchP, scratchQ, p.scratch), p) : quantity.of(p, f);
        for (const v of values || []) low = Math.min(low, v), high = Math.max(high, v);
      }
    }
    if (!(high >= low)) low = high = 0;
    if (Math.abs(low) < 1e-9 * Math.abs(high)) low = 0;
    by('legend-low').textContent = short(low);
    by('legend-high').textContent = short(high);
  }
  let coloured = null;
  function colourBy(name) {
    const quantity = coloured = quantities[name];
    by('legend').hidden = by('now-label').hidden = !quantity;
    for (const p of parts) p.values = p.over = null;
    if (quantity) {
      const some = [];  // of the run
      let every = Math.max(1, Math.floor(frames / 120));
      if (quantity.surface) {  // no more points than some seconds have room for
        const points = sum(parts.filter(p => p.kind === 'beam' && quantity.surface.of(p)), p => p.fine.length * quantity.surface.count(p));
        every = Math.max(every, Math.ceil(frames * points / 5e6));
      }
      for (let f = 0; f < frames; f += every) some.push(f);
      range(quantity, [...some, frames - 1]);
      for (const p of parts)
        if (p.kind === 'beam' && quantity.surface) p.over = quantity.surface.of(p) ? () => quantity.surface.at(p, frame) : null;
        else if (p.kind === 'beam' && !p.run && !(quantity.beams && !(p.stations && p.stations.length)))
          p.values = line => quantity.exact
            ? displaced(line, p, scale || 1) : quantity.of(p, frame);
      by('legend-title').textContent = quantity.label + ' [' + quantity.unit + ']';
      by('legend-bar').style.background = 'linear-gradient(to right,' + stops.map(c => 'rgb(' + c.map(x => Math.round(255 * x)).join(',') + ')').join(',') + ')';
    }
    by('colour').value = name;
    redraw();
  }
  const short = x => {
    if (!Number.isFinite(x)) return '';
    const y = Number(x.toPrecision(4)), l = Math.abs(y);
    return l !== 0 && (l < 1e-3 || l >= 1e6) ? y.toExponential().replace('e+', 'e') : String(y);
  };
  const length = x => short(Math.abs(x) < 2e-7 * size ? 0 : x);  // what single precision knows of it

  // ---- what is drawn ----------------------------------------------------------------------------------------------
  let chosen = null;
  for (const part of parts) {
    if (part.kind === 'beam') makeBeam(part);
  }
  joinSurfaces();
  for (const {part} of surfaces) part.sweep();
  for (const part of parts) {
    if (part.kind === 'body') makeBody(part);
    else if (part.kind === 'joint') makeJoint(part);
    else if (part.kind === 'spring') makeSpring(part);
    else if (part.kind === 'load') makeLoad(part);
    else if (part.kind === 'mass' || part.kind === 'motion' || part.kind === 'record') makeMark(part);
  }

  // Reactions of joints: arrows in proportion, to those that 3 % of the run exceed (no longer than twice that).
  const reactions = [];
  if (motion && motion.joint) {
    const of = (f, j) => {
      const o = offset(f) + motion.pose + motion.twist + motion.resultant + 7 * j;
      return [numbers[o + 1], numbers[o + 2], numbers[o + 3]];
    };
    const sizes = [], every = Math.max(1, Math.floor(frames * D.joints.length / 50000));
    for (let f = 0; f < frames; f += every) D.joints.forEach((name, j) => sizes.push(norm(of(f, j))));
    sizes.sort((a, b) => a - b);
    const most = sizes.length ? sizes[Math.floor(0.97 * (sizes.length - 1))] || sizes[sizes.length - 1] : 0;
    D.joints.forEach((name, j) => {
      const part = parts.find(p => p.kind === 'joint' && p.name === name);
      if (!part || part.run || !(most > 0)) return;
      const object = arrowObject(palette.reaction, 1, 0.15 * size, 0.22 * unit, true);
      object.traverse(o => { o.userData.part = part.index; });
      inWorld(object);
      reactions.push(() => {
        const h = place(part.b), force = turn(h.q, of(frame, j)), l = norm(force);
        object.visible = by('reactions').checked && part.visible && l > 1e-6 * most;
        if (!object.visible) return;
        const d = times(1 / l, force), drawn = Math.min(2, l / most);
        object.position.set(...add(h.r, times(0.15 * size * drawn, d)));
        object.quaternion.setFromUnitVectors(e2, way.set(...d));
        object.scale.set(1, drawn, 1);
      });
    });
  }
  if (reactions.length === 0) by('reactions-label').hidden = true;
  makeBatches();

  // Trails of what is recorded at places, and of bodies.
  const trails = [], runShown = [true, true];
  function makeTrails() {
    if (trails.length || frames < 2) return;
    const traced = parts.filter(p => p.kind === 'record' && p.at || p.kind === 'body' && p.at);
    const every = Math.max(1, Math.ceil(frames * traced.length / 200000));
    const lines = traced.map(part => ({part, points: []}));
    for (let f = 0; f < frames; f += every) {
      load(f, 0, scratchP, scratchQ);
      for (const l of lines) l.points.push(new THREE.Vector3(...placeIn(scratchP, scratchQ, l.part.at).r));
    }
    for (const l of lines) {
      const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(l.points), new THREE.LineBasicMaterial({color: l.part.colour}));
      line.frustumCulled = false;
      world.add(line);
      trails.push({line, part: l.part, every});
    }
  }

  // ---- views ------------------------------------------------------------------------------------------------------
  const boxLow = [Infinity, Infinity, Infinity], boxHigh = [-Infinity, -Infinity, -Infinity];
  function include(r) {
    for (let i = 0; i < 3; ++i) boxLow[i] = Math.min(boxLow[i], r[i]), boxHigh[i] = Math.max(boxHigh[i], r[i]);
  }
  const everyFit = Math.max(1, Math.floor(frames / 60));
  for (let f = 0; f < frames; f += everyFit) {
    load(f, 0, scratchP, scratchQ);
    for (const p of parts) {
      if (p.points) p.points.forEach(at => include(placeIn(scratchP, scratchQ, at).r));
      for (const at of [p.at, p.a, p.b])
        if (at) {
          const r = placeIn(scratchP, scratchQ, at).r, half = p.kind === 'body' ? Math.max(0.5 * Math.max(...p.box), p.reach || 0) : 0;
          include(r.map(c => c - half));
          include(r.map(c => c + half));
        }
    }
  }
  if (!(boxLow[0] <= boxHigh[0])) include([0, 0, 0]);
  makeGround(boxLow, boxHigh);
  function fit(direction) {
    const middle = [0, 1, 2].map(i => 0.5 * (boxLow[i] + boxHigh[i]));
    const aspect = canvas.clientWidth / Math.max(1, canvas.clientHeight);
    const tall = Math.tan(camera.fov * Math.PI / 360), wide = tall * aspect;
    const d = direction || minus(camera.position.toArray(), controls.target.toArray());
    const l = norm(d) || 1;
    // As near as all corners of the box allow.
    const back = new THREE.Vector3(...d).normalize();
    const right = new THREE.Vector3().crossVectors(camera.up, back).normalize(), above = new THREE.Vector3().crossVectors(back, right);
    let distance = 0.3 * size;
    for (let i = 0; i < 8; ++i) {
      const v = new THREE.Vector3(...[1, 2, 4].map((bit, k) => ((i & bit ? 1 : -1) * 0.5 * (boxHigh[k] - boxLow[k]))));
      const x = Math.abs(v.dot(right)) + 5 * unit, y = Math.abs(v.dot(above)) + 5 * unit;
      distance = Math.max(distance, v.dot(back) + 1.06 * Math.max(x / wide, y / tall));
    }
    controls.target.set(...middle);
    camera.position.set(...add(middle, times(distance / l, d)));
    camera.near = distance / 500;
    camera.far = distance * 100;
    camera.updateProjectionMatrix();
    controls.update();
    draw();
  }
  const views = {iso: null, x: [1, 0, 0], y: [0, -1, 0], z: [0, 0, 1]};
  {
    // From above a corner, whatever is up.
    const axis = up.findIndex(c => c !== 0);
    views.iso = [0.55, 0.55, 0.55];
    views.iso[(axis + 1) % 3] = axis === 2 ? 0.6 : 0.75;
    views.iso[(axis + 2) % 3] = axis === 2 ? -1 : 0.9;
    views.iso[axis] = 0.5 * up[axis];
    if (axis !== 2) views.y = [0, 1, 0];
    for (const name of ['x', 'y', 'z'])  // not exactly along what is up
      if (Math.abs(views[name][axis]) === 1) views[name] = views[name].map((c, i) => i === (axis + 2) % 3 ? -0.001 : c);
  }
  // What is flat is looked at from its front.
  function firstView() {
    const sides = [0, 1, 2].map(i => boxHigh[i] - boxLow[i]), most = Math.max(...sides);
    const flat = sides.map((s, i) => [s, i]).filter(([s]) => s < 0.02 * most).map(([, i]) => i);
    if (flat.length !== 1) return views.iso;
    const d = views[['x', 'y', 'z'][flat[0]]].slice();
    const axis = up.findIndex(c => c !== 0);
    if (flat[0] === axis) {  // from above, axis 1 to the right where axis 3 is up
      const above = [0, 0, 0];
      above[axis] = up[axis];
      above[axis === 2 ? 1 : (axis + 2) % 3] = axis === 2 ? -0.35 : 0.35;
      return above;
    }
    for (let i = 0; i < 3; ++i) if (i !== flat[0]) d[i] += i === axis ? 0.3 * up[axis] : 0.25;
    return d;
  }

  function draw() {
    if (renderer) renderer.render(scene, camera);
  }
  controls.addEventListener('change', draw);
  let looked = false;  // the user has turned or moved it
  controls.addEventListener('start', () => { looked = true; });
  function resize() {
    const w = by('stage').clientWidth, h = by('stage').clientHeight;
    if (!renderer || !w || !h) return;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    renderer.setSize(w, h, false);
    camera.aspect = w / h;
    camera.updateProjectionMatrix();
    draw();
  }

  function redraw() {
    exaggerate();
    if (coloured && by('now').checked) range(coloured, [frame]);
    for (const part of parts) if (part.kind === 'beam') part.sweep();
    for (const part of parts)
      if (part.kind !== 'beam' && part.visible) for (const update of part.update) update();
    for (const update of reactions) update();
    ghosts.visible = by('ghost').checked;
    if (stale) showSurfaces();
    fillBatches();
    for (const t of trails) {
      t.line.visible = by('trails').checked && (!t.part.run || runShown[1]) && (t.part.run || runShown[0]);
      t.line.geometry.setDrawRange(0, Math.floor(frame / t.every) + 1);
    }
    ground.visible = by('grid').checked;
    draw();
    const name = isTime ? 't = ' : 'load factor ';
    by('clock').textContent = motion ? name + Number(shownKey.toPrecision(6)) + (isTime ? ' s' : '') : '';
    by('scrub').value = frame;
    for (const plot of plots) plot.cursor();
    if (chosen) details(chosen);
  }
  function setFrame(k) {
    frame = Math.min(frames - 1, Math.max(0, Math.round(k)));
    shownKey = keys[frame];
    load(frame, 0, exactP, exactQ);
    redraw();
  }

  // ---- parts by name ----------------------------------------------------------------------------------------------
  const element = (tag, more, ...children) => {
    const e = Object.assign(document.createElement(tag), more);
    e.append(...children);
    return e;
  };
  const titles = {beam: 'Beams', body: 'Bodies', joint: 'Joints', spring: 'Springs', load: 'Loads', mass: 'Point masses',
    motion: 'Prescribed motions', record: 'Records', gravity: 'Gravity'};
  const label = part => part.name || part.element + ', line ' + part.line;
  function setVisible(part, visible) {
    part.visible = visible;
    for (const o of part.objects) o.visible = visible;
    stale = true;
    if (part.checkbox) part.checkbox.checked = visible;
  }
  for (const kind of Object.keys(titles)) {
    const those = parts.filter(p => p.kind === kind);
    if (!those.length) continue;
    const all = element('input', {type: 'checkbox', checked: kind !== 'record'});
    all.addEventListener('change', () => {
      for (const p of those) setVisible(p, all.checked);
      redraw();
    });
    by('parts').append(element('div', {className: 'kind'}, element('label', {}, all, titles[kind] + ' (' + those.length + ')')));
    const most = 200;
    for (const part of those.slice(0, most)) {
      part.checkbox = element('input', {type: 'checkbox', checked: true, ariaLabel: 'show ' + label(part)});
      part.checkbox.addEventListener('change', () => {
        setVisible(part, part.checkbox.checked);
        redraw();
      });
      part.button = element('button', {type: 'button', textContent: label(part)});
      part.button.setAttribute('aria-pressed', 'false');
      part.button.addEventListener('click', () => choose(part));
      by('parts').append(element('div', {className: 'row'}, part.checkbox, part.button));
    }
    if (those.length > most)
      by('parts').append(element('p', {className: 'hint', textContent: 'and ' + (those.length - most) + ' more'}));
    if (kind === 'record') for (const p of those) setVisible(p, false);
  }

  // Two runs: which is which, and either alone.
  if (D.runs) {
    D.runs.forEach((name, run) => {
      const shown = element('input', {type: 'checkbox', checked: true, ariaLabel: 'show ' + name});
      const swatch = element('span', {className: 'swatch'});
      swatch.style.background = '#' + (run ? palette.second : palette.beam).toString(16).padStart(6, '0');
      if (run) swatch.style.opacity = 0.6;
      shown.addEventListener('change', () => {
        runShown[run] = shown.checked;
        for (const p of parts) if ((p.run || 0) === run && p.kind !== 'record') setVisible(p, shown.checked);
        redraw();
      });
      by('runs').append(element('label', {}, shown, swatch, name));
    });
    by('runs').hidden = false;
  }

  function numbersNow(part) {
    const rows = [];
    const vector = v => '(' + v.map(short).join(', ') + ')', point = v => '(' + v.map(length).join(', ') + ')';
    if (part.at || part.b || part.on) {
      const h = part.at ? placeIn(exactP, exactQ, part.at) : part.b ? placeIn(exactP, exactQ, part.b) : null;
      if (h) rows.push(['position [m]', point(add(h.r, centre))]);
    } else if (part.points) {
      for (const [name, at] of [['start [m]', part.points[0]], ['end [m]', part.points[part.points.length - 1]]])
        rows.push([name, point(add(placeIn(exactP, exactQ, at).r, centre))]);
    }
    const j = part.kind === 'joint' && motion && motion.joint ? D.joints.indexOf(part.name) : -1;
    if (j >= 0) {
      const o = offset(frame) + motion.pose + motion.twist + motion.resultant + 7 * j, r = numbers.subarray(o, o + 7);
      rows.push(['angle [rad]', short(r[0])], ['force on b [N]', vector([...r.slice(1, 4)])], ['moment on b [N.m]', vector([...r.slice(4, 7)])]);
    }
    return rows;
  }
  function details(part) {
    const all = [];
    for (const [what, value] of [...part.facts, ...(motion || part.kind !== 'gravity' ? numbersNow(part) : [])])
      all.push(element('dt', {textContent: what}), element('dd', {textContent: value}));
    by('details').replaceChildren(
      element('h2', {textContent: part.element + (part.name && part.name !== part.element ? ' ' + part.name : '')}),
      element('dl', {}, ...all),
      element('div', {textContent: part.file ? part.file + ':' + part.line : ''}),
      ...(part.stated ? [element('pre', {textContent: part.stated})] : []));
  }
  function choose(part) {
    if (chosen && chosen.button) chosen.button.setAttribute('aria-pressed', 'false');
    if (chosen) paint(chosen, false);
    chosen = part;
    if (part) {
      paint(part, true);
      if (part.button) part.button.setAttribute('aria-pressed', 'true');
      by('part').open = true;
    } else {
      by('details').replaceChildren(element('p', {className: 'hint', textContent: 'Click on a part, here or in the picture.'}));
    }
    redraw();
  }
  function paint(part, on) {
    for (const o of part.objects)
      o.traverse(m => {
        if (!m.material || m.material.vertexColors || !m.material.color) return;
        if (m.userData.plain === undefined) m.userData.plain = m.material.color.getHex();
        m.material.color.setHex(on ? palette.chosen : m.userData.plain);
      });
  }

  // ---- clicks -----------------------------------------------------------------------------------------------------
  const ray = new THREE.Raycaster();
  function partAt(x, y) {  // of the window
    const r = canvas.getBoundingClientRect();
    scene.updateMatrixWorld();
    ray.setFromCamera(new THREE.Vector2((x - r.left) / r.width * 2 - 1, 1 - (y - r.top) / r.height * 2), camera);
    ray.params.Line = {threshold: unit};
    const shown = [];
    for (const p of parts) if (p.visible) for (const o of p.objects) if (o.visible) shown.push(o);
    const hits = ray.intersectObjects(shown, true);
    return hits.length ? parts[hits[0].object.userData.part] : null;
  }
  let down = null;
  canvas.addEventListener('pointerdown', e => { down = [e.clientX, e.clientY]; });
  canvas.addEventListener('click', e => {
    if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 5) return;  // it was a drag
    choose(partAt(e.clientX, e.clientY));
  });

  // ---- time -------------------------------------------------------------------------------------------------------
  let playing = false, before = 0, at = 0;  // at: of what is played, the key or (of load steps) the frame
  const span = isTime ? keys[frames - 1] - keys[0] : frames - 1;
  const speeds = isTime ? [1e-4, 1e-3, 0.01, 0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10, 100, 1000] : [1, 2, 5, 10, 20, 50, 100];
  const wanted = isTime ? (span >= 2 && span <= 40 ? 1 : span / 8) : frames / 5;
  const speed0 = speeds.reduce((best, s) => Math.abs(Math.log(s / wanted)) < Math.abs(Math.log(best / wanted)) ? s : best);
  for (const s of speeds)
    by('speed').append(element('option', {value: s, textContent: isTime ? '× ' + s : s + ' steps/s', selected: s === speed0}));
  const keyAt = () => isTime ? shownKey : frame;
  function play(on) {
    playing = on && frames > 1;
    by('play').textContent = playing ? '❚❚' : '▶';
    if (!playing) return;
    if (frame === frames - 1) setFrame(0);
    at = keyAt();
    before = performance.now();
    requestAnimationFrame(tick);
  }
  function tick(now) {
    if (!playing) return;
    at += (now - before) / 1000 * Number(by('speed').value);
    before = now;
    const end = isTime ? keys[frames - 1] : frames - 1, start = isTime ? keys[0] : 0;
    if (at >= end) {
      if (!by('loop').checked || !(end > start)) {
        setFrame(frames - 1);
        play(false);
        return;
      }
      at = start + (at - end) % (end - start);
    }
    let k;
    if (isTime) {
      let a = 0, b = frames - 1;
      while (b - a > 1) {
        const m = (a + b) >> 1;
        if (keys[m] <= at) a = m; else b = m;
      }
      k = a;
    } else k = Math.floor(at);
    const u = isTime ? (at - keys[k]) / (keys[k + 1] - keys[k]) : at - k;
    frame = k;
    shownKey = keys[k] + Math.min(1, Math.max(0, u)) * (keys[Math.min(k + 1, frames - 1)] - keys[k]);
    load(k, k + 1 < frames ? Math.min(1, Math.max(0, u)) : 0, exactP, exactQ);
    redraw();
    requestAnimationFrame(tick);
  }
  by('scrub').max = frames - 1;
  by('scrub').addEventListener('input', () => { play(false); setFrame(Number(by('scrub').value)); });
  by('play').addEventListener('click', () => play(!playing));
  by('first').addEventListener('click', () => { play(false); setFrame(0); });
  by('back').addEventListener('click', () => { play(false); setFrame(frame - 1); });
  by('next').addEventListener('click', () => { play(false); setFrame(frame + 1); });
  by('speed').addEventListener('change', () => { before = performance.now(); });
  document.addEventListener('keydown', e => {
    if (/^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName) && e.target.type !== 'checkbox') return;
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const act = {' ': () => { if (e.target.tagName === 'BUTTON' || e.target.tagName === 'SUMMARY') return false; play(!playing); },
      ArrowRight: () => { play(false); setFrame(frame + 1); }, ArrowLeft: () => { play(false); setFrame(frame - 1); },
      Home: () => { play(false); setFrame(0); }, End: () => { play(false); setFrame(frames - 1); },
      f: () => fit(), 0: () => fit(views.iso), 1: () => fit(views.x), 2: () => fit(views.y), 3: () => fit(views.z)}[e.key];
    if (act && act() !== false) e.preventDefault();
  });
  if (frames < 2) by('transport').hidden = true, by('transport').style.display = 'none';
  for (const b of by('views').children)
    b.addEventListener('click', () => fit(b.dataset.view === 'fit' ? null : views[b.dataset.view]));

  // ---- curves -----------------------------------------------------------------------------------------------------
  const plots = [];
  const inks = ['#2b7bd0', '#d55e00', '#1d9a6c', '#b04fa0', '#b8860b', '#5aa9d6'];
  const quantityOf = name => name.replace(/\.\d+$/, '');
  const groups = [];
  if (H) {
    H.columns.forEach((c, i) => {
      if (i === 0) return;
      const name = quantityOf(c.name);
      const group = groups.find(g => g.name === name) || groups[groups.push({name, columns: []}) - 1];
      group.columns.push(i);
    });
    const data = decode(H.values), rows = H.rows;
    H.column = i => data.subarray(i * rows, (i + 1) * rows);
    if (H.second) {
      const other = decode(H.second.values), n = H.second.rows;
      H.other = name => {  // a column of the second run; null where it has none
        const i = name === null ? 0 : H.second.columns.findIndex(c => c.name === name);
        return i < 0 ? null : other.subarray(i * n, (i + 1) * n);
      };
    }
  }
  function addPlot(which) {
    const select = element('select', {ariaLabel: 'quantity'}), pad = element('canvas', {}), key = element('div', {className: 'key'});
    groups.forEach((g, i) => select.append(element('option', {value: i, textContent: g.name, selected: i === which})));
    const gone = element('button', {type: 'button', textContent: '×', title: 'without this curve'});
    const root = element('div', {className: 'plot'}, element('div', {className: 'line'}, select, gone), pad, key);
    by('plots').append(root);
    const x = H.column(0), m = {left: 52, right: 8, top: 8, bottom: 20};
    let picture = null, xs, toX, scaleY, group;
    function paintPlot() {
      group = groups[Number(select.value)];
      const w = pad.clientWidth, h = pad.clientHeight, ratio = window.devicePixelRatio || 1;
      if (!w || !h) return;
      pad.width = w * ratio, pad.height = h * ratio;
      const g = pad.getContext('2d');
      g.setTransform(ratio, 0, 0, ratio, 0, 0);
      g.clearRect(0, 0, w, h);
      const style = getComputedStyle(document.documentElement);
      let lo = Infinity, hi = -Infinity;
      const others = group.columns.map(c => H.second ? H.other(H.columns[c].name) : null);
      for (const y of [...group.columns.map(c => H.column(c)), ...others.filter(y => y)])
        for (const v of y) lo = Math.min(lo, v), hi = Math.max(hi, v);
      if (!(hi > lo)) { const d = Math.abs(hi) * 0.1 || 1; lo -= d; hi += d; }
      let x0 = Infinity, x1 = -Infinity;
      const x2 = H.second ? H.other(null) : [];
      for (const v of [...x, ...x2]) x0 = Math.min(x0, v), x1 = Math.max(x1, v);
      if (!(x1 > x0)) x1 = x0 + 1;
      toX = v => m.left + (v - x0) / (x1 - x0) * (w - m.left - m.right);
      xs = px => x0 + (px - m.left) / (w - m.left - m.right) * (x1 - x0);
      scaleY = v => h - m.bottom - (v - lo) / (hi - lo) * (h - m.top - m.bottom);
      g.strokeStyle = style.getPropertyValue('--edge');
      g.fillStyle = style.getPropertyValue('--faint');
      g.font = '11px system-ui, sans-serif';
      const ticks = (a, b, n) => {
        const raw = (b - a) / n, p = Math.pow(10, Math.floor(Math.log10(raw)));
        const step = [1, 2, 5, 10].map(f => f * p).find(s => s >= raw);
        const all = [];
        for (let t = Math.ceil(a / step) * step; t <= b + 1e-9 * (b - a); t += step) all.push(Math.abs(t) < 1e-9 * step ? 0 : t);
        return all;
      };
      g.textAlign = 'right';
      g.textBaseline = 'middle';
      for (const t of ticks(lo, hi, 4)) {
        g.beginPath(), g.moveTo(m.left, scaleY(t)), g.lineTo(w - m.right, scaleY(t)), g.stroke();
        g.fillText(short(t), m.left - 5, scaleY(t));
      }
      g.textAlign = 'center';
      g.textBaseline = 'top';
      for (const t of ticks(x0, x1, 4)) g.fillText(short(t), Math.min(w - 16, toX(t)), h - m.bottom + 5);
      group.columns.forEach((c, i) => {
        const y = H.column(c);
        g.strokeStyle = inks[i % inks.length];
        g.lineWidth = 1.4;
        g.beginPath();
        for (let k = 0; k < x.length; ++k) k ? g.lineTo(toX(x[k]), scaleY(y[k])) : g.moveTo(toX(x[k]), scaleY(y[k]));
        g.stroke();
        if (!others[i]) return;
        g.globalAlpha = 0.6;
        g.setLineDash([5, 4]);
        g.beginPath();
        for (let k = 0; k < x2.length; ++k)
          k ? g.lineTo(toX(x2[k]), scaleY(others[i][k])) : g.moveTo(toX(x2[k]), scaleY(others[i][k]));
        g.stroke();
        g.setLineDash([]);
        g.globalAlpha = 1;
      });
      g.lineWidth = 1;
      picture = g.getImageData(0, 0, pad.width, pad.height);
      cursor();
    }
    function cursor() {
      if (!picture) return;
      const g = pad.getContext('2d'), style = getComputedStyle(document.documentElement);
      g.putImageData(picture, 0, 0);
      let k = rowNow();
      g.strokeStyle = style.getPropertyValue('--ink');
      g.beginPath(), g.moveTo(toX(shownKey), m.top), g.lineTo(toX(shownKey), pad.clientHeight - m.bottom), g.stroke();
      key.replaceChildren(...group.columns.map((c, i) => {
        const column = H.columns[c], e = element('span', {textContent:
          column.name.slice(group.name.length).replace('.', '') + ' ' + short(H.column(c)[k]) + (column.unit ? ' ' + column.unit : '')});
        e.style.color = inks[i % inks.length];
        return e;
      }));
    }
    function rowNow() {
      if (motion.history) return motion.history[frame];
      let best = 0;  // the nearest
      for (let i = 1; i < x.length; ++i) if (Math.abs(x[i] - shownKey) <= Math.abs(x[best] - shownKey)) best = i;
      return best;
    }
    const seek = e => {
      const t = xs(e.clientX - pad.getBoundingClientRect().left);
      let best = 0;
      for (let i = 1; i < frames; ++i) if (Math.abs(keys[i] - t) < Math.abs(keys[best] - t)) best = i;
      play(false);
      setFrame(best);
    };
    pad.addEventListener('pointerdown', e => { pad.setPointerCapture(e.pointerId); seek(e); });
    pad.addEventListener('pointermove', e => { if (e.buttons & 1) seek(e); });
    select.addEventListener('change', paintPlot);
    gone.addEventListener('click', () => { root.remove(); plots.splice(plots.indexOf(plot), 1); });
    const plot = {paint: paintPlot, cursor};
    plots.push(plot);
    paintPlot();
  }
  if (H && groups.length) {
    by('curves').hidden = false;
    by('more').addEventListener('click', () => addPlot(plots.length % groups.length));
  }

  // ---- beginning --------------------------------------------------------------------------------------------------
  for (const name of Object.keys(quantities)) {
    if (name === 'displacement' && !motion) continue;
    by('colour').append(element('option', {value: name, textContent: quantities[name] ? quantities[name].label : 'plain'}));
  }
  by('colour').addEventListener('change', () => colourBy(by('colour').value));
  by('scale').addEventListener('change', () => {
    const value = Number(by('scale').value);
    scale = Number.isFinite(value) && value >= 0 && by('scale').value !== '' ? value : 1;
    by('scale').value = scale;
    redraw();
  });
  if (!motion) {
    by('scale').parentElement.hidden = by('ghost').parentElement.hidden = by('colour').parentElement.hidden = true;
    for (const e of [by('scale'), by('ghost'), by('colour')]) e.parentElement.style.display = 'none';
  }
  if (frames < 2) by('trails').parentElement.style.display = 'none';
  by('trails').addEventListener('change', () => { makeTrails(); redraw(); });
  by('now').addEventListener('change', () => colourBy(by('colour').value));
  for (const id of ['ghost', 'reactions', 'grid']) by(id).addEventListener('change', redraw);
  function theme(dark) {
    document.documentElement.classList.toggle('dark', dark);
    const colour = getComputedStyle(document.documentElement).getPropertyValue('--scene').trim();
    if (renderer) renderer.setClearColor(new THREE.Color(colour), 1);
    draw();
    for (const plot of plots) plot.paint();
  }
  by('theme').addEventListener('click', () => theme(!document.documentElement.classList.contains('dark')));
  const resized = () => {
    resize();
    if (!looked) fit();
    for (const plot of plots) plot.paint();
  };
  window.addEventListener('resize', resized);
  by('list').open = window.innerWidth > 832;

  by('subtitle').textContent = D.subtitle;
  by('facts').textContent = D.about;
  if (D.fault) {
    by('fault').textContent = 'This model cannot be simulated as it is. ' + D.fault;
    by('fault').hidden = false;
  }
  resize();
  theme(window.matchMedia('(prefers-color-scheme: dark)').matches);
  setFrame(0);
  fit(firstView());
  if (H && groups.length) addPlot(0);

  // For tests, and for whoever wants more than the page shows.
  window.mbdView = {
    frames, keys, parts, setFrame, play, choose, partAt, fit, views, colourBy, camera,
    frame: () => frame,
    // Position and displacement [m] of a record's place in the frame, inertial axes.
    record: name => {
      const part = parts.find(p => p.kind === 'record' && p.name === name);
      if (!part || !part.at) return null;
      const position = add(placeIn(exactP, exactQ, part.at).r, centre);
      return {position, displacement: minus(position, part.from)};
    },
    // Where a part is in the window [px].
    screen: part => {
      const r = canvas.getBoundingClientRect(), v = new THREE.Vector3(...part.anchor()).project(camera);
      return [r.left + (v.x + 1) / 2 * r.width, r.top + (1 - v.y) / 2 * r.height];
    },
    chosen: () => chosen && label(chosen),
  };
  document.documentElement.dataset.ready = 'yes';
})();
