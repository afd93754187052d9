//! Converts spectra to linear Rec. 709.
//!
//! Offline renderers describe light by wavelength, Lightloom by three channels. A spectrum becomes the color that the
//! standard observer sees: reflectance relative to a white surface under light of equal energy, emission with its luminance
//! as it is or set to 1.

use glam::{DMat3, DVec3, Vec3};

/// The wavelengths at which spectra are summed \[nm\].
const VISIBLE: std::ops::RangeInclusive<u32> = 380..=780;

/// CIE XYZ to linear Rec. 709 (IEC 61966-2-1), by columns.
const REC709_FROM_XYZ: DMat3 = DMat3::from_cols_array(&[
    3.240_454_2,
    -0.969_266,
    0.055_643_4,
    -1.537_138_5,
    1.876_010_8,
    -0.204_025_9,
    -0.498_531_4,
    0.041_556,
    1.057_225_2,
]);

/// A spectrum: values at rising wavelengths \[nm\], linear between them, and 0 beyond the first and the last.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spectrum(Vec<[f64; 2]>);

impl Spectrum {
    /// Returns a spectrum of pairs; `None` if there are none, or wavelengths do not rise.
    pub(super) fn new(pairs: Vec<[f64; 2]>) -> Option<Spectrum> {
        let rises = pairs.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        (!pairs.is_empty() && rises).then_some(Spectrum(pairs))
    }

    /// Returns the spectrum of equal energy at all wavelengths.
    pub(super) fn uniform(value: f64) -> Spectrum {
        let (first, last) = VISIBLE.into_inner();
        Spectrum([first, last].map(|wavelength| [f64::from(wavelength), value]).to_vec())
    }

    /// Returns the value at a wavelength \[nm\].
    fn at(&self, wavelength: f64) -> f64 {
        let next = self.0.partition_point(|pair| pair[0] <= wavelength);
        match (next.checked_sub(1).map(|before| self.0[before]), self.0.get(next)) {
            (Some([from, a]), Some([to, b])) => a + (b - a) * (wavelength - from) / (to - from),
            (Some([last, value]), None) if last == wavelength => value,
            _ => 0.0,
        }
    }

    /// Returns the color of a surface of this reflectance.
    pub(super) fn reflectance(&self) -> Vec3 {
        let white = REC709_FROM_XYZ * observed(|_| 1.0);
        (REC709_FROM_XYZ * observed(|wavelength| self.at(wavelength)) / white).as_vec3()
    }

    /// Returns the color of light of this spectrum, with a luminance of 1.
    pub(super) fn chromaticity(&self) -> Vec3 {
        normalized(observed(|wavelength| self.at(wavelength)))
    }

    /// Returns the color of light of this spectrum, whose luminance is its mean, weighted by that of the observer.
    pub(super) fn emission(&self) -> Vec3 {
        let sum = observed(|wavelength| self.at(wavelength));
        (REC709_FROM_XYZ * sum / observed(|_| 1.0).y).max(DVec3::ZERO).as_vec3()
    }
}

/// Returns the color of a black body of a temperature \[K\] by Planck's law, with a luminance of 1.
pub(super) fn blackbody(kelvin: f64) -> Vec3 {
    // The second radiation constant [nm K]; the first cancels.
    const SECOND: f64 = 1.438_776_877e7;
    normalized(observed(|wavelength| {
        // Relative to the value at 560 nm, so that low temperatures do not become 0.
        let exponent = SECOND / kelvin * (1.0 / 560.0 - 1.0 / wavelength);
        let tail =
            (1.0 - (-SECOND / (560.0 * kelvin)).exp()) / (1.0 - (-SECOND / (wavelength * kelvin)).exp());
        (560.0 / wavelength).powi(5) * exponent.exp() * tail
    }))
}

/// Returns the reflectance at normal incidence of a conductor with the complex index of refraction `eta` + i `k`.
pub(super) fn conductor(eta: Vec3, k: Vec3) -> Vec3 {
    let (low, high, k2) = (eta - 1.0, eta + 1.0, k * k);
    (low * low + k2) / (high * high + k2)
}

