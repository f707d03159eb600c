//! A picture that is drawn to be read back.

use crate::device::{Device, GraphicsError};
use crate::warper::Warper;
use wgpu::{BufferUsages, TextureUsages};

/// A texture of the display's size, and the memory that it comes back through.
#[derive(Debug)]
pub struct OffScreen {
    texture: wgpu::Texture,
    back: wgpu::Buffer,
    size: wgpu::Extent3d,
    /// Bytes of a row in `back`.
    line: usize,
}

impl OffScreen {
    /// Of so many columns and rows.
    pub fn new(device: &Device, [width, height]: [usize; 2]) -> Self {
        let size =
            wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 };
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Warper::OFF_SCREEN,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let line = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let back = device.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: (line * height) as u64,
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { texture, back, size, line }
    }

    /// Draws what the warper was given: blue, green, red and one more byte for each pixel, rows from the top. Waits for the device.
    ///
    /// # Errors
    /// [`GraphicsError`] where the device will not work any more.
    pub fn draw(&self, device: &Device, warper: &mut Warper) -> Result<Vec<u8>, GraphicsError> {
        warper.draw(device, &self.texture);
        let mut commands = device.device.create_command_encoder(&Default::default());
        commands.copy_texture_to_buffer(
            self.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.back,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(self.line as u32),
                    rows_per_image: None,
                },
            },
            self.size,
        );
        device.queue.submit([commands.finish()]);
        // What goes wrong is told by the device.
        self.back.slice(..).map_async(wgpu::MapMode::Read, drop);
        device.finish()?;
        let bytes = self.back.slice(..).get_mapped_range().map_err(GraphicsError::of)?;
        let seen = 4 * self.size.width as usize;
        let rows = bytes.chunks_exact(self.line).flat_map(|row| &row[..seen]).copied().collect();
        drop(bytes);
        self.back.unmap();
        Ok(rows)
    }
}
