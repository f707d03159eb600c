//! MPCDI 2.0 (VESA), 2D profile: a zip of an XML description, a PFM and an alpha PNG.

use super::exr_channels::{MAX_PIXELS, check_size};
use super::png::{coverage, decode_samples, encode_png};
use super::{FileError, LoadedMap, Put, answer};
use crate::map::{Map, Status};
use image::ExtendedColorType;
use std::io::{self, Cursor, Read, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

const DESCRIPTION: &str = "mpcdi.xml";

pub(super) fn write(
    map: &Map,
    source: [usize; 2],
    path: &Path,
    put: &mut Put<'_>,
) -> Result<(), FileError> {
    let mut alpha = Vec::new();
    let cover = coverage(map);
    encode_png(&mut alpha, path, (map.width, map.height), &cover, ExtendedColorType::L8)?;
    // A negative scale says little-endian. The rows run from the top, unlike other PFM files.
    let mut warp = format!("PF\n{} {}\n-1.0\n", map.width, map.height).into_bytes();
    for &uv in &map.uv {
        let [x, y] = answer(uv).map_or([f32::NAN; 2], |[u, v]| [u as f32, (1.0 - v) as f32]);
        warp.extend([x, y, 1.0].map(f32::to_le_bytes).as_flattened());
    }
    let description = describe(map, source);
    // Packed in memory: an archive that cannot be finished, because the disk is full, says so by itself on standard error.
    let fill = || -> io::Result<Vec<u8>> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default();
        for (name, data) in [
            (DESCRIPTION, description.as_bytes()),
            ("region1.pfm", &warp),
            ("region1_alpha.png", &alpha),
        ] {
            archive.start_file(name, options)?;
            archive.write_all(data)?;
        }
        Ok(archive.finish()?.into_inner())
    };
    let packed = fill().map_err(|error| FileError::io(path, "write", error))?;
    put(path, &packed)
}

fn describe(map: &Map, source: [usize; 2]) -> String {
    let ([source_width, source_height], width, height) = (source, map.width, map.height);
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<MPCDI profile="2d" geometry="1" color="1" date="" version="2.0">
  <display>
    <buffer id="buffer1" Xresolution="{source_width}" Yresolution="{source_height}">
      <region id="region1" Xresolution="{width}" Yresolution="{height}" x="0" y="0" xsize="1" ysize="1"/>
    </buffer>
  </display>
  <files>
    <fileset region="region1">
      <geometryWarpFile>
        <path>region1.pfm</path>
        <interpolation>linear</interpolation>
      </geometryWarpFile>
      <alphaMap>
        <path>region1_alpha.png</path>
        <componentDepth>1</componentDepth>
        <bitDepth>8</bitDepth>
        <gammaEmbedded>1.0</gammaEmbedded>
      </alphaMap>
    </fileset>
  </files>
</MPCDI>
"#
    )
}

/// Reads the warp of a region; without a name, of the only one there is.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    region: Option<&str>,
) -> Result<LoadedMap, FileError> {
    let remedy = "export the MPCDI file again";
    let bad = |place: &str, problem: String| FileError::malformed(path, place, problem, remedy);
    let mut archive =
        ZipArchive::new(Cursor::new(bytes)).map_err(|error| bad("archive", error.to_string()))?;
    let description = member(&mut archive, path, DESCRIPTION, 1 << 24)?;
    let description =
        String::from_utf8(description).map_err(|error| bad(DESCRIPTION, error.to_string()))?;
    let document = roxmltree::Document::parse(&description)
        .map_err(|error| bad(DESCRIPTION, error.to_string()))?;
    let root = document.root_element();
    match root.attribute("profile") {
        Some(profile) if profile.eq_ignore_ascii_case("2d") => {}
        other => {
            let problem = format!(
                "it is of the profile `{}`, whose warps are not places in a picture",
                other.unwrap_or("(none)")
            );
            return Err(FileError::unsupported(
                path,
                problem,
                "export it in the 2D profile (profile=\"2d\")",
            ));
        }
    }
    let elements =
        |tag: &'static str| document.descendants().filter(move |node| node.has_tag_name(tag));
    let regions: Vec<&str> = elements("region").filter_map(|node| node.attribute("id")).collect();
    let id = match (region, &regions[..]) {
        (Some(wanted), _) if regions.contains(&wanted) => wanted,
        (None, [only]) => only,
        (None, []) => return Err(bad(DESCRIPTION, "it names no region".into())),
        (wanted, _) => {
            let problem = match wanted {
                Some(wanted) => format!("it has no region {wanted}, but {}", regions.join(", ")),
                None => format!(
                    "it has {} regions, one for each projector: {}",
                    regions.len(),
                    regions.join(", ")
                ),
            };
            return Err(FileError::unsupported(path, problem, "say which one by --region"));
        }
    };
    let about = elements("region").find(|node| node.attribute("id") == Some(id));
    let set = elements("fileset").find(|node| node.attribute("region") == Some(id));
    let named = |tag: &str| {
        let element = set?.descendants().find(|node| node.has_tag_name(tag))?;
        let file = element.children().find(|node| node.has_tag_name("path"))?;
        file.text().map(|text| text.trim().to_owned())
    };
    let Some(warp_name) = named("geometryWarpFile") else {
        return Err(bad(DESCRIPTION, format!("it names no geometryWarpFile for the region {id}")));
    };
    let warp = member(&mut archive, path, &warp_name, MAX_PIXELS * 12 + 256)?;
    let (width, height, values) = parse_pfm(path, &warp_name, &warp)?;
    // Some write XResolution for Xresolution.
    let told = |key: &str| {
        let mut attributes = about?.attributes();
        let attribute = attributes.find(|attribute| attribute.name().eq_ignore_ascii_case(key))?;
        Some(attribute.value().trim())
    };
    let pixels = |key: &str| told(key)?.parse::<usize>().ok();
    if let (Some(across), Some(down)) = (pixels("Xresolution"), pixels("Yresolution"))
        && (across, down) != (width, height)
    {
        let problem = format!(
            "{warp_name} has {width} x {height} points for a region of {across} x {down} pixels: a coarse grid, which is not read"
        );
        return Err(FileError::unsupported(
            path,
            problem,
            "export a warp with a point for each pixel",
        ));
    }
    // The warp says places in the region's part of the source, from the source's upper left corner.
    let share = |key: &str, usual: f64| match told(key) {
        None => Ok(usual),
        Some(text) => text.parse::<f64>().ok().filter(|share| share.is_finite()).ok_or_else(|| {
            bad(DESCRIPTION, format!("the region {id} has {key}=\"{text}\", which is no number"))
        }),
    };
    let [left, top] = [share("x", 0.0)?, share("y", 0.0)?];
    let [across, down] = [share("xsize", 1.0)?, share("ysize", 1.0)?];
    if across <= 0.0 || down <= 0.0 {
        let problem = format!("the region {id} has no extent: xsize {across}, ysize {down}");
        return Err(bad(DESCRIPTION, problem));
    }
    let cover = match named("alphaMap") {
        None => None,
        Some(name) => {
            let file = member(&mut archive, path, &name, MAX_PIXELS * 8)?;
            let image = decode_samples(path, &file)?;
            if (image.width() as usize, image.height() as usize) != (width, height) {
                // A mask of another size is legal and says nothing about single pixels of the warp.
                None
            } else {
                Some(image.into_luma8().into_raw())
            }
        }
    };
    let mut map =
        Map { width, height, uv: Vec::new(), status: Vec::new(), error_bound: f64::INFINITY };
    for (i, &[x, y, _]) in values.iter().enumerate() {
        let uv = answer([left + across * f64::from(x), 1.0 - (top + down * f64::from(y))]);
        let shown = cover.as_ref().is_none_or(|cover| cover[i] > 0);
        map.uv.push(uv.unwrap_or([f64::NAN; 2]));
        map.status.push(if uv.is_some() && shown { Status::Ok } else { Status::Outside });
    }
    Ok(LoadedMap::new(map))
}

