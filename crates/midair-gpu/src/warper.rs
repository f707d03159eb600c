//! The warp on a graphics device: buffers, and the shader that reads them.

use crate::device::Device;
use midair::picture::{Drive, FixedPoint, LightFrame, NO_TAP, Warp};
use wgpu::{BindingType, BufferBindingType, BufferUsages, ShaderStages};

/// Text over a picture, at its upper left.
#[derive(Clone, Copy, Debug, Default)]
pub struct Letters<'a> {
    /// Columns and rows, no more than the display's.
    pub size: [usize; 2],
    /// A word for each of its pixels, rows from the top: blue in the lowest byte, then green and red; 0 lets the picture through.
    pub words: &'a [u32],
}

/// A pipeline and what it reads: the warp of `midair::picture::Warp` in the same integers.
#[derive(Debug)]
pub struct Warper {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    /// In the order of their bindings: sizes, taps, frame, drive, letters.
    buffers: [wgpu::Buffer; 5],
    group: Option<wgpu::BindGroup>,
    /// Columns and rows of the display, the source and the text, as the shader has them.
    sizes: [[u32; 2]; 3],
    /// The taps' memory on the processor's side.
    taps: Vec<[u32; 2]>,
}

const SIZES: usize = 0;
const TAPS: usize = 1;
const FRAME: usize = 2;
const DRIVE: usize = 3;
const LETTERS: usize = 4;

impl Warper {
    /// The form of pictures that are read back.
    pub(crate) const OFF_SCREEN: wgpu::TextureFormat = wgpu::TextureFormat::Bgra8Unorm;

    /// For an [`OffScreen`](crate::OffScreen) picture.
    pub fn new(device: &Device) -> Self {
        Self::for_format(device, Self::OFF_SCREEN)
    }

    /// For surfaces or textures of this format.
    pub(crate) fn for_format(device: &Device, format: wgpu::TextureFormat) -> Self {
        let source = wgpu::ShaderSource::Wgsl(include_str!("warp.wgsl").into());
        let shader = device
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("warp"), source });
        let entries: [_; 5] = std::array::from_fn(|binding| wgpu::BindGroupLayoutEntry {
            binding: binding as u32,
            visibility: ShaderStages::FRAGMENT,
            ty: BindingType::Buffer {
                ty: match binding {
                    SIZES => BufferBindingType::Uniform,
                    _ => BufferBindingType::Storage { read_only: true },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        });
        let layout = device.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("warp"),
            entries: &entries,
        });
        let pipelines = device.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("warp"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let constants = [
            ("WEIGHT_BITS", f64::from(FixedPoint::LIGHT.weight_bits)),
            ("DROP", f64::from(FixedPoint::LIGHT.drop)),
            ("LAST", f64::from(FixedPoint::LIGHT.last)),
            ("WHITE", f64::from(Drive::WHITE)),
            ("NO_TAP", f64::from(NO_TAP)),
        ];
        let options =
            wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let pipeline = device.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("warp"),
            layout: Some(&pipelines),
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some("picture"),
                compilation_options: options,
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let buffers = std::array::from_fn(|binding| buffer(device, binding, 32));
        Self { pipeline, layout, buffers, group: None, sizes: [[0; 2]; 3], taps: Vec::new() }
    }

    /// Takes the taps of a map for frames of `source` pixels. False if the warp is not bilinear.
    pub fn take_map(&mut self, device: &Device, warp: &Warp, source: [usize; 2]) -> bool {
        self.sizes[0] = warp.size().map(|side| side as u32);
        self.sizes[1] = source.map(|side| side as u32);
        let mut taps = std::mem::take(&mut self.taps);
        let known = warp.bilinear_taps(&mut taps).map(|words| {
            self.write(device, TAPS, bytemuck::cast_slice(words));
        });
        self.taps = taps;
        known.is_some()
    }

    /// Takes the frame that is shown until another one is, and the display's codes for its light.
    pub fn take_frame(&mut self, device: &Device, light: &LightFrame, drive: &Drive) {
        self.write(device, FRAME, bytemuck::cast_slice(light.values()));
        let codes: Vec<u8> = (0..3).flat_map(|c| drive.codes(c)).copied().collect();
        self.write(device, DRIVE, &codes);
    }

    /// Takes no map: a display of so many pixels is black.
    pub fn take_black(&mut self, device: &Device, size: [usize; 2]) {
        self.sizes[0] = size.map(|side| side as u32);
        self.taps.clear();
        self.taps.resize(size[0] * size[1], [NO_TAP, 0]);
        let taps = std::mem::take(&mut self.taps);
        self.write(device, TAPS, bytemuck::cast_slice(&taps));
        self.taps = taps;
    }

    /// Takes the text that stands over pictures until another one does.
    pub fn take_letters(&mut self, device: &Device, letters: Letters<'_>) {
        self.sizes[2] = letters.size.map(|side| side as u32);
        if !letters.words.is_empty() {
            self.write(device, LETTERS, bytemuck::cast_slice(letters.words));
        }
    }

    /// Fills a buffer, which becomes larger if need be.
    fn write(&mut self, device: &Device, binding: usize, bytes: &[u8]) {
        let length = bytes.len() as u64;
        if self.buffers[binding].size() < length {
            self.buffers[binding] = buffer(device, binding, length);
            self.group = None;
        }
        device.queue.write_buffer(&self.buffers[binding], 0, bytes);
    }

    /// Draws what was taken into a texture of the display's size. Nothing waits for it.
    pub(crate) fn draw(&mut self, device: &Device, target: &wgpu::Texture) {
        let sizes = self.sizes;
        self.write(device, SIZES, bytemuck::cast_slice(&sizes));
        let group = self.group.get_or_insert_with(|| {
            let entries: [_; 5] = std::array::from_fn(|binding| wgpu::BindGroupEntry {
                binding: binding as u32,
                resource: self.buffers[binding].as_entire_binding(),
            });
            device.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("warp"),
                layout: &self.layout,
                entries: &entries,
            })
        });
        let view = target.create_view(&Default::default());
        let mut commands = device.device.create_command_encoder(&Default::default());
        let mut pass = commands.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("warp"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &*group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        device.queue.submit([commands.finish()]);
    }
}

/// A buffer of at least so many bytes.
fn buffer(device: &Device, binding: usize, bytes: u64) -> wgpu::Buffer {
    let kind = if binding == SIZES { BufferUsages::UNIFORM } else { BufferUsages::STORAGE };
    device.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        // Uniform data come in steps of 16 bytes.
        size: bytes.next_multiple_of(32),
        usage: kind | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

#[cfg(test)]
mod tests;
