//! A file's name from another folder.

use std::path::{Component, Path, PathBuf};

/// How a file that `name` names from the folder `from` is named from the folder `to`, with forward slashes: by steps up and down where both folders are
/// there, else by all of its path.
pub fn renamed(name: &Path, from: &Path, to: &Path) -> PathBuf {
    let here = |folder: &Path| {
        if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() }
    };
    if name.is_absolute() {
        return name.to_owned();
    }
    let (Ok(from), Ok(to)) = (here(from).canonicalize(), here(to).canonicalize()) else {
        return std::path::absolute(here(from).join(name)).unwrap_or_else(|_| name.to_owned());
    };
    if from == to {
        return name.to_owned();
    }
    // The name's own steps up are taken, so that none stands between steps down.
    let mut file = from;
    for part in name.components() {
        match part {
            Component::ParentDir => drop(file.pop()),
            Component::CurDir => {}
            part => file.push(part),
        }
    }
    let shared = file.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = to.components().skip(shared).map(|_| "..".to_owned());
    let down =
        file.components().skip(shared).map(|part| part.as_os_str().to_string_lossy().into_owned());
    if shared == 0 { file } else { PathBuf::from(up.chain(down).collect::<Vec<_>>().join("/")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_found_from_the_other_folder() {
        let root = tempfile::tempdir().unwrap();
        let folder = |name: &str| {
            let path = root.path().join(name);
            std::fs::create_dir_all(&path).unwrap();
            path
        };
        let (scenes, meshes, out) =
            (folder("a/scenes"), folder("a/meshes"), folder("a/scenes/out/deep"));
        std::fs::write(meshes.join("gem.obj"), "x").unwrap();
        let name = Path::new("../meshes/gem.obj");
        for (to, expected) in [
            (&out, "../../../meshes/gem.obj"),
            (&scenes, "../meshes/gem.obj"),
            (&meshes, "gem.obj"),
        ] {
            let found = renamed(name, &scenes, to);
            assert_eq!(found, Path::new(expected));
            assert_eq!(std::fs::read(to.join(&found)).unwrap(), b"x");
        }
        let absolute = meshes.join("gem.obj");
        assert_eq!(renamed(&absolute, &scenes, &out), absolute);
    }
}
