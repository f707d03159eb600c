//! The grammar of solids that a profile sweeps, and of hollow ones.

use super::grammar::{
    ABSORPTION, Block, CAUCHY, IOR, KIND, Key, Kind, LARGEST, Need, SIZE, SMALLEST, block,
    optional, required, size,
};

/// Of a conic constant: far beyond any that is ground.
const CONIC: f64 = 1e6;
/// Of an aspheric coefficient.
const TERM: f64 = 1e6;

const SMOOTH: Key = optional(
    "smooth",
    Kind::Flag,
    None,
    Need::Flag(false),
    "true: arcs that join without a bend lead through the points, and a point that is given twice is a corner; false: straight lines.",
);

pub(super) static HEMISPHERE: Block = block(
    "a hemisphere",
    "Half a ball: its flat side at local y = 0, its dome towards +y.",
    &[KIND, size("radius", "Radius.")],
);

pub(super) static TORUS: Block = block(
    "a torus",
    "A ring about local y.",
    &[
        KIND,
        size("radius", "From the axis to the middle of the tube."),
        size("tube", "Radius of the tube, less than `radius`."),
    ],
);

pub(super) static LENS: Block = block(
    "a lens",
    "A lens of two surfaces of revolution; its axis is local z, its middle the origin.",
    &[
        KIND,
        required(
            "radii",
            Kind::Numbers(2, -LARGEST, LARGEST),
            Some("mm"),
            "Radii of curvature of the surface on the +z side and of the other; positive bulges outwards, negative is hollow, 0 is flat.",
        ),
        size("thickness", "Thickness on the axis."),
        size("diameter", "Diameter."),
        optional(
            "conic",
            Kind::Numbers(2, -CONIC, CONIC),
            None,
            Need::Numbers(&[0.0, 0.0]),
            "Conic constants of the two surfaces: 0 a sphere, -1 a paraboloid.",
        ),
        optional(
            "aspheric_front",
            Kind::List(-TERM, TERM),
            Some("mm^-3, mm^-5, ..."),
            Need::Numbers(&[]),
            "a4, a6, ... of the surface on the +z side: its fall from the vertex has a4 r^4 + a6 r^6 + ... more.",
        ),
        optional(
            "aspheric_back",
            Kind::List(-TERM, TERM),
            Some("mm^-3, mm^-5, ..."),
            Need::Numbers(&[]),
            "The same of the other surface.",
        ),
    ],
);

pub(super) static LATHE: Block = block(
    "a lathe",
    "A profile turned about local y: a bottle, a bowl, a wine glass.",
    &[
        KIND,
        required(
            "profile",
            Kind::Points(2, -LARGEST, LARGEST),
            Some("mm"),
            "Points [distance from the axis, y], from one end to the other; ends off the axis are closed by flat faces; a profile that ends \
             where it began is a ring.",
        ),
        SMOOTH,
    ],
);

pub(super) static PRISM: Block = block(
    "a prism",
    "An outline in local x and y, moved along local z: a wedge, a letter, a bent sheet.",
    &[
        KIND,
        required(
            "outline",
            Kind::Points(3, -LARGEST, LARGEST),
            Some("mm"),
            "Points [x, y] around it.",
        ),
        size("depth", "Length along local z; its middle is z = 0."),
        SMOOTH,
    ],
);

pub(super) const WALL: Key = optional(
    "wall",
    SIZE,
    Some("mm"),
    Need::Optional,
    "It is hollow, its wall as thick everywhere; inside is air, or what `fill` says. Left out: it is solid.",
);

pub(super) const OPEN: Key = optional(
    "open",
    Kind::Flag,
    None,
    Need::Flag(false),
    "With `wall`: whether its flat top has no wall, as a tumbler's.",
);

pub(super) const FILL: Key = optional(
    "fill",
    Kind::Block(&LIQUID),
    None,
    Need::Optional,
    "With `wall`: the liquid in it; left out: air.",
);

static LIQUID: Block = Block {
    name: "a fill",
    about: "A liquid in a hollow solid: exactly one of ior, glass and cauchy, and its height.",
    keys: &[
        optional(
            "height",
            Kind::Number(SMALLEST, LARGEST),
            Some("mm"),
            Need::Optional,
            "How high it stands over the lowest place of the inside; left out: it is full.",
        ),
        IOR,
        optional(
            "glass",
            Kind::Glass,
            None,
            Need::Optional,
            "A substance of the catalogue, with dispersion, such as \"water\".",
        ),
        CAUCHY,
        ABSORPTION,
    ],
    exactly_one: &[&["ior", "glass", "cauchy"]],
};