/// A file of the archive, of at most `limit` bytes.
fn member(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    path: &Path,
    name: &str,
    limit: u64,
) -> Result<Vec<u8>, FileError> {
    let bad =
        |problem: String| FileError::malformed(path, name, problem, "export the MPCDI file again");
    // Names are told apart by case in some archives and not on some systems, which also write other slashes.
    let plain = |name: &str| name.replace('\\', "/").trim_start_matches("./").to_lowercase();
    let known = {
        let mut names = archive.file_names().filter_map(Result::ok);
        names.find(|known| plain(known) == plain(name)).map(|known| known.into_owned())
    };
    let file = archive
        .by_name(known.as_deref().unwrap_or(name))
        .map_err(|error| bad(error.to_string()))?;
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|error| bad(error.to_string()))?;
    if bytes.len() as u64 > limit {
        return Err(bad(format!("it unpacks to more than {limit} bytes")));
    }
    Ok(bytes)
}

/// Width, height and pixels of a three-channel PFM, first row first.
fn parse_pfm(
    path: &Path,
    name: &str,
    bytes: &[u8],
) -> Result<(usize, usize, Vec<[f32; 3]>), FileError> {
    let bad = |problem: String| {
        FileError::malformed(path, name, problem, "export a three-channel PFM (PF)")
    };
    let mut at = 0;
    let mut fields = Vec::new();
    while fields.len() < 4 {
        let skipped = bytes[at..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        at += skipped;
        let length = bytes[at..].iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        let field = std::str::from_utf8(&bytes[at..at + length.min(32)]).unwrap_or_default();
        if field.is_empty() {
            return Err(bad("its header ends early".into()));
        }
        fields.push(field);
        at += length;
    }
    let (Ok(width), Ok(height), Ok(scale)) =
        (fields[1].parse::<u64>(), fields[2].parse::<u64>(), fields[3].parse::<f64>())
    else {
        return Err(bad("its header has no width, height and scale".into()));
    };
    if fields[0] != "PF" {
        return Err(bad(format!("it begins with {}, not with PF", fields[0])));
    }
    check_size(path, width, height)?;
    let needed = (width * height * 12) as usize;
    // One white space ends the header: a line feed, or a carriage return with it as some systems write them.
    let feed = 1 + usize::from(bytes[at..].starts_with(b"\r\n"));
    let starts = [at + 1, at + feed];
    let fits = |&&start: &&usize| bytes.len() == start + needed;
    let Some(&start) = starts.iter().find(fits) else {
        let there = bytes.len().saturating_sub(at + feed);
        return Err(bad(format!(
            "{there} bytes are there, not the {needed} that its header speaks of"
        )));
    };
    let data = &bytes[start..];
    let convert = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let floats: Vec<f32> =
        data[..needed].as_chunks::<4>().0.iter().map(|&bytes| convert(bytes)).collect();
    Ok((width as usize, height as usize, floats.as_chunks::<3>().0.to_vec()))
}
