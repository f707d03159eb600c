//! Which triangles share an edge, and which share a corner smoothly.

use std::collections::HashMap;

/// In the place of a triangle where there is none.
pub(in crate::geometry) const NONE: u32 = u32::MAX;

/// For each triangle the ones across the edges opposite its corners, wound alike; [`NONE`] where there is none.
pub(in crate::geometry) fn neighbours(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut edges: HashMap<(u32, u32), u32> = HashMap::with_capacity(3 * triangles.len());
    let edge = |t: &[u32; 3], opposite: usize| (t[(opposite + 1) % 3], t[(opposite + 2) % 3]);
    for (index, t) in triangles.iter().enumerate() {
        for opposite in 0..3 {
            edges.insert(edge(t, opposite), index as u32);
        }
    }
    let across = |t: &[u32; 3], opposite| {
        let (from, to) = edge(t, opposite);
        edges.get(&(to, from)).copied().unwrap_or(NONE)
    };
    triangles.iter().map(|t| [0, 1, 2].map(|opposite| across(t, opposite))).collect()
}

/// Disjoint sets of numbers (Tarjan 1975, with path halving).
pub(in crate::geometry) struct Sets(Vec<u32>);

impl Sets {
    /// Each of the numbers below `count` by itself.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The number that stands for a number's set.
    pub fn of(&mut self, mut item: u32) -> u32 {
        while self.0[item as usize] != item {
            let above = self.0[item as usize];
            self.0[item as usize] = self.0[above as usize];
            item = above;
        }
        item
    }

    /// Makes the sets of two numbers one.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        // The lower number stands for both: the result does not depend on the order.
        self.0[a.max(b) as usize] = a.min(b);
    }
}
