// The warp of midair::picture::Warp, in the same integers: what it computes is the processor's, code by code.

override WEIGHT_BITS: u32;
override DROP: u32;
override LAST: u32;
override WHITE: i32;
// The first word of a tap where there is no answer.
override NO_TAP: u32;

struct Sizes {
    display: vec2<u32>,
    source: vec2<u32>,
    // Of the text at the upper left; 0 without.
    overlay: vec2<u32>,
}

@group(0) @binding(0) var<uniform> sizes: Sizes;
// For each display pixel: the first of 2 x 2 source pixels, and the fractions x and y of 16 bits.
@group(0) @binding(1) var<storage, read> taps: array<vec2<u32>>;
// Light: two words a pixel, blue in the lower half of the first and green in its upper one, then red.
@group(0) @binding(2) var<storage, read> frame: array<u32>;
// A byte for each value of light from 0 to WHITE, channel after channel.
@group(0) @binding(3) var<storage, read> drive: array<u32>;
// Text: blue in a word's lowest byte, then green and red; 0 lets the picture through.
@group(0) @binding(4) var<storage, read> letters: array<u32>;

@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // One triangle over the whole window.
    let place = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(place * 2.0 - 1.0, 0.0, 1.0);
}

fn red_green_blue(word: u32) -> vec3<u32> {
    return (vec3<u32>(word) >> vec3<u32>(16u, 8u, 0u)) & vec3<u32>(255u);
}

// Red, green and blue of a source pixel.
fn source_at(pixel: u32) -> vec3<i32> {
    let near = frame[2u * pixel];
    let far = frame[2u * pixel + 1u];
    return vec3<i32>(vec3<u32>(far & 0xffffu, near >> 16u, near & 0xffffu));
}

// The pixels right of and below a source's last ones have no weight.
fn steps() -> vec2<u32> {
    return vec2<u32>(min(1u, sizes.source.x - 1u), select(0u, sizes.source.x, sizes.source.y > 1u));
}

fn mixed(a: vec3<i32>, b: vec3<i32>, c: vec3<i32>, d: vec3<i32>, ways: u32) -> vec3<i32> {
    let before = 1i << (DROP - 1u);
    let one = 1i << WEIGHT_BITS;
    let x = i32(ways & 0xffffu);
    let y = i32(ways >> 16u);
    let upper = (a * (one - x) + b * x + before) >> vec3<u32>(DROP);
    let lower = (c * (one - x) + d * x + before) >> vec3<u32>(DROP);
    return (upper * (one - y) + lower * y + (1i << (LAST - 1u))) >> vec3<u32>(LAST);
}

fn display_code(light: i32, channel: u32) -> u32 {
    let at = channel * u32(WHITE + 1) + u32(clamp(light, 0, WHITE));
    return (drive[at >> 2u] >> (8u * (at & 3u))) & 255u;
}

// A code as what a surface of 8 bits makes the same code of.
fn shown(codes: vec3<u32>) -> vec4<f32> {
    return vec4<f32>(vec3<f32>(codes) / 255.0, 1.0);
}

// The word of text over a pixel, or 0.
fn letter(pixel: vec2<u32>) -> u32 {
    if any(pixel >= sizes.overlay) {
        return 0u;
    }
    return letters[pixel.y * sizes.overlay.x + pixel.x];
}

@fragment
fn picture(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(place.xy);
    let text = letter(pixel);
    if text != 0u {
        return shown(red_green_blue(text));
    }
    let tap = taps[pixel.y * sizes.display.x + pixel.x];
    if tap.x == NO_TAP {
        return shown(vec3<u32>(0u));
    }
    let step = steps();
    let below = tap.x + step.y;
    let sum = mixed(source_at(tap.x), source_at(tap.x + step.x), source_at(below), source_at(below + step.x), tap.y);
    // The frame's channels are blue, green, red.
    return shown(vec3<u32>(display_code(sum.x, 2u), display_code(sum.y, 1u), display_code(sum.z, 0u)));
}
