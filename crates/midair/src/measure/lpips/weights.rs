//! Where weights are, and whether they are the right ones.

use std::path::{Path, PathBuf};

use safetensors::{Dtype, SafeTensors};
use sha2::{Digest, Sha256};

use super::LpipsError;
use super::network::Tensors;

/// SHA-256 over the tensors in the order of their names: name, a zero byte, the number of
/// dimensions and each of them (64 bits), the values in single precision; all little-endian. It holds
/// for any file of the same values, in whatever order or precision they are stored.
const DIGEST: &str = "3544c71c97c72bd2c20e26471f31a8bf75ad9e482133458d9fb47de8a0ac0b40";

/// The folder for what was fetched once: `$MIDAIR_CACHE`, or else `midair` in `$XDG_CACHE_HOME`, or
/// else `~/.cache/midair` (`%LOCALAPPDATA%\midair` where there is no `$HOME`).
pub fn cache_folder() -> PathBuf {
    let named = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let home = || {
        let cache = named("HOME").map(|home| PathBuf::from(home).join(".cache"));
        cache.or_else(|| named("LOCALAPPDATA").map(PathBuf::from))
    };
    if let Some(own) = named("MIDAIR_CACHE") {
        return own.into();
    }
    let shared = named("XDG_CACHE_HOME").map(PathBuf::from).or_else(home);
    shared.unwrap_or_else(std::env::temp_dir).join("midair")
}

/// Where the weights are kept.
pub(super) fn cached() -> PathBuf {
    cache_folder().join("lpips").join("lpips_alex.safetensors")
}

/// The tensors of a safetensors file, checked against the known digest.
pub(super) fn read(path: &Path) -> Result<Tensors, LpipsError> {
    let wrong = |problem: String| LpipsError::WrongWeights { path: path.to_owned(), problem };
    let bytes = std::fs::read(path)
        .map_err(|source| LpipsError::Unreadable { path: path.to_owned(), source })?;
    let tensors = parse(&bytes).map_err(wrong)?;
    if digest(&tensors) != DIGEST {
        return Err(wrong("its values are not those of LPIPS v0.1".to_owned()));
    }
    Ok(tensors)
}

fn parse(bytes: &[u8]) -> Result<Tensors, String> {
    let file = SafeTensors::deserialize(bytes)
        .map_err(|error| format!("not a whole safetensors file ({error})"))?;
    let mut tensors = Tensors::new();
    for (name, view) in file.tensors() {
        let data = view.data();
        let values = match view.dtype() {
            Dtype::F32 => {
                data.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
            }
            Dtype::F16 => {
                let half = |bytes: &[u8; 2]| half::f16::from_le_bytes(*bytes).to_f32();
                data.as_chunks().0.iter().map(half).collect()
            }
            other => return Err(format!("{name} is stored as {other:?}")),
        };
        tensors.insert(name, (view.shape().to_vec(), values));
    }
    Ok(tensors)
}

fn digest(tensors: &Tensors) -> String {
    let mut names: Vec<&String> = tensors.keys().collect();
    names.sort();
    let mut hash = Sha256::new();
    for name in names {
        let (shape, values) = &tensors[name];
        hash.update(name.as_bytes());
        hash.update([0]);
        hash.update((shape.len() as u64).to_le_bytes());
        for length in shape {
            hash.update((*length as u64).to_le_bytes());
        }
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        hash.update(bytes);
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
