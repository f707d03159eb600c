//! The scene file's grammar, said once: the reader, the messages and the JSON Schema follow it. One long table, whole in one file, so that what a
//! scene may say is found in one place.

use super::devices;
use super::grammar_of_solids as solids;

/// A named set of keys.
pub struct Block {
    /// What people call it, with its article.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub about: &'static str,
    /// The keys that it may have.
    pub keys: &'static [Key],
    /// Sets of keys of which exactly one is given.
    pub exactly_one: &'static [&'static [&'static str]],
}

/// A key of a block.
pub struct Key {
    /// As it is written.
    pub name: &'static str,
    /// What its value may be.
    pub kind: Kind,
    /// The unit of its numbers.
    pub unit: Option<&'static str>,
    /// Whether it must be given.
    pub need: Need,
    /// What it means, in a sentence.
    pub about: &'static str,
}

/// Whether a key must be given, and what it means when it is not.
pub enum Need {
    /// It must be given.
    Required,
    /// Left out, it means what `about` says.
    Optional,
    /// A number stands for it.
    Number(f64),
    /// Numbers stand for it.
    Numbers(&'static [f64]),
    /// A whole number stands for it.
    Integer(i64),
    /// Whole numbers stand for it.
    Integers(&'static [i64]),
    /// True or false stands for it.
    Flag(bool),
    /// A text stands for it.
    Text(&'static str),
}

/// What a key's value may be. Bounds are inclusive.
pub enum Kind {
    /// A text.
    Text,
    /// The name of a file.
    File,
    /// True or false.
    Flag,
    /// A number.
    Number(f64, f64),
    /// A whole number.
    Integer(i64, i64),
    /// A list of `len` numbers.
    Numbers(usize, f64, f64),
    /// A list of `len` whole numbers.
    Integers(usize, i64, i64),
    /// A number, or three for red, green and blue.
    Colour(f64, f64),
    /// A list of rows of numbers, all of one length.
    Rows(f64, f64),
    /// A list of numbers, of any length.
    List(f64, f64),
    /// A list of at least so many points, each of two numbers.
    Points(usize, f64, f64),
    /// One of these texts.
    Choice(&'static [&'static str]),
    /// A glass of the catalogue.
    Glass,
    /// A block.
    Block(&'static Block),
    /// A list of blocks.
    Blocks(&'static Block),
    /// A block whose key `kind` says which.
    Variants(&'static [(&'static str, &'static Block)]),
}

impl Kind {
    /// Whether it holds keys itself.
    pub fn is_block(&self) -> bool {
        matches!(self, Self::Block(_) | Self::Blocks(_) | Self::Variants(_))
    }

    /// The key of this name in it; of shapes the first that has it.
    fn key(&self, name: &str) -> Option<&'static Key> {
        match self {
            Self::Block(block) | Self::Blocks(block) => block.key(name),
            Self::Variants(variants) => variants.iter().find_map(|(_, block)| block.key(name)),
            _ => None,
        }
    }
}

impl Block {
    fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }
}

/// The key that is reached by these names from the outermost block.
pub(super) fn key<'a>(mut names: impl Iterator<Item = &'a str>) -> Option<&'static Key> {
    let first = SCENE.key(names.next()?)?;
    names.try_fold(first, |key, name| key.kind.key(name))
}

/// Bounds of a size in mm: a nanometre to a kilometre. Beyond them lies a mistyped unit, and
/// arithmetic that runs out of digits.
pub(super) const SMALLEST: f64 = 1e-6;
pub(super) const LARGEST: f64 = 1e6;
pub(super) const SIZE: Kind = Kind::Number(SMALLEST, LARGEST);
/// Bound of an index of refraction: vacuum to beyond germanium.
pub(super) const INDEX: (f64, f64) = (1.0, 5.0);

/// A key that must be given.
pub const fn required(
    name: &'static str,
    kind: Kind,
    unit: Option<&'static str>,
    about: &'static str,
) -> Key {
    Key { name, kind, unit, need: Need::Required, about }
}

/// A key that may be left out.
pub const fn optional(
    name: &'static str,
    kind: Kind,
    unit: Option<&'static str>,
    need: Need,
    about: &'static str,
) -> Key {
    Key { name, kind, unit, need, about }
}

pub(super) const fn size(name: &'static str, about: &'static str) -> Key {
    required(name, SIZE, Some("mm"), about)
}

const fn rectangle_size(about: &'static str) -> Key {
    required("size", Kind::Numbers(2, SMALLEST, LARGEST), Some("mm"), about)
}

const POSITION: Key = optional(
    "position",
    Kind::Numbers(3, -LARGEST, LARGEST),
    Some("mm"),
    Need::Numbers(&[0.0, 0.0, 0.0]),
    "Where its origin stands: x right, y up, z towards the viewer.",
);
const ROTATION: Key = optional(
    "rotation",
    Kind::Numbers(3, -36_000.0, 36_000.0),
    Some("degrees"),
    Need::Numbers(&[0.0, 0.0, 0.0]),
    "How it is turned: Rx*Ry*Rz of these angles.",
);
pub(super) const KIND: Key = required("kind", Kind::Text, None, "Which shape it is.");
const FACING: Key = required(
    "facing",
    Kind::Choice(&["convex", "concave"]),
    None,
    "Which way it curves, seen from its local +z side.",
);

/// A block of which no key excludes another.
pub const fn block(name: &'static str, about: &'static str, keys: &'static [Key]) -> Block {
    Block { name, about, keys, exactly_one: &[] }
}

pub(super) static SCENE: Block = block(
    "the scene",
    "A mid-air display: the viewpoint, the image, the plate, the display and the elements. \
     Millimetres, degrees, right-handed, +y up.",
    &[
        optional(
            "$schema",
            Kind::Text,
            None,
            Need::Optional,
            "Where an editor finds this schema; midair does not read it.",
        ),
        optional(
            "name",
            Kind::Text,
            None,
            Need::Optional,
            "What people call it; default: the file's name.",
        ),
        optional(
            "max_interactions",
            Kind::Integer(1, 10_000),
            None,
            Need::Integer(32),
            "The most interactions that one path may have.",
        ),
        optional(
            "follow_total_reflection",
            Kind::Flag,
            None,
            Need::Flag(false),
            "Whether paths are followed through total internal reflection; otherwise they end there.",
        ),
        required(
            "viewpoint",
            Kind::Block(&VIEWPOINT),
            None,
            "The eye that the image is compensated for.",
        ),
        required("image", Kind::Block(&IMAGE), None, "The undistorted mid-air image."),
        required("plate", Kind::Block(&PLATE), None, "The micro-mirror array plate."),
        optional(
            "display",
            Kind::Block(&DISPLAY),
            None,
            Need::Optional,
            "The light source; left out: 1024 x 1024 pixels where it belongs.",
        ),
        optional(
            "element",
            Kind::Blocks(&ELEMENT),
            None,
            Need::Optional,
            "The distortive objects, in any order.",
        ),
        optional(
            "tracker",
            Kind::Block(&TRACKER),
            None,
            Need::Optional,
            "What tells the live show where the viewer is.",
        ),
    ],
);

static TRACKER: Block = block(
    "the tracker",
    "A head tracker, for `midair play --track`: where its own frame stands in the scene.",
    &[
        POSITION,
        ROTATION,
        optional(
            "offset",
            Kind::Numbers(3, -LARGEST, LARGEST),
            Some("mm"),
            Need::Numbers(&[0.0, 0.0, 0.0]),
            "From the point that it tracks to the eye, along the scene's axes.",
        ),
    ],
);

static VIEWPOINT: Block = block(
    "the viewpoint",
    "One eye, or a camera; the compensation is exact for this point.",
    &[required("position", Kind::Numbers(3, -LARGEST, LARGEST), Some("mm"), "Where the eye is.")],
);

static IMAGE: Block = block(
    "the image",
    "The undistorted mid-air image: a rectangle whose front (local +z) faces the viewer.",
    &[POSITION, ROTATION, rectangle_size("Width and height.")],
);

static PLATE: Block = block(
    "the plate",
    "The micro-mirror array plate; its normal is local +z and faces the image.",
    &[
        POSITION,
        ROTATION,
        rectangle_size("Width and height."),
        optional(
            "model",
            Kind::Choice(&["ideal", "slit-mirror"]),
            None,
            Need::Text("ideal"),
            "How it treats light: plane symmetry without loss, or two crossed layers of slit mirrors.",
        ),
        optional(
            "pitch",
            SIZE,
            Some("mm"),
            Need::Number(0.5),
            "slit-mirror: distance between the mirrors of one layer.",
        ),
        optional(
            "layer_depth",
            SIZE,
            Some("mm"),
            Need::Number(1.25),
            "slit-mirror: depth of each of the two layers.",
        ),
        optional(
            "azimuth",
            Kind::Number(-36_000.0, 36_000.0),
            Some("degrees"),
            Need::Number(45.0),
            "slit-mirror: direction of the mirrors of the layer on the viewer's side, from local +x; 45 and -45 are the two orders of \
             the layers.",
        ),
        optional(
            "reflectance",
            Kind::Colour(0.0, 1.0),
            None,
            Need::Number(0.87),
            "slit-mirror: reflectance of one mirror; one number, or linear R, G, B.",
        ),
        optional(
            "ior",
            Kind::Number(INDEX.0, INDEX.1),
            None,
            Need::Number(1.52),
            "slit-mirror: refractive index of the plate's glass.",
        ),
        optional(
            "cover_glass",
            Kind::Number(0.0, LARGEST),
            Some("mm"),
            Need::Number(0.75),
            "slit-mirror: thickness of the cover glass on each face.",
        ),
        optional(
            "glass_absorption",
            Kind::Colour(0.0, 1e6),
            Some("per mm"),
            Need::Number(0.0),
            "slit-mirror: absorption coefficient of the plate's glass; one number, or linear R, G, B.",
        ),
        optional(
            "mirror_thickness",
            Kind::Number(0.0, LARGEST),
            Some("mm"),
            Need::Number(0.0),
            "slit-mirror: thickness of one mirror, whose end stops light; less than the pitch.",
        ),
        optional(
            "luminance",
            Kind::File,
            None,
            Need::Optional,
            "The image's measured luminance over viewing directions: a CSV file (azimuth, elevation, value), relative to \
             the scene file. It replaces the brightness that the model gives to the image.",
        ),
    ],
);

/// The plate's keys that only a slit-mirror plate has.
pub(super) const SLIT_MIRROR_KEYS: [&str; 8] = [
    "pitch",
    "layer_depth",
    "azimuth",
    "reflectance",
    "ior",
    "cover_glass",
    "glass_absorption",
    "mirror_thickness",
];

static DISPLAY: Block = block(
    "the display",
    "The light source. Position and rotation left out, it stands where it belongs with flat \
     mirrors and no solids, so that with no element every pixel st shows at image uv = st.",
    &[
        optional(
            "resolution",
            Kind::Integers(2, 1, 32_768),
            Some("pixels"),
            Need::Integers(&[1024, 1024]),
            "Width and height in pixels.",
        ),
        optional(
            "model",
            Kind::Choice(&devices::DISPLAY_NAMES),
            None,
            Need::Optional,
            "A display that is sold: its resolution and its size, where they are not given.",
        ),
        optional(
            "portrait",
            Kind::Flag,
            None,
            Need::Optional,
            "Whether it is held upright (true) or lies (false): its resolution is turned if need be; left out: as given.",
        ),
        optional(
            "ppi",
            Kind::Number(1.0, 10_000.0),
            Some("pixels per inch"),
            Need::Optional,
            "Its size by how fine its pixels are; instead of `size`.",
        ),
        optional(
            "diagonal_inches",
            Kind::Number(0.1, 1000.0),
            Some("inches"),
            Need::Optional,
            "Its size by the diagonal of its lit area, the pixels square; instead of `size`.",
        ),
        optional(
            "position",
            Kind::Numbers(3, -LARGEST, LARGEST),
            Some("mm"),
            Need::Optional,
            "Where its centre stands; left out with the rotation: where it belongs.",
        ),
        optional(
            "rotation",
            Kind::Numbers(3, -36_000.0, 36_000.0),
            Some("degrees"),
            Need::Optional,
            "How it is turned: Rx*Ry*Rz of these angles; left out with the position: as it belongs.",
        ),
        optional(
            "size",
            Kind::Numbers(2, SMALLEST, LARGEST),
            Some("mm"),
            Need::Optional,
            "Width and height; left out: the image's.",
        ),
        optional(
            "wavelengths",
            Kind::Numbers(3, 380.0, 780.0),
            Some("nm"),
            Need::Numbers(&[611.0, 549.0, 465.0]),
            "What stands for its red, green and blue where an index depends on the wavelength.",
        ),
        optional(
            "gamma",
            Kind::Number(0.2, 10.0),
            None,
            Need::Optional,
            "Its light is its code to this power; left out: sRGB's curve, or what `response` says.",
        ),
        optional(
            "response",
            Kind::File,
            None,
            Need::Optional,
            "Its light by code as measured: a CSV file (code,light or code,red,green,blue), relative to the scene file.",
        ),
        optional(
            "emission",
            Kind::File,
            None,
            Need::Optional,
            "Its radiance by angle from its normal as measured: a CSV file (angle,radiance or angle,red,green,blue), relative to the \
             scene file; left out: alike in all directions (Lambert).",
        ),
        optional(
            "polarisation",
            Kind::Number(-36_000.0, 36_000.0),
            Some("degrees"),
            Need::Optional,
            "Its light is linearly polarised (a liquid crystal display's is): the direction of the electric field, from local +x; \
             left out: unpolarised.",
        ),
        optional(
            "black",
            Kind::Colour(0.0, 0.5),
            None,
            Need::Optional,
            "Light that it emits where it is to be dark, as a share of its white; left out: as measured, else none.",
        ),
        optional(
            "bits",
            Kind::Integer(1, 16),
            None,
            Need::Optional,
            "Bits of one colour's code; left out: as the picture file has them.",
        ),
    ],
);

static ELEMENT: Block = block(
    "an element",
    "A distortive object: a refractive solid, or a reflective surface.",
    &[
        optional(
            "$schema",
            Kind::Text,
            None,
            Need::Optional,
            "Where an editor finds this schema; midair does not read it.",
        ),
        optional(
            "name",
            Kind::Text,
            None,
            Need::Optional,
            "What people call it; default: its shape.",
        ),
        required("shape", Kind::Variants(&SHAPES), None, "Its form, in its own frame."),
        POSITION,
        ROTATION,
        required("material", Kind::Block(&MATERIAL), None, "What it is made of."),
        ABSORPTION,
        optional(
            "priority",
            Kind::Integer(i32::MIN as i64, i32::MAX as i64),
            None,
            Need::Optional,
            "Nested media: the higher one fills where solids overlap; left out: the smaller solid.",
        ),
        solids::WALL,
        solids::OPEN,
        solids::FILL,
    ],
);

pub(super) const ABSORPTION: Key = optional(
    "absorption",
    Kind::Colour(0.0, 1e6),
    Some("per mm"),
    Need::Optional,
    "Refractive solids: absorption coefficient; one number, or linear R, G, B; left out: as the glass file says, else none.",
);

pub(super) const IOR: Key = optional(
    "ior",
    Kind::Number(INDEX.0, INDEX.1),
    None,
    Need::Optional,
    "Refractive index, the same for every wavelength.",
);

pub(super) const CAUCHY: Key = optional(
    "cauchy",
    Kind::Numbers(2, -1.0, INDEX.1),
    None,
    Need::Optional,
    "A and B of n = A + B / lambda^2, lambda in micrometres.",
);

static MATERIAL: Block = Block {
    name: "a material",
    about: "What an element is made of: exactly one of ior, glass, cauchy, file, mirror and opaque.",
    keys: &[
        IOR,
        optional("glass", Kind::Glass, None, Need::Optional, "A catalogue glass, with dispersion."),
        CAUCHY,
        optional(
            "file",
            Kind::File,
            None,
            Need::Optional,
            "A glass with dispersion: a YAML file as refractiveindex.info has them, relative to the scene file. Its k is the absorption \
             where the scene gives none.",
        ),
        optional("mirror", Kind::Flag, None, Need::Optional, "true: a reflective surface."),
        optional(
            "opaque",
            Kind::Flag,
            None,
            Need::Optional,
            "true: it stops all light, as a label, a stand or a frame does.",
        ),
        optional(
            "reflectance",
            Kind::Colour(0.0, 1.0),
            None,
            Need::Number(1.0),
            "Mirrors: one number, or linear R, G, B.",
        ),
        ABSORPTION,
    ],
    exactly_one: &[&["ior", "glass", "cauchy", "file", "mirror", "opaque"]],
};

static SHAPES: [(&str, &Block); 15] = [
    ("sphere", &block("a sphere", "A ball.", &[KIND, size("radius", "Radius.")])),
    (
        "ellipsoid",
        &block(
            "an ellipsoid",
            "A ball stretched along its axes.",
            &[
                KIND,
                required(
                    "radii",
                    Kind::Numbers(3, SMALLEST, LARGEST),
                    Some("mm"),
                    "Semi-axes along local x, y and z.",
                ),
            ],
        ),
    ),
    (
        "box",
        &block(
            "a box",
            "A block.",
            &[
                KIND,
                required(
                    "size",
                    Kind::Numbers(3, SMALLEST, LARGEST),
                    Some("mm"),
                    "Edge lengths along local x, y and z.",
                ),
            ],
        ),
    ),
    (
        "cylinder",
        &block(
            "a cylinder",
            "A capped cylinder about local y.",
            &[KIND, size("radius", "Radius."), size("height", "Length along local y.")],
        ),
    ),
    (
        "cone",
        &block(
            "a cone",
            "A capped cone or frustum about local y.",
            &[
                KIND,
                size("radius", "Radius at the bottom (-y) end."),
                optional(
                    "top_radius",
                    Kind::Number(0.0, LARGEST),
                    Some("mm"),
                    Need::Number(0.0),
                    "Radius at the top (+y) end; 0: a pointed cone.",
                ),
                size("height", "Length along local y."),
            ],
        ),
    ),
    ("hemisphere", &solids::HEMISPHERE),
    ("torus", &solids::TORUS),
    ("lens", &solids::LENS),
    ("lathe", &solids::LATHE),
    ("prism", &solids::PRISM),
    (
        "plane",
        &block(
            "a plane",
            "A flat mirror; its normal is local +z.",
            &[KIND, rectangle_size("Width and height.")],
        ),
    ),
    (
        "cylinder-mirror",
        &block(
            "a cylinder-mirror",
            "A sheet bent about an axis parallel to local y; its middle is the origin, its normal there local +z.",
            &[
                KIND,
                size("radius", "Radius of curvature."),
                rectangle_size("Arc length, and length along local y."),
                FACING,
            ],
        ),
    ),
    (
        "sphere-mirror",
        &block(
            "a sphere-mirror",
            "A cap of a sphere; its middle is the origin, its normal there local +z.",
            &[
                KIND,
                size("radius", "Radius of curvature."),
                size("diameter", "Diameter of the cap's rim."),
                FACING,
            ],
        ),
    ),
    (
        "height-field",
        &Block {
            name: "a height-field",
            about: "A surface z(x, y) over a rectangle: a water surface, an asphere.",
            keys: &[
                KIND,
                optional(
                    "file",
                    Kind::File,
                    None,
                    Need::Optional,
                    "A grey picture (PNG of 8 or 16 bit, or EXR), relative to the scene file; white stands for a sample of 1.",
                ),
                optional(
                    "samples",
                    Kind::Rows(-LARGEST, LARGEST),
                    None,
                    Need::Optional,
                    "Rows of samples, the first row at the +y edge.",
                ),
                rectangle_size("Width and height of the rectangle."),
                size("amplitude", "Height that a sample of 1 stands for."),
                optional(
                    "depth",
                    SIZE,
                    Some("mm"),
                    Need::Optional,
                    "Refractive ones: how far the solid reaches below local z = 0; default: the amplitude.",
                ),
            ],
            exactly_one: &[&["file", "samples"]],
        },
    ),
    (
        "mesh",
        &block(
            "a mesh",
            "A triangle mesh: OBJ, STL, PLY, OFF, glTF or GLB.",
            &[
                KIND,
                required("file", Kind::File, None, "The mesh file, relative to the scene file."),
                optional(
                    "scale",
                    Kind::Number(1e-9, 1e9),
                    None,
                    Need::Number(1.0),
                    "Factor on the file's coordinates.",
                ),
                optional(
                    "unit",
                    Kind::Choice(&["mm", "um", "cm", "m", "in", "ft"]),
                    None,
                    Need::Text("mm"),
                    "The file's unit of length.",
                ),
                optional(
                    "smoothing",
                    Kind::Integer(0, 1000),
                    None,
                    Need::Integer(0),
                    "Steps by which the surface is smoothed, as polishing does to a scan: waves shorter than about ten edges go, the form stays.",
                ),
                optional(
                    "normals",
                    Kind::Choice(&["auto", "smooth", "flat"]),
                    None,
                    Need::Text("auto"),
                    "`auto`: the file's own where they fit, else smooth up to the crease angle and sharp above; `smooth`: over every edge; `flat`: each face's own.",
                ),
                optional(
                    "crease_angle",
                    Kind::Number(0.0, 180.0),
                    Some("degrees"),
                    Need::Number(30.0),
                    "With `normals = \"auto\"`: the edge between two faces whose normals differ by more is sharp.",
                ),
            ],
        ),
    ),
];
