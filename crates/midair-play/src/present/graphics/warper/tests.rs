//! The device's pictures against the processor's, code by code.

use super::*;
use crate::letters::{extent, overlay};
use midair::map::Map;
use midair::optics::screen::{Response, Screen};
use midair::picture::{Filter, Overflow};
use proptest::prelude::*;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Bgra8Unorm;

fn device() -> Option<Device> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()));
    match adapter {
        Ok(adapter) => Some(Device::open(&adapter).unwrap()),
        Err(error) => {
            midair_peers::missing(midair_peers::Peer::Graphics, error);
            None
        }
    }
}

/// The picture in a texture: blue, green, red and one more byte for each pixel.
fn drawn(device: &Device, warper: &mut Warper, [width, height]: [usize; 2]) -> Vec<u8> {
    let size =
        wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 };
    let texture = device.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    warper.draw(device, &texture);
    let line = (4 * width).next_multiple_of(256);
    let back = device.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: (line * height) as u64,
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut commands = device.device.create_command_encoder(&Default::default());
    commands.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &back,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(line as u32),
                rows_per_image: None,
            },
        },
        size,
    );
    device.queue.submit([commands.finish()]);
    back.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.unwrap());
    device.finish().unwrap();
    let bytes = back.slice(..).get_mapped_range().unwrap().to_vec();
    bytes.chunks_exact(line).flat_map(|row| &row[..4 * width]).copied().collect()
}

/// Three of four bytes are seen.
fn seen(bytes: &[u8]) -> Vec<[u8; 3]> {
    bytes.as_chunks::<4>().0.iter().map(|&[b, g, r, _]| [b, g, r]).collect()
}

fn place() -> impl Strategy<Value = f64> {
    prop_oneof![8 => -0.1f64..1.1, 1 => Just(f64::NAN), 1 => prop::sample::select(vec![0.0, 1.0])]
}

/// A display, a source, the map's places and the source's codes.
fn scene() -> impl Strategy<Value = ([usize; 2], [usize; 2], Vec<[f64; 2]>, Vec<u8>)> {
    ([1usize..90, 1usize..40], [1usize..30, 1usize..30]).prop_flat_map(|(display, source)| {
        (
            Just(display),
            Just(source),
            prop::collection::vec([place(), place()], display[0] * display[1]),
            prop::collection::vec(any::<u8>(), 4 * source[0] * source[1]),
        )
    })
}

#[test]
fn a_device_shows_the_processors_codes() {
    let Some(device) = device() else { return };
    println!("on {}", device.name);
    // One warper for all: what is left of a larger picture must not show in a smaller one.
    let warper = std::cell::RefCell::new(Warper::new(&device, FORMAT));
    let measured = Screen { response: Response::Gamma(1.8), ..Screen::default() };
    let drives = [
        Drive::default(),
        Drive::of_screen(&measured, [2, 1, 0]),
        Drive::of_evened(&Screen::default(), [2, 1, 0], Overflow::Soft),
    ];
    proptest!(ProptestConfig::with_cases(60), |((display, source, uv, frame) in scene())| {
        let warper = &mut *warper.borrow_mut();
        let mut map = Map::identity(display[0], display[1]);
        map.uv = uv;
        let warp = Warp::new(&map, source, Filter::Bilinear).unwrap();
        let mut expected = vec![0; 4 * display[0] * display[1]];
        prop_assert!(warper.take_map(&device, &warp, source));
        warper.take_letters(&device, [0, 0], &[]);
        let mut light = LightFrame::default();
        light.decode(&frame, 4).unwrap();
        for drive in &drives {
            warp.apply_light(&light, 4, drive, &mut expected).unwrap();
            warper.take_frame(&device, &light, drive);
            prop_assert_eq!(seen(&drawn(&device, warper, display)), seen(&expected));
        }
        // Text over it, cut off where the picture ends.
        let lines = ["41 frames/s".to_owned(), "eye".to_owned()];
        let reach = extent(&lines);
        let reach = [reach[0].min(display[0]), reach[1].min(display[1])];
        let mut letters = vec![0; reach[0] * reach[1]];
        overlay(&mut letters, reach[0], &lines);
        warper.take_letters(&device, reach, &letters);
        let mut words: Vec<u32> =
            expected.as_chunks::<4>().0.iter().map(|&word| u32::from_le_bytes(word)).collect();
        overlay(&mut words, display[0], &lines);
        let expected: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
        prop_assert_eq!(seen(&drawn(&device, warper, display)), seen(&expected));
    });
}

#[test]
fn only_bilinear_warps_are_taken() {
    let Some(device) = device() else { return };
    let mut warper = Warper::new(&device, FORMAT);
    let sharp = Warp::new(&Map::identity(4, 4), [4, 4], Filter::Sharp).unwrap();
    assert!(!warper.take_map(&device, &sharp, [4, 4]));
}
