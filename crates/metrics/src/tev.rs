//! Sends pictures to tev, a viewer of pictures in high dynamic range (<https://github.com/Tom94/tev>), while it runs.
//!
//! tev listens on TCP port 14158 for packets. A packet is its own length in bytes (`u32`), its type (`u8`) and its
//! fields, all in little-endian order; a text ends with a zero byte. A picture is one packet `CreateImage` (type 4), and
//! packets `UpdateImageV3` (type 6) that fill bands of its rows. They are as in `include/tev/Ipc.h` of tev 2; other
//! versions know them if their `Ipc.h` lists `UpdateImageV3`.
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
use std::io::{self, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::time::Duration;

/// Where tev listens if nothing else is asked of it.
pub const ADDRESS: &str = "127.0.0.1:14158";

/// On one machine an answer takes no time; a viewer must not wait for what is not there.
const CONNECT_TIMEOUT: Duration = Duration::from_millis(500);

/// tev reads between the frames that it draws, so a large picture can take a while.
const WRITE_TIMEOUT: Duration = Duration::from_secs(10);

/// Floats in one packet, about: tev's buffer begins with 1 MiB.
const FLOATS_PER_PACKET: usize = 1 << 17;

/// The most values in a row, so that the length of a packet fits.
const ROW_LIMIT: usize = 1 << 28;

const CREATE_IMAGE: u8 = 4;
const UPDATE_IMAGE_V3: u8 = 6;

/// Why a picture was not sent.
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
pub struct Tev {
    stream: TcpStream,
}

impl Tev {
    /// Connects to an address, as `host:port`: usually [`ADDRESS`]. Fails within a second where nobody listens.
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
        Ok(Self { stream })
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
        let fits = |number: usize| i32::try_from(number).ok();
        let (Some(width), Some(height), Some(count), true) =
            (fits(width), fits(height), fits(channels.len()), row <= ROW_LIMIT)
        else {
            return Err(TevError::TooLarge { size, channels: channels.len() });
        };
        if let Some(name) = [name].iter().chain(channels).find(|name| name.contains('\0')) {
            return Err(TevError::ZeroInName((*name).to_owned()));
        }

        let mut create = Packet::new(CREATE_IMAGE, true, name);
        create.numbers(&[width, height, count]);
        channels.iter().for_each(|channel| create.text(channel));
        self.stream.write_all(&create.finish())?;
        // No row is past the height, which fits.
        let mut y = 0;
        for band in values.chunks((FLOATS_PER_PACKET / row).max(1) * row) {
            let rows = (band.len() / row) as i32;
            let mut update = Packet::new(UPDATE_IMAGE_V3, false, name);
            update.numbers(&[count]);
            channels.iter().for_each(|channel| update.text(channel));
            update.numbers(&[0, y, width, rows]);
            // Where the first value of each channel is, and how far it is to the next.
            (0..count).for_each(|channel| update.long(channel));
            (0..count).for_each(|_| update.long(count));
            band.iter().for_each(|value| update.0.extend(value.to_le_bytes()));
            self.stream.write_all(&update.finish())?;
            y += rows;
        }
        Ok(())
    }
}

/// A packet that is being written.
struct Packet(Vec<u8>);

impl Packet {
    /// Begins a packet about a picture; `select` says that tev shows the picture at once.
    fn new(kind: u8, select: bool, name: &str) -> Self {
        let mut packet = Self(vec![0, 0, 0, 0, kind, select.into()]);
        packet.text(name);
        packet
    }

    fn text(&mut self, text: &str) {
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    fn numbers(&mut self, numbers: &[i32]) {
        numbers.iter().for_each(|number| self.0.extend(number.to_le_bytes()));
    }

    fn long(&mut self, number: i32) {
        self.0.extend(i64::from(number).to_le_bytes());
    }

    /// Puts the length, which counts itself, in front.
    fn finish(mut self) -> Vec<u8> {
        // A band is a packet's worth of floats, or one row.
        let length = self.0.len() as u32;
        self.0[..4].copy_from_slice(&length.to_le_bytes());
        self.0
    }
}
