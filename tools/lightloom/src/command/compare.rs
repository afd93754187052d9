//! `lightloom compare`: how far two pictures are apart.

use crate::context::Context;
use crate::output::stdout;
use anyhow::Result;
use metrics::{Comparison, ComparisonOptions, Display, FileFormat, Image, Pair, flip};
use std::path::PathBuf;

/// Compare a picture with a reference: RMSE, relMSE, MAPE, SSIM, ꟻLIP.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  lightloom compare box.exr reference.exr -o difference.png")]
pub(crate) struct Args {
    /// The picture
    picture: PathBuf,
    /// The reference
    reference: PathBuf,
    /// A picture of the difference: the ꟻLIP map as .png, or the signed difference as .exr
    #[arg(short, long = "out", value_name = "FILE")]
    out: Option<PathBuf>,
    /// Exposure in EV at which SSIM and ꟻLIP see linear pictures
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f32,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let (picture, reference) = (Image::read(&args.picture)?, Image::read(&args.reference)?);
    // Pictures that are encoded for a screen are compared as they are.
    let encoded = [&args.picture, &args.reference]
        .iter()
        .all(|path| FileFormat::of(path).is_some_and(|format| format.is_display_referred()));
    let display = (!encoded).then(|| Display { exposure: args.exposure, ..Display::default() });
    let comparison =
        Comparison::new(&picture, &reference, ComparisonOptions { display, ..ComparisonOptions::default() })?;
    if context.json {
        stdout!("{}", serde_json::to_string_pretty(&comparison)?);
    } else {
        stdout!("{comparison}");
    }
    if let Some(out) = &args.out {
        let pair = Pair::new(&picture, &reference)?;
        let linear = FileFormat::of(out).is_some_and(|format| !format.is_display_referred());
        let shown = if linear {
            pair.difference()
        } else {
            flip(&pair, display.unwrap_or(Display::AS_IS), metrics::PIXELS_PER_DEGREE).to_image()
        };
        shown.write(out, Display::AS_IS, None)?;
        stdout!("{}", out.display());
    }
    Ok(())
}
