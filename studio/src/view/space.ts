// The set-up in three dimensions: bodies to scale, rays, handles.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, ConeGeometry, DirectionalLight, DoubleSide, Euler, GridHelper, Group, LineBasicMaterial,
  LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, Object3D, PerspectiveCamera, Raycaster, Scene, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { TransformControls } from "three/addons/controls/TransformControls.js";
import { ConvexGeometry } from "three/addons/geometries/ConvexGeometry.js";
import type { Body, Layout, Role, Vector } from "../../core/midair_web.js";
import type { Drawn, RayLines } from "../core/protocol.js";

export type Part = "eye" | number;
export type ViewName = "around" | "side" | "top" | "fromEye";

/** What becomes of a ray: its colour, in the order of the core's numbers. */
export const FATES = ["#127a3c", "#b3261e", "#8c5b00", "#7b3fa0", "#4d5b68", "#c2185b"];

const COLOURS: Record<Role, [string, number]> = {
  display: ["#20303f", 0.55], plate: ["#7d93a8", 0.28], image: ["#f2a13b", 0.5], solid: ["#69b3e0", 0.28], mirror: ["#c8ced4", 0.75], opaque: ["#5a4634", 0.9],
};

interface Shown {
  group: Group;
  drawn: Drawn;
  body: Body;
}

const DEGREE = Math.PI / 180;
const rounded = (value: number) => Math.round(value * 100) / 100 + 0;

/** Whether two lists of points are the same but for rounding. */
function alike(a: Float32Array, b: Float32Array): boolean {
  return a.length === b.length && a.every((value, index) => Math.abs(value - b[index]!) < 1e-3);
}