/// Returns the reflectance at normal incidence of a dielectric of this relative index of refraction.
pub(super) fn dielectric(eta: f32) -> f32 {
    conductor(Vec3::splat(eta), Vec3::ZERO).x
}

fn normalized(xyz: DVec3) -> Vec3 {
    match xyz.y > 0.0 {
        true => (REC709_FROM_XYZ * xyz / xyz.y).max(DVec3::ZERO).as_vec3(),
        false => Vec3::ZERO,
    }
}

/// Returns the sum over wavelengths of a spectrum times the CIE 1931 color matching functions.
fn observed(of: impl Fn(f64) -> f64) -> DVec3 {
    VISIBLE.map(f64::from).map(|wavelength| observer(wavelength) * of(wavelength)).sum()
}

/// Returns the CIE 1931 color matching functions, by the fit of Wyman, Sloan and Shirley 2013 (JCGT 2:2, listing 1).
fn observer(wavelength: f64) -> DVec3 {
    let lobe = |mean: f64, below: f64, above: f64| {
        let t = (wavelength - mean) * if wavelength < mean { below } else { above };
        (-0.5 * t * t).exp()
    };
    DVec3::new(
        1.056 * lobe(599.8, 0.0264, 0.0323) + 0.362 * lobe(442.0, 0.0624, 0.0374)
            - 0.065 * lobe(501.1, 0.0490, 0.0382),
        0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322),
        1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725),
    )
}

/// The reflectance at normal incidence of metals, by the names that pbrt and Mitsuba share: [`Spectrum::reflectance`] of
/// ((η − 1)² + k²) / ((η + 1)² + k²) with the measured η and k that Mitsuba 3 ships (from the collection of luxpop.com).
const METALS: [(&str, [f32; 3]); 36] = [
    ("a-C", [0.211, 0.212, 0.199]),
    ("Ag", [0.970, 0.960, 0.913]),
    ("Al", [0.914, 0.921, 0.925]),
    ("AlAs", [0.282, 0.262, 0.477]),
    ("AlSb", [0.354, 0.384, 0.480]),
    ("Au", [0.994, 0.789, 0.337]),
    ("Be", [0.539, 0.538, 0.537]),
    ("Cr", [0.637, 0.662, 0.705]),
    ("CsI", [0.079, 0.081, 0.086]),
    ("Cu", [0.933, 0.640, 0.534]),
    ("Cu2O", [0.245, 0.265, 0.273]),
    ("CuO", [0.221, 0.217, 0.216]),
    ("d-C", [0.171, 0.173, 0.177]),
    ("Hg", [0.781, 0.780, 0.778]),
    ("HgTe", [0.403, 0.385, 0.384]),
    ("Ir", [0.700, 0.694, 0.655]),
    ("K", [0.949, 0.938, 0.920]),
    ("Li", [0.913, 0.890, 0.805]),
    ("MgO", [0.072, 0.073, 0.075]),
    ("Mo", [0.561, 0.579, 0.569]),
    ("Na_palik", [0.976, 0.962, 0.935]),
    ("Nb", [0.504, 0.507, 0.504]),
    ("Ni_palik", [0.655, 0.610, 0.523]),
    ("Rh", [0.794, 0.765, 0.742]),
    ("Se", [0.312, 0.270, 0.277]),
    ("SiC", [0.202, 0.206, 0.215]),
    ("SnTe", [0.346, 0.125, 0.027]),
    ("Ta", [0.389, 0.360, 0.413]),
    ("Te", [0.574, 0.593, 0.584]),
    ("ThF4", [0.043, 0.043, 0.043]),
    ("TiC", [0.486, 0.458, 0.445]),
    ("TiN", [0.600, 0.464, 0.226]),
    ("TiO2", [0.233, 0.244, 0.274]),
    ("VC", [0.467, 0.437, 0.413]),
    ("VN", [0.464, 0.411, 0.343]),
    ("W", [0.514, 0.496, 0.467]),
];

