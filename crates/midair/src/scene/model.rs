//! A set-up as it is described in a scene file: plain data, in millimetres and degrees.

use std::path::PathBuf;

pub use crate::optics::plate::SlitMirror;

/// Where a thing stands and how it is turned.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Pose {
    /// Origin in the world, mm.
    pub position: [f64; 3],
    /// Angles in degrees; the rotation is Rx*Ry*Rz.
    pub rotation: [f64; 3],
}

/// A rectangle in space: x right, y up, +z its front normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Its centre and orientation.
    pub pose: Pose,
    /// Width and height, mm.
    pub size: [f64; 2],
}

/// A whole set-up.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What people call it.
    pub name: String,
    /// The most interactions that one path may have (default 32).
    pub max_interactions: usize,
    /// Whether paths are followed through total internal reflection (default false: they end).
    pub follow_total_reflection: bool,
    /// The eye that the image is compensated for, mm.
    pub viewpoint: [f64; 3],
    /// The undistorted mid-air image.
    pub image: Rectangle,
    /// The micro-mirror array plate.
    pub plate: Plate,
    /// The light source.
    pub display: Display,
    /// The distortive objects, in the file's order.
    pub elements: Vec<Element>,
    /// The head tracker of the live show.
    pub tracker: Option<Tracker>,
}

/// A head tracker.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Tracker {
    /// Where its own frame stands.
    pub pose: Pose,
    /// From the point that it tracks to the eye, along the scene's axes, mm.
    pub offset: [f64; 3],
}

/// The micro-mirror array plate.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Where it stands; its normal is local +z.
    pub rectangle: Rectangle,
    /// How it treats light.
    pub model: PlateModel,
    /// A CSV file of measured luminance over viewing directions, relative to the scene file: how bright the mid-air
    /// image is, in place of what the model says.
    pub luminance: Option<PathBuf>,
}

/// How a plate treats light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlateModel {
    /// Plane symmetry, without loss.
    Ideal,
    /// Two crossed layers of slit mirrors.
    SlitMirror(SlitMirror),
}

impl PlateModel {
    /// The slit-mirror plate that it is, of the usual dimensions where it is ideal; and whether they are thus assumed.
    pub fn slit_mirror_or_usual(&self) -> (SlitMirror, bool) {
        match self {
            Self::SlitMirror(parameters) => (*parameters, false),
            Self::Ideal => (SlitMirror::default(), true),
        }
    }
}

impl PlateModel {
    /// Slit mirrors: with its own dimensions, or the usual ones if it has none.
    pub fn or_slit_mirror(self) -> SlitMirror {
        match self {
            Self::Ideal => SlitMirror::default(),
            Self::SlitMirror(parameters) => parameters,
        }
    }
}

/// The light source.
#[derive(Clone, Debug, PartialEq)]
pub struct Display {
    /// Pixels: width, height.
    pub resolution: [usize; 2],
    /// Where it stands; `None`: where it belongs with flat mirrors and no solids.
    pub pose: Option<Pose>,
    /// Width and height in mm; `None`: the image's.
    pub size: Option<[f64; 2]>,
    /// Wavelengths in nm that stand for its red, green and blue.
    pub wavelengths: [f64; 3],
    /// A CSV file of measured radiance over angles, relative to the scene file; `None`: alike in all directions.
    pub emission: Option<PathBuf>,
    /// Direction of its light's electric field from its local +x, degrees; `None`: unpolarised.
    pub polarisation: Option<f64>,
    /// How its codes become light.
    pub response: ResponseSource,
    /// Light that it emits where it is to be dark, by R, G, B, as a share of its white; `None`: as its response was measured, else 0.
    pub black: Option<[f64; 3]>,
    /// Bits of one colour's code; `None`: as the picture file has them.
    pub bits: Option<u32>,
}

/// Where a display's response comes from.
#[derive(Clone, Debug, PartialEq, Default)]
pub enum ResponseSource {
    /// IEC 61966-2-1.
    #[default]
    Srgb,
    /// Light is code to this power.
    Gamma(f64),
    /// A CSV file of measured light, relative to the scene file.
    File(PathBuf),
}

/// A distortive object.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// What people call it.
    pub name: String,
    /// Its form.
    pub shape: Shape,
    /// Where it stands.
    pub pose: Pose,
    /// What it is made of.
    pub material: Material,
    /// Which solid fills where several overlap: the highest; `None`: the smaller solid wins.
    pub priority: Option<i32>,
    /// What is hollow about it; `None`: it is solid.
    pub hollow: Option<Hollow>,
}

/// The inside of a solid that is but a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Hollow {
    /// Thickness of the wall, the same everywhere, mm.
    pub wall: f64,
    /// Whether its top has no wall.
    pub open: bool,
    /// A liquid in it; `None`: air.
    pub fill: Option<Fill>,
}

/// A liquid in a hollow solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Fill {
    /// How high it stands over the lowest place of the inside, mm; `None`: it fills the inside.
    pub height: Option<f64>,
    /// Its refractive index.
    pub index: Index,
    /// Absorption per mm by linear R, G, B.
    pub absorption: [f64; 3],
}