export class Space {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(35, 1, 1, 1e5);
  readonly #orbit: OrbitControls;
  readonly #handles: TransformControls;
  readonly #held = new Object3D();
  readonly #bodies: Shown[] = [];
  readonly #rays = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.75 }));
  readonly #eye: Mesh;
  #layout: Layout | undefined;
  #selected: Part | null = null;
  #waiting = false;
  #framed = false;

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly on: { select(part: Part | null): void; drag(part: Part, position: Vector, rotation: Vector, done: boolean): void },
  ) {
    this.#renderer = new WebGLRenderer({ canvas, antialias: !drawsInSoftware() });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#scene.background = new Color("#eaf0f5");
    const sun = new DirectionalLight("#ffffff", 1.6);
    sun.position.set(0.5, 1, 0.8);
    this.#scene.add(new AmbientLight("#ffffff", 1.5), sun, this.#rays, this.#held);
    this.#rays.frustumCulled = false;
    const grid = new GridHelper(2000, 40, "#b3c0cc", "#d5dee6");
    grid.position.y = -320;
    this.#scene.add(grid);
    this.#eye = new Mesh(new SphereGeometry(1, 24, 16), new MeshLambertMaterial({ color: "#14568c" }));
    const pupil = new Mesh(new ConeGeometry(0.55, 1.4, 20), new MeshLambertMaterial({ color: "#ffffff" }));
    pupil.rotation.x = Math.PI / 2;
    pupil.position.z = 0.9;
    this.#eye.add(pupil);
    this.#scene.add(this.#eye);

    this.#orbit = new OrbitControls(this.#camera, canvas);
    this.#orbit.addEventListener("change", () => this.draw());
    this.#handles = new TransformControls(this.#camera, canvas);
    this.#handles.setSize(0.75);
    this.#scene.add(this.#handles.getHelper());
    this.#handles.addEventListener("change", () => this.draw());
    this.#handles.addEventListener("dragging-changed", (event) => {
      this.#orbit.enabled = !event.value;
      if (!event.value) this.#tell(true);
    });
    this.#handles.addEventListener("objectChange", () => this.#tell(false));

    let down = new Vector2();
    canvas.addEventListener("pointerdown", (event) => (down = new Vector2(event.clientX, event.clientY)));
    canvas.addEventListener("pointerup", (event) => {
      const still = down.distanceTo(new Vector2(event.clientX, event.clientY)) < 4;
      if (still && !this.#handles.dragging && this.#handles.axis === null) this.#pick(event);
    });
    new ResizeObserver(() => this.#resize()).observe(canvas);
    this.#resize();
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.#renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.draw();
  }

  /** Draws with the next frame, once however often it is asked for. */
  draw() {
    if (this.#waiting) return;
    this.#waiting = true;
    requestAnimationFrame(() => {
      this.#waiting = false;
      this.#renderer.render(this.#scene, this.#camera);
    });
  }

  /** Shows a scene; what is held in the hand stays where the hand is. */
  show(layout: Layout, drawn: Drawn[], rays: RayLines) {
    this.#layout = layout;
    while (this.#bodies.length > layout.bodies.length) this.#scene.remove(this.#bodies.pop()!.group);
    layout.bodies.forEach((body, index) => this.#place(body, drawn[index]!, index));
    this.#showRays(rays);
    this.#eye.position.set(...layout.eye);
    this.#eye.lookAt(...layout.image);
    const reach = new Vector3(...layout.eye).distanceTo(new Vector3(...layout.image));
    this.#eye.scale.setScalar(Math.max(0.015 * reach, 4));
    if (!this.#framed) this.look("around");
    if (!this.#handles.dragging) this.#hold();
    this.draw();
  }

  /** The eye that looks, where it is not the scene's. */
  moveEye(to: Vector) {
    this.#eye.position.set(...to);
    if (this.#layout) this.#eye.lookAt(...this.#layout.image);
    if (!this.#handles.dragging) this.#hold();
    this.draw();
  }

  #place(body: Body, drawn: Drawn, index: number) {
    const known = this.#bodies[index];
    let shown = known;
    const same = known && known.body.role === body.role && (["edges", "hull", "faces"] as const).every((part) => alike(known.drawn[part], drawn[part]));
    if (!same) {
      if (known) this.#scene.remove(known.group);
      shown = { group: built(body.role, drawn), drawn, body };
      this.#bodies[index] = shown;
      this.#scene.add(shown.group);
    }
    shown!.body = body;
    shown!.group.userData.index = index;
    pose(shown!.group, body.position, body.rotation);
  }

  #showRays({ ends, fates }: RayLines) {
    const colours = new Float32Array(ends.length);
    const known = FATES.map((fate) => new Color(fate));
    fates.forEach((fate, piece) => {
      const colour = known[fate] ?? known[0]!;
      for (const end of [0, 3]) colour.toArray(colours, 6 * piece + end);
    });
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(ends, 3));
    geometry.setAttribute("color", new BufferAttribute(colours, 3));
    this.#rays.geometry.dispose();
    this.#rays.geometry = geometry;
  }

  select(part: Part | null) {
    this.#selected = part;
    this.#hold();
    this.draw();
  }

  #hold() {
    const part = this.#selected;
    const body = typeof part === "number" ? this.#bodies[part]?.body : undefined;
    if (part === "eye") pose(this.#held, this.#eye.position.toArray(), [0, 0, 0]);
    else if (body) pose(this.#held, body.position, body.rotation);
    else return void this.#handles.detach();
    this.#handles.attach(this.#held);
  }

  set mode(mode: "translate" | "rotate") {
    this.#handles.setMode(mode);
    this.#handles.setSpace(mode === "rotate" ? "local" : "world");
    this.draw();
  }

  set snapping(on: boolean) {
    this.#handles.setTranslationSnap(on ? 5 : null);
    this.#handles.setRotationSnap(on ? 5 * DEGREE : null);
  }

  #tell(done: boolean) {
    if (this.#selected === null) return;
    const { x, y, z } = this.#held.position;
    const turn = new Euler().setFromQuaternion(this.#held.quaternion, "XYZ");
    const rotation = [turn.x, turn.y, turn.z].map((angle) => rounded(angle / DEGREE)) as Vector;
    this.on.drag(this.#selected, [x, y, z].map(rounded) as Vector, rotation, done);
  }

  #pick(event: PointerEvent) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.#camera);
    const hits = ray.intersectObjects([this.#eye, ...this.#bodies.map((shown) => shown.group)]).filter((hit) => hit.object instanceof Mesh);
    for (let object: Object3D | null = hits[0]?.object ?? null; object; object = object.parent) {
      if (object === this.#eye) return this.on.select("eye");
      if (typeof object.userData.index === "number") return this.on.select(object.userData.index);
    }
    this.on.select(null);
  }

  /** Where on the screen the handle of an axis can be taken hold of. */
  grip(axis: "x" | "y" | "z"): { x: number; y: number } {
    const at = this.#held.position.clone();
    const distance = at.distanceTo(this.#camera.position);
    // TransformControls draws its arrows in a size on the screen; half way along one is its shaft.
    const size = (distance * Math.min(1.9 * Math.tan(0.5 * this.#camera.fov * DEGREE), 7) * this.#handles.size) / 4;
    at[axis] += 0.4 * size;
    const seen = at.project(this.#camera);
    const box = this.canvas.getBoundingClientRect();
    return { x: box.left + (0.5 + 0.5 * seen.x) * box.width, y: box.top + (0.5 - 0.5 * seen.y) * box.height };
  }

  /** Looks at the set-up from a side that has a name. */
  look(from: ViewName) {
    const layout = this.#layout;
    if (!layout) return;
    this.#framed = true;
    const eye = new Vector3(...layout.eye);
    const image = new Vector3(...layout.image);
    const towards = eye.clone().sub(image);
    const level = new Vector3(towards.x, 0, towards.z);
    if (level.length() < 0.01 * towards.length()) level.set(0, 0, 1);
    level.normalize();
    const right = new Vector3(0, 1, 0).cross(level);
    if (from === "fromEye") {
      const size = layout.bodies.find((body) => body.role === "image")?.size ?? [30, 30];
      const fov = (2 * Math.atan((2.5 * Math.max(...size)) / towards.length())) / DEGREE;
      return this.#aim(eye, image, Math.min(60, fov), new Vector3(0, 1, 0));
    }
    // All that stands near the image; the eye is far off.
    const points = layout.bodies.flatMap((body) => {
      const half = body.role === "plate" && body.size ? 0.5 * Math.max(...body.size) : 60;
      const centre = new Vector3(...body.position);
      return [centre.clone().addScalar(half), centre.clone().addScalar(-half)];
    });
    const middle = points.reduce((sum, point) => sum.add(point), new Vector3()).divideScalar(points.length);
    const reach = Math.max(...points.map((point) => point.distanceTo(middle)), 50);
    const way = {
      around: level.clone().multiplyScalar(0.75).addScaledVector(right, 0.75).add(new Vector3(0, 0.42, 0)).normalize(),
      side: right.clone().negate(),
      top: new Vector3(0, 1, 0),
    }[from];
    // Nearly parallel rays for plan and elevation: from far off through a narrow angle.
    const fov = from === "around" ? 35 : 3;
    const distance = (1.02 * reach) / Math.tan(0.5 * fov * DEGREE);
    const up = from === "top" ? level.clone().negate() : new Vector3(0, 1, 0);
    this.#aim(middle.clone().addScaledVector(way, distance), middle, fov, up);
  }

  #aim(from: Vector3, at: Vector3, fov: number, up: Vector3) {
    this.#camera.fov = fov;
    this.#camera.near = Math.max(1, from.distanceTo(at) / 100);
    this.#camera.far = from.distanceTo(at) * 10 + 1e4;
    this.#camera.up.copy(up.y !== 0 ? new Vector3(0, 1, 0) : up);
    this.#camera.position.copy(from);
    this.#orbit.target.copy(at);
    this.#camera.updateProjectionMatrix();
    this.#orbit.update();
    this.draw();
  }
}

/** Whether the processor draws, which has better to do than to smooth edges. */
function drawsInSoftware(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const named = context?.getExtension("WEBGL_debug_renderer_info");
  const name: unknown = named ? context?.getParameter(named.UNMASKED_RENDERER_WEBGL) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(String(name));
}

function pose(object: Object3D, position: Vector, rotation: Vector) {
  object.position.set(...position);
  object.rotation.set(rotation[0] * DEGREE, rotation[1] * DEGREE, rotation[2] * DEGREE, "XYZ");
}

/** A body in its own frame. */
function built(role: Role, drawn: Drawn): Group {
  const group = new Group();
  const [colour, opacity] = COLOURS[role];
  const material = new MeshLambertMaterial({ color: colour, transparent: true, opacity, side: DoubleSide, depthWrite: opacity > 0.6 });
  const solid = surface(drawn);
  if (solid) {
    solid.computeVertexNormals();
    group.add(new Mesh(solid, material));
  }
  if (drawn.edges.length > 0) {
    const lines = new BufferGeometry();
    lines.setAttribute("position", new BufferAttribute(drawn.edges, 3));
    const ink = new Color(colour).multiplyScalar(0.55);
    group.add(new LineSegments(lines, new LineBasicMaterial({ color: ink, transparent: true, opacity: 0.7 })));
    if (!solid) {
      // Something to take hold of where there is no surface.
      const grip = new Mesh(new SphereGeometry(3, 12, 8), new MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.6 }));
      group.add(grip);
    }
  }
  return group;
}

function surface({ faces, hull }: Drawn): BufferGeometry | null {
  if (faces.length > 0) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(faces, 3));
    return geometry;
  }
  const points: Vector3[] = [];
  for (let index = 0; index < hull.length; index += 3) points.push(new Vector3().fromArray(hull, index));
  if (points.length < 3) return null;
  // A rectangle has no inside for a hull: its two triangles.
  if (points.length === 4 && points.every((point) => Math.abs(point.z) < 1e-3)) {
    return new BufferGeometry().setFromPoints([0, 1, 2, 0, 2, 3].map((corner) => points[corner]!));
  }
  return points.length > 3 ? new ConvexGeometry(points) : null;
}