/// Returns the reflectance at normal incidence of a metal, by its name.
pub(super) fn metal(name: &str) -> Option<Vec3> {
    METALS.iter().find(|(known, _)| *known == name).map(|(_, reflectance)| Vec3::from(*reflectance))
}

/// Returns the names of metals.
pub(super) fn metals() -> impl Iterator<Item = &'static str> {
    METALS.iter().map(|(name, _)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_spectrum_is_white_as_reflectance() {
        let grey = Spectrum::uniform(0.25);
        assert!((grey.reflectance() - 0.25).abs().max_element() < 1e-6, "{}", grey.reflectance());
        let luminance = Vec3::new(0.2126, 0.7152, 0.0722);
        assert!((grey.chromaticity().dot(luminance) - 1.0).abs() < 1e-3);
        assert!((grey.emission().dot(luminance) - 0.25).abs() < 1e-3);
    }

    #[test]
    fn spectra_are_linear_between_their_values_and_dark_beyond() {
        let spectrum = Spectrum::new(vec![[400.0, 1.0], [500.0, 3.0]]).expect("a spectrum");
        assert_eq!([300.0, 400.0, 450.0, 500.0, 900.0].map(|x| spectrum.at(x)), [0.0, 1.0, 2.0, 3.0, 0.0]);
        assert_eq!(Spectrum::new(vec![[500.0, 1.0], [400.0, 1.0]]), None);
        assert_eq!(Spectrum::new(Vec::new()), None);
    }

    /// The colors that Mitsuba 3.9 has for these spectra in its variant `scalar_rgb`, whose color matching functions are
    /// tabulated ones.
    #[test]
    fn colors_are_those_of_mitsuba() {
        let of = |pairs: &[[f64; 2]]| Spectrum::new(pairs.to_vec()).expect("a spectrum");
        let near = |found: Vec3, expected: [f32; 3]| {
            assert!((found - Vec3::from(expected)).abs().max_element() < 0.03, "{found}, not {expected:?}");
        };
        near(Spectrum::uniform(2.0).emission(), [2.40959, 1.89658, 1.81783]);
        near(of(&[[400.0, 0.0], [500.0, 2.0], [700.0, 0.0]]).emission(), [0.685_616, 1.601_39, 0.904_557]);
        near(of(&[[400.0, 0.1], [700.0, 0.9]]).reflectance(), [0.742_853, 0.481_14, 0.208_325]);
    }

    #[test]
    fn a_black_body_has_the_color_of_its_temperature() {
        // Chromaticities of the Planckian locus: 6504 K is near D65, 2000 K is (0.5267, 0.4133).
        let day = blackbody(6504.0);
        assert!((day - 1.0).abs().max_element() < 0.06, "{day}");
        let xyz = REC709_FROM_XYZ.inverse() * blackbody(2000.0).as_dvec3();
        let (x, y) = (xyz.x / (xyz.x + xyz.y + xyz.z), xyz.y / (xyz.x + xyz.y + xyz.z));
        assert!((x - 0.5267).abs() < 0.01 && (y - 0.4133).abs() < 0.01, "({x}, {y})");
        assert!(blackbody(100.0).is_finite() && blackbody(1e9).is_finite());
    }

    #[test]
    fn reflectance_at_normal_incidence_is_that_of_fresnel() {
        assert!((dielectric(1.5) - 0.04).abs() < 1e-6);
        let iron = conductor(Vec3::splat(2.91), Vec3::splat(3.08));
        assert!((iron.x - 0.530).abs() < 1e-3, "{iron}");
        assert_eq!(conductor(Vec3::ZERO, Vec3::ONE), Vec3::ONE);
        assert_eq!(metal("Au"), Some(Vec3::new(0.994, 0.789, 0.337)));
    }
}
