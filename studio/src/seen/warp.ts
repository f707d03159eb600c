// The display image live: a picture or a film, drawn through the map by a shader.

const VERTEX = `#version 300 es
in vec2 corner;
void main() { gl_Position = vec4(corner, 0.0, 1.0); }`;

// The map is read between its samples by hand: its texture is of 32-bit floats, and samples without an answer have no say.
const FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D map;
uniform sampler2D picture;
uniform vec2 size;
out vec4 colour;
void main() {
  vec2 mapSize = vec2(textureSize(map, 0));
  vec2 place = vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) / size * mapSize - 0.5;
  vec2 base = floor(place);
  vec2 share = place - base;
  vec2 uv = vec2(0.0);
  float weight = 0.0;
  for (int k = 0; k < 4; k++) {
    ivec2 step = ivec2(k & 1, k >> 1);
    ivec2 at = clamp(ivec2(base) + step, ivec2(0), ivec2(mapSize) - 1);
    vec4 texel = texelFetch(map, at, 0);
    float w = texel.a * (step.x == 1 ? share.x : 1.0 - share.x) * (step.y == 1 ? share.y : 1.0 - share.y);
    uv += w * texel.rg;
    weight += w;
  }
  if (weight < 0.25) { colour = vec4(0.0, 0.0, 0.0, 1.0); return; }
  uv /= weight;
  colour = vec4(texture(picture, vec2(uv.x, 1.0 - uv.y)).rgb, 1.0);
}`;

function compiled(gl: WebGL2RenderingContext, kind: number, source: string): WebGLShader {
  const shader = gl.createShader(kind)!;
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  return shader;
}

export class Warper {
  readonly #gl: WebGL2RenderingContext;
  readonly #size: WebGLUniformLocation | null;
  readonly #map: WebGLTexture;
  readonly #picture: WebGLTexture;
  #ready = { map: false, picture: false };

  constructor(readonly canvas: HTMLCanvasElement) {
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: false });
    if (!gl) throw new Error("no WebGL 2");
    this.#gl = gl;
    const program = gl.createProgram()!;
    gl.attachShader(program, compiled(gl, gl.VERTEX_SHADER, VERTEX));
    gl.attachShader(program, compiled(gl, gl.FRAGMENT_SHADER, FRAGMENT));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) ?? "no program");
    gl.useProgram(program);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
    const corner = gl.getAttribLocation(program, "corner");
    gl.enableVertexAttribArray(corner);
    gl.vertexAttribPointer(corner, 2, gl.FLOAT, false, 0, 0);
    gl.uniform1i(gl.getUniformLocation(program, "map"), 0);
    gl.uniform1i(gl.getUniformLocation(program, "picture"), 1);
    this.#size = gl.getUniformLocation(program, "size");
    this.#map = this.#texture(gl.NEAREST);
    this.#picture = this.#texture(gl.LINEAR);
  }

  #texture(filter: number): WebGLTexture {
    const gl = this.#gl;
    const texture = gl.createTexture()!;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, filter], [gl.TEXTURE_MAG_FILTER, filter], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]] as const) {
      gl.texParameteri(gl.TEXTURE_2D, name, value);
    }
    return texture;
  }

  map(width: number, height: number, pixels: Float32Array) {
    const gl = this.#gl;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.#map);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, pixels);
    this.#ready.map = true;
  }

  picture(source: HTMLVideoElement | ImageData) {
    const gl = this.#gl;
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.#picture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, source);
    this.#ready.picture = true;
  }

  draw() {
    if (!this.#ready.map || !this.#ready.picture) return;
    const gl = this.#gl;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.uniform2f(this.#size, this.canvas.width, this.canvas.height);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.#map);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.#picture);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
