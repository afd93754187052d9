//! Sends pictures to tev, a viewer of pictures in high dynamic range (<https://github.com/Tom94/tev>), while it runs.
//!
//! tev listens on TCP port 14158 for packets, which `tev_client` writes. A picture is one packet `CreateImage`, and packets
//! `UpdateImageV3` that fill bands of its rows: a version of tev must list these in its `Ipc.h`, as tev 2 does.
//!
//! ```no_run
//! # fn main() -> Result<(), metrics::tev::TevError> {
//! # let image = metrics::Image::from_fn(4, 4, |_, _| [1.0; 4]).unwrap();
//! let mut tev = metrics::tev::Tev::connect(metrics::tev::ADDRESS)?;
//! tev.send_image("indirect", &image)?;
//! # Ok(())
//! # }
//! ```

use crate::Image;
use std::io;
use std::net::{TcpStream, ToSocketAddrs as _};
use std::time::Duration;
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// The default address of tev.
pub const ADDRESS: &str = "127.0.0.1:14158";

/// On one machine an answer takes no time; the window must not wait for a program that does not run.
const CONNECT_TIMEOUT: Duration = Duration::from_millis(500);

/// tev reads between the frames that it draws, so a large picture can take a while.
const WRITE_TIMEOUT: Duration = Duration::from_secs(10);

/// Floats in one packet, about: tev's buffer begins with 1 MiB.
const FLOATS_PER_PACKET: usize = 1 << 17;

/// The most values in a row, so that the length of a packet fits.
const ROW_LIMIT: usize = 1 << 28;

/// An error of a picture that was not sent.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TevError {
    /// No program listens at this address.
    #[error(
        "tev does not listen at {address}: {source}; start it, or give the address of its option --hostname"
    )]
    NotThere {
        /// The address.
        address: String,
        /// The system's reason.
        source: io::Error,
    },
    /// The connection broke while a picture was sent.
    #[error("tev stopped listening: {0}")]
    Broken(#[from] io::Error),
    /// The values are not one for each pixel and channel, or there are none.
    #[error(
        "a picture of {size:?} pixels and {channels} channels needs {expected} values (at least 1), got {found}"
    )]
    ValueCount {
        /// Width and height in pixels.
        size: [usize; 2],
        /// Number of channels.
        channels: usize,
        /// width × height × channels.
        expected: usize,
        /// The number that was given.
        found: usize,
    },
    /// Rows that fit in no packet, or more of them than the protocol can number.
    #[error(
        "a picture of {size:?} pixels and {channels} channels is too large for tev; expected rows of at most 2^28 \
         values, and fewer than 2^31 of them"
    )]
    TooLarge {
        /// Width and height in pixels.
        size: [usize; 2],
        /// Number of channels.
        channels: usize,
    },
    /// A zero byte in the name of a picture or channel, which would end it.
    #[error("the name {0:?} contains a zero byte")]
    ZeroInName(String),
}

/// A connection to a running tev.
#[derive(Debug)]
pub struct Tev(TevClient);

impl Tev {
    /// Connects to an address, as `host:port`: usually [`ADDRESS`]. Fails within a second if nobody listens.
    ///
    /// # Errors
    /// [`TevError::NotThere`].
    pub fn connect(address: &str) -> Result<Self, TevError> {
        let connect = || {
            let mut last = io::Error::new(io::ErrorKind::NotFound, "no such host");
            for address in address.to_socket_addrs()? {
                match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
                    Ok(stream) => {
                        stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
                        return Ok(stream);
                    }
                    Err(error) => last = error,
                }
            }
            Err(last)
        };
        let stream = connect().map_err(|source| TevError::NotThere { address: address.into(), source })?;
        Ok(Self(TevClient::wrap(stream)))
    }

    /// Shows a picture with the channels R, G, B and A, unchanged, in place of one with the same name.
    ///
    /// # Errors
    /// Those of [`Tev::send`].
    pub fn send_image(&mut self, name: &str, image: &Image) -> Result<(), TevError> {
        let size = [image.width(), image.height()];
        self.send(name, &["R", "G", "B", "A"], size, image.pixels().as_flattened())
    }

    /// Shows a picture under a name, in place of one with the same name.
    ///
    /// `values: [height, width, channel]`, row by row from the top left. tev shows channels called R, G, B and A as a
    /// color; others, such as `depth.Z`, in groups by what is before the dot.
    ///
    /// # Errors
    /// [`TevError::ValueCount`], [`TevError::TooLarge`] and [`TevError::ZeroInName`], before anything is sent;
    /// [`TevError::Broken`] where tev ended meanwhile.
    pub fn send(
        &mut self,
        name: &str,
        channels: &[&str],
        size: [usize; 2],
        values: &[f32],
    ) -> Result<(), TevError> {
        let [width, height] = size;
        let row = width.saturating_mul(channels.len());
        let expected = row.saturating_mul(height);
        if expected == 0 || values.len() != expected {
            let (channels, found) = (channels.len(), values.len());
            return Err(TevError::ValueCount { size, channels, expected, found });
        }
        let fits = |number: usize| i32::try_from(number).ok().map(i32::cast_unsigned);
        let (Some(width), Some(height), true) = (fits(width), fits(height), row <= ROW_LIMIT) else {
            return Err(TevError::TooLarge { size, channels: channels.len() });
        };
        if let Some(name) = [name].iter().chain(channels).find(|name| name.contains('\0')) {
            return Err(TevError::ZeroInName((*name).to_owned()));
        }

        let create =
            PacketCreateImage { image_name: name, grab_focus: true, width, height, channel_names: channels };
        self.0.send(create)?;
        let count = channels.len() as u64;
        let (offsets, strides): (Vec<u64>, Vec<u64>) = (0..count).map(|channel| (channel, count)).unzip();
        // No row is past the height, which fits.
        let mut y = 0;
        for band in values.chunks((FLOATS_PER_PACKET / row).max(1) * row) {
            let rows = (band.len() / row) as u32;
            self.0.send(PacketUpdateImage {
                image_name: name,
                grab_focus: false,
                channel_names: channels,
                channel_offsets: &offsets,
                channel_strides: &strides,
                x: 0,
                y,
                width,
                height: rows,
                data: band,
            })?;
            y += rows;
        }
        Ok(())
    }
}