/// Which way a bent mirror curves, seen from its +z side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// The middle stands out towards +z.
    Convex,
    /// The middle is hollow: its edges stand out towards +z.
    Concave,
}

/// How a mesh's normals are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normals {
    /// The file's own where it has them and they fit its faces; elsewhere interpolated over edges of less than the crease angle, and sharp above.
    Auto {
        /// The angle between two faces' normals above which their edge is sharp, degrees.
        crease_angle: f64,
    },
    /// Interpolated from the vertices, over every edge.
    Smooth,
    /// Each face's own.
    Flat,
}

/// The form of an element, in its own frame; lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A ball stretched along its axes.
    Ellipsoid {
        /// Semi-axes along local x, y and z.
        radii: [f64; 3],
    },
    /// A block.
    Box {
        /// Edge lengths along local x, y and z.
        size: [f64; 3],
    },
    /// A capped cylinder about local y.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Length along y.
        height: f64,
    },
    /// A capped cone or frustum about local y.
    Cone {
        /// Radius at the bottom (-y) end.
        radius: f64,
        /// Radius at the top (+y) end; 0 for a pointed cone.
        top_radius: f64,
        /// Length along y.
        height: f64,
    },
    /// Half a ball, its flat side at local y = 0, its dome towards +y.
    Hemisphere {
        /// Radius.
        radius: f64,
    },
    /// A ring about local y.
    Torus {
        /// From the axis to the middle of the tube.
        radius: f64,
        /// Radius of the tube.
        tube: f64,
    },
    /// A lens, its axis local z, its middle at the origin.
    Lens {
        /// Radii of curvature of the surface on the +z side and of the other; positive bulges outwards, negative is hollow, 0 is flat.
        radii: [f64; 2],
        /// Thickness on the axis.
        thickness: f64,
        /// Diameter.
        diameter: f64,
        /// Conic constants of the two surfaces.
        conic: [f64; 2],
        /// a4, a6, ... of the two surfaces, in mm.
        aspheric: [Vec<f64>; 2],
    },
    /// A profile turned about local y.
    Lathe {
        /// Points [distance from the axis, y].
        profile: Vec<[f64; 2]>,
        /// Whether arcs that join without a bend lead through the points; else straight lines.
        smooth: bool,
    },
    /// An outline in local x and y, moved along local z, its middle at z = 0.
    Prism {
        /// Points [x, y] around it.
        outline: Vec<[f64; 2]>,
        /// Length along z.
        depth: f64,
        /// Whether arcs that join without a bend lead through the points; else straight lines.
        smooth: bool,
    },
    /// A flat mirror, normal local +z.
    Plane {
        /// Width and height.
        size: [f64; 2],
    },
    /// A sheet bent about an axis parallel to local y, its middle at the origin.
    CylinderMirror {
        /// Radius of curvature.
        radius: f64,
        /// Arc length, and length along local y.
        size: [f64; 2],
        /// Which way it curves.
        facing: Facing,
    },
    /// A cap of a sphere, its middle at the origin.
    SphereMirror {
        /// Radius of curvature.
        radius: f64,
        /// Diameter of the cap's rim.
        diameter: f64,
        /// Which way it curves.
        facing: Facing,
    },
    /// A surface z(x, y) over a rectangle: a water surface, an asphere.
    HeightField {
        /// Where the samples come from.
        source: HeightSource,
        /// Width and height of the rectangle.
        size: [f64; 2],
        /// Height that a sample of 1 stands for.
        amplitude: f64,
        /// For a refractive one: how far the solid reaches below local z = 0.
        depth: f64,
    },
    /// A triangle mesh.
    Mesh {
        /// OBJ, STL, PLY, OFF, glTF or GLB, relative to the scene file.
        file: PathBuf,
        /// Factor on the file's coordinates.
        scale: f64,
        /// Millimetres in one unit of the file.
        unit: f64,
        /// Steps of smoothing (Taubin 1995).
        smoothing: usize,
        /// How normals are taken.
        normals: Normals,
    },
}

/// Where a height field's samples come from.
#[derive(Clone, Debug, PartialEq)]
pub enum HeightSource {
    /// A grey picture (8 or 16 bit, or EXR), relative to the scene file.
    File(PathBuf),
    /// Rows of samples, the first row at the +y edge.
    Samples(Vec<Vec<f64>>),
}

/// What an element is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// A transparent solid.
    Refractive {
        /// Its refractive index.
        index: Index,
        /// Absorption per mm by linear R, G, B; `None`: as the glass file says at the display's wavelengths, else none.
        absorption: Option<[f64; 3]>,
    },
    /// It stops all light: a label, a stand, a frame.
    Opaque,
    /// A reflective surface.
    Mirror {
        /// Reflectance by linear R, G, B.
        reflectance: [f64; 3],
    },
}

/// A refractive index by wavelength.
#[derive(Clone, Debug, PartialEq)]
pub enum Index {
    /// The same for every wavelength.
    Constant(f64),
    /// n = a + b / lambda^2 with lambda in micrometres.
    Cauchy(f64, f64),
    /// A glass of the built-in catalogue.
    Glass(String),
    /// A YAML file as refractiveindex.info has them, relative to the scene file.
    File(PathBuf),
}
