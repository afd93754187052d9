//! Pictures: files, and what is measured of them.

use crate::arrays::{image_of, pixels};
use crate::error::raise;
use anyhow::Result;
use metrics::{Comparison, ComparisonOptions, Display, Image, PIXELS_PER_DEGREE, Pair, Tonemap};
use numpy::{PyArray2, PyArray3, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;

/// How linear light is shown: the name of a curve, its white point, and the exposure \[EV\].
pub(crate) type Shown = (String, f32, f32);

/// Returns how linear light is shown, as Python says it.
pub(crate) fn display((curve, white, exposure): Shown) -> Result<Display> {
    let tonemap = Tonemap::of_settings(&curve, white).ok_or_else(|| {
        anyhow::anyhow!(
            "there is no tonemap `{curve}`; there are reinhard, reinhard-simple, aces, filmic, none"
        )
    })?;
    Ok(Display { tonemap, exposure })
}

/// Returns the same for Python.
pub(crate) fn shown(display: Display) -> Shown {
    let (curve, white) = display.tonemap.to_settings();
    (curve.to_owned(), white.unwrap_or(1.0), display.exposure)
}

/// Returns the bytes of a PNG file of a picture.
#[pyfunction]
pub(crate) fn png<'py>(
    py: Python<'py>,
    picture: PyReadonlyArray3<'py, f32>,
    shown: Shown,
) -> PyResult<Bound<'py, PyBytes>> {
    let done = || Ok(image_of(&picture)?.png(display(shown)?)?);
    done().map(|bytes: Vec<u8>| PyBytes::new(py, &bytes)).map_err(|error| raise(py, &error))
}

/// Writes a picture into a file: .exr, .pfm, or .png after the curve.
#[pyfunction]
pub(crate) fn write(
    py: Python<'_>,
    picture: PyReadonlyArray3<'_, f32>,
    path: PathBuf,
    shown: Shown,
) -> PyResult<()> {
    let done = || Ok(image_of(&picture)?.write(path, display(shown)?, None)?);
    done().map_err(|error: anyhow::Error| raise(py, &error))
}

/// Reads a picture: `[height, width, 4]`.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyArray3<f32>>> {
    match py.detach(|| Image::read(path)) {
        Ok(image) => pixels(py, image),
        Err(error) => Err(raise(py, &error.into())),
    }
}

/// Compares a picture with a reference, and returns all measures as JSON. `shown` is how both are shown where they hold linear
/// light; `None` where they are display light already.
#[pyfunction]
pub(crate) fn compare(
    py: Python<'_>,
    picture: PyReadonlyArray3<'_, f32>,
    reference: PyReadonlyArray3<'_, f32>,
    shown: Option<Shown>,
) -> PyResult<String> {
    let given = || Ok((image_of(&picture)?, image_of(&reference)?, shown.map(display).transpose()?));
    let (picture, reference, display) = given().map_err(|error| raise(py, &error))?;
    let options = ComparisonOptions { display, ..ComparisonOptions::default() };
    let compared = py.detach(|| {
        let comparison = Comparison::new(&picture, &reference, options)?;
        Ok(serde_json::to_string(&comparison)?)
    });
    compared.map_err(|error: anyhow::Error| raise(py, &error))
}

/// Returns the ꟻLIP error of each pixel, `[height, width]` of 0 to 1: of both as they are shown, or by HDR-ꟻLIP over all
/// exposures.
#[pyfunction]
pub(crate) fn flip<'py>(
    py: Python<'py>,
    picture: PyReadonlyArray3<'py, f32>,
    reference: PyReadonlyArray3<'py, f32>,
    shown: Shown,
    hdr: bool,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let given = || Ok((image_of(&picture)?, image_of(&reference)?, display(shown)?));
    let (picture, reference, display) = given().map_err(|error| raise(py, &error))?;
    let errors = py.detach(|| {
        let pair = Pair::new(&picture, &reference)?;
        let map = match hdr {
            true => metrics::hdr_flip(&pair, PIXELS_PER_DEGREE),
            false => metrics::flip(&pair, display, PIXELS_PER_DEGREE),
        };
        Ok(map.errors().to_vec())
    });
    let errors = errors.map_err(|error: anyhow::Error| raise(py, &error))?;
    crate::arrays::grid(py, errors, [picture.height(), picture.width()])
}
