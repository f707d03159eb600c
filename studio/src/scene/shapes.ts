// A first shape of each kind, to begin from: 50 mm or so, as the ball is.

/** By the kind's name in the scene file; `file` stands for a mesh that has been dropped. */
export const SHAPES: Record<string, string> = {
  sphere: "radius = 25.0",
  ellipsoid: "radii = [30.0, 25.0, 20.0]",
  box: "size = [50.0, 50.0, 50.0]",
  cylinder: "radius = 25.0, height = 60.0",
  cone: "radius = 30.0, top_radius = 15.0, height = 60.0",
  hemisphere: "radius = 30.0",
  torus: "radius = 40.0, tube = 15.0",
  lens: "radii = [60.0, 60.0], thickness = 14.0, diameter = 50.0",
  lathe: "profile = [[0.0, -40.0], [25.0, -40.0], [25.0, 10.0], [10.0, 30.0], [10.0, 45.0], [0.0, 45.0]]",
  prism: "outline = [[-30.0, -20.0], [30.0, -20.0], [0.0, 32.0]], depth = 50.0",
  plane: "size = [200.0, 200.0]",
  "cylinder-mirror": "radius = 250.0, size = [200.0, 200.0], facing = \"convex\"",
  "sphere-mirror": "radius = 250.0, diameter = 150.0, facing = \"convex\"",
  "height-field": "samples = [[0.0, 0.5, 0.0], [0.5, 1.0, 0.5], [0.0, 0.5, 0.0]], size = [60.0, 60.0], amplitude = 2.0, depth = 20.0",
};

const MIRRORS = ["plane", "cylinder-mirror", "sphere-mirror"];

const quoted = (text: string) => JSON.stringify(text);

/** A shape as the scene file has it. */
export function shapeOf(kind: string, file?: string): string {
  const keys = kind === "mesh" ? `file = ${quoted(file ?? "")}` : SHAPES[kind];
  return `{ kind = ${quoted(kind)}, ${keys} }`;
}

/** The keys of a new element of this shape. */
export function elementOf(kind: string, name: string, file?: string): string {
  const material = MIRRORS.includes(kind) ? "{ mirror = true }" : "{ ior = 1.49 }";
  return `name = ${quoted(name)}\nshape = ${shapeOf(kind, file)}\nmaterial = ${material}\n`;
}

/** A name that no element has yet. */
export function freeName(wanted: string, taken: string[]): string {
  for (let number = 1; ; number++) {
    const name = number === 1 ? wanted : `${wanted} ${number}`;
    if (!taken.includes(name)) return name;
  }
}
