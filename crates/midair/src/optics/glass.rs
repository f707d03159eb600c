//! A small catalogue of transparent materials, with dispersion.

/// The wavelength that indices are taken at when none is named: the helium d line, micrometres.
pub const DESIGN_WAVELENGTH: f64 = 0.587_56;

/// A transparent material: n^2 = 1 + sum of B_i lambda^2 / (lambda^2 - C_i), lambda in
/// micrometres (Sellmeier 1871).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Its name in the catalogue.
    pub name: &'static str,
    /// What else people call it.
    pub aliases: &'static [&'static str],
    /// The terms' strengths B_i, and C_i in square micrometres; unused terms are zero.
    pub sellmeier: [(f64, f64); 4],
    /// Whose measurement it is.
    pub source: &'static str,
}

impl Glass {
    /// The refractive index against air (water, fused silica and plastics: as measured by the
    /// source) at a wavelength in micrometres.
    ///
    /// Good over the visible, 0.4 to 0.75; NaN inside an absorption band.
    pub fn index(&self, wavelength: f64) -> f64 {
        let squared = wavelength * wavelength;
        let sum: f64 = self.sellmeier.iter().map(|(b, c)| b * squared / (squared - c)).sum();
        (1.0 + sum).sqrt()
    }
}

const SCHOTT: &str = "Schott, optical glass data sheets (1992 to 2017)";
const SULTANOVA: &str =
    "one term fitted to Sultanova, Kasarova, Nikolov, Acta Physica Polonica A 116, 585 (2009)";
const NONE: (f64, f64) = (0.0, 0.0);

/// The catalogue.
pub static GLASSES: [Glass; 13] = [
    Glass {
        name: "N-BK7",
        aliases: &["BK7"],
        sellmeier: [
            (1.03961212, 0.00600069867),
            (0.231792344, 0.0200179144),
            (1.01046945, 103.560653),
            NONE,
        ],
        source: SCHOTT,
    },
    Glass {
        name: "N-BAF10",
        aliases: &[],
        sellmeier: [
            (1.5851495, 0.00926681282),
            (0.143559385, 0.0424489805),
            (1.08521269, 105.613573),
            NONE,
        ],
        source: SCHOTT,
    },
    Glass {
        name: "N-SF5",
        aliases: &[],
        sellmeier: [
            (1.52481889, 0.011254756),
            (0.187085527, 0.0588995392),
            (1.42729015, 129.141675),
            NONE,
        ],
        source: SCHOTT,
    },
    Glass {
        name: "N-SF11",
        aliases: &[],
        sellmeier: [
            (1.73759695, 0.013188707),
            (0.313747346, 0.0623068142),
            (1.89878101, 155.23629),
            NONE,
        ],
        source: SCHOTT,
    },
    Glass {
        name: "SF10",
        aliases: &[],
        sellmeier: [
            (1.61625977, 0.0127534559),
            (0.259229334, 0.0581983954),
            (1.07762317, 116.60768),
            NONE,
        ],
        source: SCHOTT,
    },
    Glass {
        name: "N-SF10",
        aliases: &[],
        sellmeier: [
            (1.62153902, 0.0122241457),
            (0.256287842, 0.0595736775),
            (1.64447552, 147.468793),
            NONE,
        ],
        source: SCHOTT,
    },
    Glass {
        name: "F2",
        aliases: &[],
        sellmeier: [
            (1.34533359, 0.00997743871),
            (0.209073176, 0.0470450767),
            (0.937357162, 111.886764),
            NONE,
        ],
        source: SCHOTT,
    },
    Glass {
        name: "N-F2",
        aliases: &[],
        sellmeier: [
            (1.39757037, 0.00995906143),
            (0.159201403, 0.0546931752),
            (1.2686543, 119.248346),
            NONE,
        ],
        source: SCHOTT,
    },
    Glass {
        name: "fused silica",
        aliases: &["quartz glass", "SiO2"],
        sellmeier: [
            (0.6961663, 0.0684043 * 0.0684043),
            (0.4079426, 0.1162414 * 0.1162414),
            (0.8974794, 9.896161 * 9.896161),
            NONE,
        ],
        source: "Malitson, J. Opt. Soc. Am. 55, 1205 (1965)",
    },
    Glass {
        name: "PMMA",
        aliases: &["acrylic", "plexiglass"],
        sellmeier: [(1.1819, 0.011313), NONE, NONE, NONE],
        source: SULTANOVA,
    },
    Glass {
        name: "PC",
        aliases: &["polycarbonate"],
        sellmeier: [(1.4182, 0.021304), NONE, NONE, NONE],
        source: SULTANOVA,
    },
    Glass {
        name: "PS",
        aliases: &["polystyrene"],
        sellmeier: [(1.4435, 0.020216), NONE, NONE, NONE],
        source: SULTANOVA,
    },
    Glass {
        name: "water",
        aliases: &["H2O"],
        sellmeier: [
            (0.5684027565, 0.005101829712),
            (0.1726177391, 0.01821153936),
            (0.02086189578, 0.02620722293),
            (0.1130748688, 10.69792721),
        ],
        source: "Daimon, Masumura, Applied Optics 46, 3811 (2007), 20 degrees Celsius",
    },
];

