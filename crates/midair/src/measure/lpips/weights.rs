//! Where weights are, and whether they are the right ones.

use std::path::{Path, PathBuf};

use safetensors::{Dtype, SafeTensors};
use sha2::{Digest, Sha256};

use super::network::Tensors;
use super::{Backbone, LpipsError};

impl Backbone {
    fn file_name(self) -> &'static str {
        match self {
            Self::Alex => "lpips_alex.safetensors",
            Self::Squeeze => "lpips_squeeze.safetensors",
        }
    }

    /// SHA-256 over the tensors in the order of their names: name, a zero byte, the number of
    /// dimensions and each of them (64 bits), the values in single precision; all little-endian. It holds
    /// for any file of the same values, in whatever order or precision they are stored.
    fn digest(self) -> &'static str {
        match self {
            Self::Alex => "3544c71c97c72bd2c20e26471f31a8bf75ad9e482133458d9fb47de8a0ac0b40",
            Self::Squeeze => "18c8d93dd444f28bf3e5f6df8c6ad91fee18c081a4c378bed6d34a4cb06799c3",
        }
    }
}

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

/// Where a network's weights are kept.
pub(super) fn cached(backbone: Backbone) -> PathBuf {
    cache_folder().join("lpips").join(backbone.file_name())
}

/// The tensors of a safetensors file, checked against the known digest.
pub(super) fn read(backbone: Backbone, path: &Path) -> Result<Tensors, LpipsError> {
    let wrong = |problem: String| LpipsError::WrongWeights { path: path.to_owned(), problem };
    let bytes = std::fs::read(path)
        .map_err(|source| LpipsError::Unreadable { path: path.to_owned(), source })?;
    let tensors = parse(&bytes).map_err(wrong)?;
    if digest(&tensors) != backbone.digest() {
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
