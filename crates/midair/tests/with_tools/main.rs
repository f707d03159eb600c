//! midair's files in the hands of the tools that they are for, and theirs in midair's.

mod glasses;
mod map_files;
mod maps;
mod meshes;
mod mpcdi;
mod pictures;