/// The material of this name or alias, in any case.
pub fn lookup(name: &str) -> Option<&'static Glass> {
    GLASSES.iter().find(|glass| {
        std::iter::once(&glass.name)
            .chain(glass.aliases)
            .any(|known| known.eq_ignore_ascii_case(name))
    })
}

/// Every name and alias of the catalogue.
pub fn names() -> impl Iterator<Item = &'static str> + Clone {
    GLASSES
        .iter()
        .flat_map(|glass| std::iter::once(glass.name).chain(glass.aliases.iter().copied()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fraunhofer lines in micrometres: helium d, hydrogen F and C.
    const D: f64 = 0.5875618;
    const F: f64 = 0.4861327;
    const C: f64 = 0.6562725;

    #[test]
    fn indices_and_abbe_numbers_are_the_published_ones() {
        // n_d and V_d as printed on the makers' data sheets, by Malitson, and for water by handbooks.
        // Tolerances: the last printed digit of n_d; what that digit makes of V_d.
        let published = [
            ("N-BK7", 1.51680, 64.17, 1e-5, 0.05),
            ("N-BAF10", 1.67003, 47.11, 1e-5, 0.05),
            ("N-SF5", 1.67271, 32.25, 1e-5, 0.05),
            ("N-SF11", 1.78472, 25.68, 1e-5, 0.05),
            ("SF10", 1.72825, 28.41, 1e-5, 0.05),
            ("N-SF10", 1.72828, 28.53, 1e-5, 0.05),
            ("F2", 1.62004, 36.37, 1e-5, 0.05),
            ("N-F2", 1.62005, 36.43, 1e-5, 0.05),
            ("fused silica", 1.45846, 67.82, 1e-5, 0.05),
            ("water", 1.3330, 55.7, 5e-4, 0.3),
        ];
        for (name, n_d, abbe, n_tolerance, abbe_tolerance) in published {
            let glass = lookup(name).unwrap();
            let n = glass.index(D);
            let v = (n - 1.0) / (glass.index(F) - glass.index(C));
            assert!((n - n_d).abs() <= n_tolerance, "{name}: {n} is not {n_d}");
            assert!((v - abbe).abs() <= abbe_tolerance, "{name}: {v} is not {abbe}");
        }
    }

    #[test]
    fn plastics_have_the_measured_indices() {
        // Sultanova et al., table of indices, printed to three digits: half of the last one, and what a
        // single term leaves of the measurements.
        let wavelengths = [0.4368, 0.4861, 0.5876, 0.6328, 0.7030];
        for (name, indices) in [
            ("PMMA", [1.502, 1.497, 1.491, 1.489, 1.486]),
            ("PC", [1.612, 1.599, 1.585, 1.580, 1.575]),
            ("PS", [1.617, 1.606, 1.592, 1.587, 1.582]),
        ] {
            for (wavelength, measured) in wavelengths.into_iter().zip(indices) {
                let n = lookup(name).unwrap().index(wavelength);
                assert!((n - measured).abs() < 1.5e-3, "{name} at {wavelength}: {n}");
            }
        }
    }

    #[test]
    fn names_are_found_in_any_case_and_are_unique() {
        assert_eq!(lookup("n-bk7").unwrap().name, "N-BK7");
        assert_eq!(lookup("Acrylic").unwrap().name, "PMMA");
        assert!(lookup("unobtainium").is_none());
        let all: Vec<String> = names().map(str::to_lowercase).collect();
        let unique: std::collections::BTreeSet<_> = all.iter().collect();
        assert_eq!(all.len(), unique.len());
    }
}
