// SPDX-License-Identifier: GPL-3.0-or-later
// One run in 3-D: the surface, the section where it is cut, its outline, the obstacles without a mesh.

import {
  BufferAttribute,
  BufferGeometry,
  CircleGeometry,
  Color,
  DataTexture,
  DoubleSide,
  DynamicDrawUsage,
  FrontSide,
  GLSL3,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  NearestFilter,
  LinearFilter,
  Quaternion,
  Raycaster,
  Scene,
  ShaderMaterial,
  Sphere,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { createRoom, outlineOf, sectionOf } from "./cut.js";
import { LEVELS, NO_CODE, decode } from "../data/codes.js";

const VERTEX = `
  in vec3 codes, weight;
  flat out vec3 vCodes;
  out vec3 vShares, vWeight, vView, vPlace;
  void main() {
    vCodes = codes;
    int corner = gl_VertexID % 3;
    vShares = vec3(corner == 0, corner == 1, corner == 2);
    vWeight = weight;
    vPlace = position;
    vec4 view = modelViewMatrix * vec4(position, 1.0);
    vView = view.xyz;
    gl_Position = projectionMatrix * view;
  }`;

// Flat shading from the derivatives of the position; edges where a weight is near 0, faded where they would
// be denser than the pixels. What is translucent has few of them. A class, and where there is no value, are those
// of the nearest corner; a value is interpolated between the corners that have one.
const FRAGMENT = `
  precision highp float;
  uniform sampler2D ramp;
  uniform vec2 range;
  uniform float classes, edges, noCode, opacity;
  uniform vec3 neutral, ink;
  uniform vec4 plane;
  uniform bool isCut, isFlat;
  flat in vec3 vCodes;
  in vec3 vShares, vWeight, vView, vPlace;
  out vec4 colour;
  void main() {
    if (isCut && dot(plane.xyz, vPlace) > plane.w) discard; // the side that is taken away
    float most = max(max(vShares.x, vShares.y), vShares.z);
    float nearest = vShares.x >= most ? vCodes.x : vShares.y >= most ? vCodes.y : vCodes.z;
    vec3 known = vShares * vec3(lessThan(vCodes, vec3(noCode - 0.5)));
    float code = dot(known, vCodes) / max(known.x + known.y + known.z, 1e-6);
    float share = (code - range.x) / max(range.y - range.x, 1e-6);
    if (classes > 0.0) share = (nearest + 0.5) / classes;
    vec3 base = nearest > noCode - 0.5 ? neutral : texture(ramp, vec2(clamp(share, 0.002, 0.998), 0.5)).rgb;
    vec3 normal = normalize(cross(dFdx(vView), dFdy(vView)));
    float key = max(dot(normal, normalize(vec3(0.35, 0.75, 0.65))), 0.0);
    float head = abs(normal.z);
    vec3 lit = isFlat ? base : base * (0.76 + 0.08 * head + 0.22 * key);
    vec3 width = fwidth(vWeight);
    vec3 line = smoothstep(width * 0.1, width * 0.8, vWeight);
    float edge = 1.0 - min(min(line.x, line.y), line.z);
    float fade = opacity < 1.0 ? 1.0 : 1.0 - smoothstep(0.12, 0.5, max(max(width.x, width.y), width.z));
    float strength = edge * edges * fade;
    colour = vec4(mix(lit, ink, strength), mix(opacity, 1.0, strength));
  }`;

const GRID_VERTEX = `
  out vec2 vPlace;
  void main() {
    vPlace = position.xy;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;

const GRID_FRAGMENT = `
  precision highp float;
  uniform vec3 ink;
  uniform float spacing, radius;
  in vec2 vPlace;
  out vec4 colour;
  float lines(float step, vec2 width) {
    vec2 apart = abs(fract(vPlace / step - 0.5) - 0.5) * step;
    vec2 line = 1.0 - smoothstep(width * 0.4, width * 1.3, apart);
    return max(line.x, line.y) * (1.0 - smoothstep(0.2, 0.6, max(width.x, width.y) / step));
  }
  void main() {
    vec2 width = fwidth(vPlace);
    float strength = max(lines(spacing, width) * 0.4, lines(5.0 * spacing, width));
    float fade = 1.0 - smoothstep(0.15, 1.0, length(vPlace) / radius);
    colour = vec4(ink, (0.04 + 0.22 * strength) * fade);
  }`;

// All three corners of a triangle, which begins at vertex `begin`, are given the code of its corner k.
function setCorner(codes, begin, k, code) {
  for (let corner = 0; corner < 3; corner++) codes[3 * (begin + corner) + k] = code;
}

export const PALETTE = {
  light: { ink: "#1c2126", grid: "#4a5560", edges: 0.3, obstacle: "#7f8b95" },
  dark: { ink: "#07090b", grid: "#aeb8c2", edges: 0.55, obstacle: "#9aa6b1" },
};

const OBSTACLE_OPACITY = 0.36;

// A round distance, about a tenth of `size`.
function spacingOf(size) {
  const power = 10 ** Math.floor(Math.log10(size / 10));
  const share = size / 10 / power;
  return power * (share < 2 ? 1 : share < 5 ? 2 : 5);
}

export class View {
  constructor(run, frames, world, canvas) {
    Object.assign(this, { run, frames, world, canvas });
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: "low-power" });
    this.scene = new Scene();
    this.uniforms = {
      ramp: { value: null },
      range: { value: new Vector2(0, LEVELS) },
      classes: { value: 0 },
      edges: { value: 0.3 },
      noCode: { value: NO_CODE },
      neutral: { value: new Color() },
      ink: { value: new Color() },
      plane: { value: [1, 0, 0, 0] },
      isCut: { value: false },
    };
    this.places = new Float32Array(3 * frames.vertices); // of the vertices in this frame, from the world's origin
    this.frame = -1;
    this.cut = null;
    this.field = null;
    this.room = createRoom();
    this.body = null; // the field `body`, where it was read
    this.surface = this.addMesh(frames.triangles.length / 4);
    this.surface.geometry.getAttribute("weight").array.forEach((_, i, all) => (all[i] = i % 9 % 4 === 0 ? 255 : 0));
    this.section = this.addMesh(0, { isClipped: false });
    this.outline = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ depthTest: true }));
    this.outline.frustumCulled = false;
    this.outline.renderOrder = 2;
    this.scene.add(this.outline);
    this.obstacles = frames.obstacles;
    this.solids = this.addSolids();
    this.grids = run.solids.shapes.filter((shape) => shape.halfspace).map((shape) => this.addGrid(shape));
  }

  // The surface is clipped by the plane, the section lies in it.
  addMesh(triangleCount, { isClipped = true, opacity = 1 } = {}) {
    const uniforms = { ...this.uniforms };
    uniforms.opacity = { value: opacity };
    uniforms.isFlat = { value: !isClipped }; // a section shows the legend's own colours
    if (!isClipped) uniforms.isCut = { value: false };
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms,
      transparent: opacity < 1,
      depthWrite: opacity === 1,
      side: opacity < 1 ? FrontSide : DoubleSide,
    });
    const mesh = new Mesh(new BufferGeometry(), material);
    this.reserve(mesh.geometry, triangleCount);
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    return mesh;
  }

  reserve(geometry, triangleCount) {
    const add = (name, array, size, isNormalized) =>
      geometry.setAttribute(name, new BufferAttribute(array, size, isNormalized).setUsage(DynamicDrawUsage));
    add("position", new Float32Array(9 * triangleCount), 3, false);
    add("codes", new Float32Array(9 * triangleCount), 3, false);
    add("weight", new Uint8Array(9 * triangleCount), 3, true);
    geometry.boundingSphere = new Sphere(new Vector3(), Infinity);
  }

  // Obstacles that have an end: translucent, in one colour, with lines between their faces.
  addSolids() {
    const solids = this.addMesh(this.obstacles.triangles.length, { opacity: OBSTACLE_OPACITY });
    const { uniforms } = solids.material;
    uniforms.neutral = { value: new Color() };
    uniforms.edges = { value: 0 };
    solids.geometry.getAttribute("codes").array.fill(NO_CODE);
    solids.geometry.getAttribute("weight").array.set(this.obstacles.weights());
    solids.renderOrder = 4;
    return solids;
  }

  addGrid(shape) {
    const { size } = this.world;
    const up = new Vector3(...(shape.halfspace.normal ?? [0, 0, 1])).normalize();
    const radius = 1.6 * size;
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: GRID_VERTEX,
      fragmentShader: GRID_FRAGMENT,
      uniforms: { ink: { value: new Color() }, spacing: { value: spacingOf(size) }, radius: { value: radius } },
      transparent: true,
      depthWrite: false,
      side: DoubleSide,
    });
    const grid = new Mesh(new CircleGeometry(radius, 96), material);
    grid.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), up));
    grid.renderOrder = 3;
    this.scene.add(grid);
    return { grid, up, shape };
  }

  // Below the middle of the scene, at its height in this frame.
  layGrid({ grid, up, shape }) {
    const { origin } = this.world;
    const point = this.obstacles.pointOf(shape, this.frame) ?? shape.halfspace.point ?? [0, 0, 0];
    grid.position.copy(up).multiplyScalar(new Vector3(...point.map((p, k) => p - origin[k])).dot(up));
  }

  // Calls with vertices of the surface in up to a dozen frames, and of what is near of the obstacles.
  visit(call) {
    const { positions, vertices, low, high, time_s } = this.frames;
    const stride = Math.max(1, Math.floor(time_s.length / 11));
    const place = new Vector3();
    for (let frame = 0; frame < time_s.length; frame += stride)
      for (let v = 0; v < vertices; v++) {
        const at = (k) => low[k] + ((high[k] - low[k]) * positions[3 * (vertices * frame + v) + k]) / LEVELS - this.world.origin[k];
        call(place.set(at(0), at(1), at(2)));
      }
    const { near, origin } = this.world;
    this.obstacles.visit(time_s.length, stride, (at) => call(place.fromArray(at.map((p, k) => Math.min(Math.max(p, near.low[k]), near.high[k]) - origin[k]))));
  }

  resize(width, height) {
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
  }

  setTheme(theme) {
    const { ink, grid, edges, obstacle } = PALETTE[theme];
    this.edgeStrength = edges;
    const raw = (target, colour) => target.setStyle(colour, "srgb-linear"); // shown as given
    raw(this.uniforms.ink.value, ink);
    raw(this.outline.material.color, theme === "light" ? "#000000" : "#ffffff");
    for (const one of this.grids) raw(one.grid.material.uniforms.ink.value, grid);
    const { uniforms } = this.solids.material;
    raw(uniforms.neutral.value, obstacle);
    uniforms.edges.value = edges; // they show how it turns, edges of elements or not
  }

  setEdges(isOn) {
    this.uniforms.edges.value = isOn ? this.edgeStrength : 0;
  }

  // `scale` {low, high} in the field's unit; `bytes` are the ramp's colours; with `classes` a colour each value.
  setField(field, scale, bytes, classes, neutral) {
    this.field = field;
    const { uniforms } = this;
    uniforms.ramp.value?.dispose();
    const texture = new DataTexture(bytes, bytes.length / 4, 1);
    texture.minFilter = texture.magFilter = classes ? NearestFilter : LinearFilter;
    texture.needsUpdate = true;
    uniforms.ramp.value = texture;
    uniforms.classes.value = classes;
    uniforms.neutral.value.setStyle(neutral, "srgb-linear");
    if (field && !classes) {
      const width = field.high - field.low;
      const code = (value) => (width > 0 ? ((value - field.low) / width) * LEVELS : 0);
      uniforms.range.value.set(code(scale.low), Math.max(code(scale.high), code(scale.low) + 1e-3));
    }
    this.classLow = scale.low;
    this.classes = classes;
    this.update();
  }

  setFrame(frame) {
    if (frame === this.frame) return;
    this.frame = frame;
    const { positions, vertices, low, high } = this.frames;
    const begin = 3 * vertices * frame;
    for (let axis = 0; axis < 3; axis++) {
      const step = (high[axis] - low[axis]) / LEVELS;
      const offset = low[axis] - this.world.origin[axis];
      for (let i = axis; i < 3 * vertices; i += 3) this.places[i] = offset + step * positions[begin + i];
    }
    const corners = this.solids.geometry.getAttribute("position");
    this.obstacles.fill(corners.array, frame, this.world.origin);
    corners.needsUpdate = true;
    this.grids.forEach((one) => this.layGrid(one));
    this.update();
  }

  // {axis, place, side} from the world's origin: what lies on that side (1 or −1) is taken away. null: whole.
  setCut(cut) {
    this.cut = cut;
    this.uniforms.isCut.value = cut !== null;
    this.solids.material.side = cut === null ? FrontSide : DoubleSide;
    if (cut) {
      const plane = [0, 0, 0, cut.side * cut.place];
      plane[cut.axis] = cut.side;
      this.uniforms.plane.value = plane;
    }
    this.updateSection();
  }

  // The code of a vertex or tetrahedron in this frame; of a class its number.
  codeAt(i) {
    const { field } = this;
    if (!field) return NO_CODE;
    const code = field.codes[field.size * this.frame + i];
    if (!this.classes || code === NO_CODE) return code;
    return Math.round(decode(field.low, field.high, code)) - this.classLow;
  }

  // On the edge of two vertices: of the nearer one where it is a class, or one of them has no value.
  codeBetween(a, b, share) {
    const [first, second] = [this.codeAt(a), this.codeAt(b)];
    if (this.classes || first === NO_CODE || second === NO_CODE) return share < 0.5 ? first : second;
    return first * (1 - share) + second * share;
  }

  update() {
    if (this.frame < 0) return;
    const { triangles } = this.frames;
    const place = this.surface.geometry.getAttribute("position");
    const codes = this.surface.geometry.getAttribute("codes");
    const isCell = this.field?.on === "tetrahedra";
    for (let t = 0, corner = 0; t < triangles.length; t += 4, corner += 3)
      for (let k = 0; k < 3; k++) {
        const v = triangles[t + k];
        place.array.set(this.places.subarray(3 * v, 3 * v + 3), 3 * (corner + k));
        setCorner(codes.array, corner, k, this.codeAt(isCell ? triangles[t + 3] : v));
      }
    place.needsUpdate = codes.needsUpdate = true;
    this.updateSection();
  }

  updateSection() {
    const { cut, frames, places, room } = this;
    const isShown = cut !== null && frames.has_inside;
    this.section.visible = isShown;
    this.outline.visible = cut !== null;
    if (cut === null || this.frame < 0) return;
    this.outline.geometry.dispose();
    this.outline.geometry = new BufferGeometry();
    const points = outlineOf(frames.triangles, places, cut.axis, cut.place);
    const lift = 1e-3 * this.world.size * cut.side; // towards the side that was taken away
    for (let i = cut.axis; i < points.length; i += 3) points[i] += lift;
    this.outline.geometry.setAttribute("position", new BufferAttribute(points, 3));
    if (!isShown) return;
    sectionOf(frames.tetrahedra, places, cut.axis, cut.place, room);
    this.fillSection();
  }

  fillSection() {
    const { room, places } = this;
    const geometry = this.section.geometry;
    if (geometry.getAttribute("position").count < 3 * room.triangleCount) {
      geometry.dispose();
      this.reserve(geometry, room.owners.length);
    }
    const place = geometry.getAttribute("position");
    const codes = geometry.getAttribute("codes");
    const isCell = this.field?.on === "tetrahedra";
    for (let corner = 0; corner < 3 * room.triangleCount; corner++) {
      const [a, b, share] = [room.ends[2 * corner], room.ends[2 * corner + 1], room.shares[corner]];
      for (let c = 0; c < 3; c++)
        place.array[3 * corner + c] = places[3 * a + c] + share * (places[3 * b + c] - places[3 * a + c]);
      const owner = room.owners[(corner / 3) | 0];
      const k = corner % 3;
      setCorner(codes.array, corner - k, k, isCell ? this.codeAt(owner) : this.codeBetween(a, b, share));
    }
    this.layBodies(place.array);
    const weight = geometry.getAttribute("weight");
    weight.array.set(room.weights.subarray(0, 9 * room.triangleCount));
    place.needsUpdate = codes.needsUpdate = weight.needsUpdate = true;
    geometry.setDrawRange(0, 3 * room.triangleCount);
  }

  // Where two bodies overlap their sections lie in one plane: the later body is laid on top.
  layBodies(places) {
    const { room, cut, body } = this;
    if (!body || body.high === body.low) return;
    const step = (5e-4 * this.world.size * cut.side) / LEVELS;
    for (let t = 0; t < room.triangleCount; t++) {
      const lift = step * body.codes[room.owners[t]];
      for (let k = 0; k < 3; k++) places[9 * t + 3 * k + cut.axis] += lift;
    }
  }

  // What lies under a point of the canvas (−1 … 1 each way): {tetrahedron, value}, {obstacle} through which
  // nothing is seen, or null.
  pick(x, y, camera) {
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(x, y), camera);
    const { cut } = this;
    const isKept = (hit) => hit.object === this.section || !cut || (hit.point.getComponent(cut.axis) - cut.place) * cut.side <= 0;
    const meshes = this.section.visible ? [this.surface, this.section] : [this.surface];
    const hit = caster.intersectObjects(meshes, false).find(isKept);
    if (!hit) {
      const face = caster.intersectObject(this.solids, false).find(isKept)?.face;
      return face ? { obstacle: this.obstacles.triangles[Math.floor(face.a / 3)].shape?.name ?? "obstacle" } : null;
    }
    const t = Math.floor(hit.face.a / 3);
    const tetrahedron = hit.object === this.section ? this.room.owners[t] : this.frames.triangles[4 * t + 3];
    const { field } = this;
    let value = NaN;
    if (field?.on === "tetrahedra") value = decode(field.low, field.high, field.codes[field.size * this.frame + tetrahedron]);
    else if (field && hit.object === this.surface) {
      const corners = [0, 1, 2].map((k) => this.frames.triangles[4 * t + k]);
      const apart = corners.map((v) => hit.point.distanceTo(new Vector3(...this.places.subarray(3 * v, 3 * v + 3))));
      const vertex = corners[apart.indexOf(Math.min(...apart))];
      value = decode(field.low, field.high, field.codes[field.size * this.frame + vertex]);
    }
    return { tetrahedron, value };
  }

  render(camera) {
    this.renderer.render(this.scene, camera);
  }

  destroy() {
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}
