//! Lattice displacement, SSIM, LPIPS, the tables of an evaluation.
