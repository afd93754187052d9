//! What is sent to tev, read as tev reads it.

use metrics::Image;
use metrics::tev::{Tev, TevError};
use std::io::Read as _;
use std::net::{TcpListener, TcpStream};
use std::thread::JoinHandle;

/// What tev knows of a picture after some packets.
#[derive(Debug, Default, PartialEq)]
struct Shown {
    name: String,
    selected: bool,
    size: [usize; 2],
    channels: Vec<String>,
    /// `[channel][pixel]`; NaN where nothing was sent.
    planes: Vec<Vec<f32>>,
    updates: usize,
}

/// The fields of a packet.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (taken, rest) = self.0.split_first_chunk().expect("the packet is too short");
        self.0 = rest;
        *taken
    }

    fn bool(&mut self) -> bool {
        match self.take() {
            [0] => false,
            [1] => true,
            [other] => panic!("{other} is no bool"),
        }
    }

    fn int(&mut self) -> usize {
        i32::from_le_bytes(self.take()).try_into().unwrap()
    }

    fn long(&mut self) -> usize {
        i64::from_le_bytes(self.take()).try_into().unwrap()
    }

    fn text(&mut self) -> String {
        let bytes = std::iter::from_fn(|| Some(self.take::<1>()[0]).filter(|byte| *byte != 0));
        String::from_utf8(bytes.collect()).unwrap()
    }
}

impl Shown {
    fn receive(&mut self, packet: &[u8]) {
        let mut fields = Fields(packet);
        match fields.take() {
            [4] => {
                let (selected, name) = (fields.bool(), fields.text());
                let size = [fields.int(), fields.int()];
                let channels: Vec<String> = (0..fields.int()).map(|_| fields.text()).collect();
                let planes = vec![vec![f32::NAN; size[0] * size[1]]; channels.len()];
                *self = Self { name, selected, size, channels, planes, updates: 0 };
                assert!(fields.0.is_empty(), "{} bytes too many", fields.0.len());
            }
            [6] => {
                assert!(!fields.bool(), "an update does not select the picture again");
                assert_eq!(fields.text(), self.name);
                let names: Vec<String> = (0..fields.int()).map(|_| fields.text()).collect();
                let [x, y, width, height] = [(); 4].map(|()| fields.int());
                let offsets: Vec<usize> = names.iter().map(|_| fields.long()).collect();
                let strides: Vec<usize> = names.iter().map(|_| fields.long()).collect();
                let (floats, []) = fields.0.as_chunks::<4>() else { panic!("not whole floats") };
                let last = |channel: usize| offsets[channel] + (width * height - 1) * strides[channel];
                assert_eq!(floats.len(), 1 + (0..names.len()).map(last).max().unwrap());
                for (channel, name) in names.iter().enumerate() {
                    let plane = self.channels.iter().position(|known| known == name).unwrap();
                    for pixel in 0..width * height {
                        let at = (y + pixel / width) * self.size[0] + x + pixel % width;
                        let value = floats[offsets[channel] + pixel * strides[channel]];
                        let before =
                            std::mem::replace(&mut self.planes[plane][at], f32::from_le_bytes(value));
                        assert!(before.is_nan(), "pixel {at} is sent twice");
                    }
                }
                self.updates += 1;
            }
            [kind] => panic!("a packet of type {kind}"),
        }
    }
}

/// Listens as tev does, and returns what it shows once the sender is gone.
fn listen() -> (String, JoinHandle<Shown>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let receive = move || {
        let (mut stream, _): (TcpStream, _) = listener.accept().unwrap();
        let mut shown = Shown::default();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let mut left = bytes.as_slice();
        while let Some(length) = left.first_chunk() {
            // The length counts itself.
            let (packet, rest) = left.split_at(u32::from_le_bytes(*length) as usize);
            shown.receive(&packet[4..]);
            left = rest;
        }
        assert!(left.is_empty());
        shown
    };
    (address, std::thread::spawn(receive))
}

#[test]
fn a_picture_arrives_as_it_was() {
    // Several packets, the last not full; what is no ordinary number stays.
    let (width, height) = (601, 333);
    let mut image = Image::from_fn(width, height, |x, y| [x as f32, y as f32, -1.5, (x + y) as f32]).unwrap();
    image.pixels_mut()[7] = [f32::INFINITY, f32::MIN_POSITIVE, -0.0, 0.25];
    let (address, shown) = listen();
    Tev::connect(&address).unwrap().send_image("Größe 1", &image).unwrap();
    let shown = shown.join().unwrap();
    assert_eq!((shown.name.as_str(), shown.selected, shown.size), ("Größe 1", true, [width, height]));
    assert_eq!(shown.channels, ["R", "G", "B", "A"]);
    assert!(shown.updates > 2, "{} packets", shown.updates);
    for (pixel, expected) in image.pixels().iter().enumerate() {
        for (plane, expected) in shown.planes.iter().zip(expected) {
            assert_eq!(plane[pixel].to_bits(), expected.to_bits(), "pixel {pixel}");
        }
    }
}

#[test]
fn channels_have_any_names_and_one_connection_sends_many_pictures() {
    let (address, shown) = listen();
    let mut tev = Tev::connect(&address).unwrap();
    tev.send("first", &["R"], [1, 1], &[3.0]).unwrap();
    tev.send("second", &["depth.Z", "depth.id"], [2, 1], &[1.0, 2.0, 3.0, 4.0]).unwrap();
    drop(tev);
    let expected = Shown {
        name: "second".into(),
        selected: true,
        size: [2, 1],
        channels: vec!["depth.Z".into(), "depth.id".into()],
        planes: vec![vec![1.0, 3.0], vec![2.0, 4.0]],
        updates: 1,
    };
    assert_eq!(shown.join().unwrap(), expected);
}

#[test]
fn what_cannot_be_sent_is_said_and_nothing_is_sent() {
    let (address, shown) = listen();
    let mut tev = Tev::connect(&address).unwrap();
    let mut message = |name: &str, channels: &[&str], size, values: &[f32]| {
        tev.send(name, channels, size, values).unwrap_err().to_string()
    };
    assert!(message("a", &["R"], [2, 2], &[0.0]).ends_with("needs 4 values (at least 1), got 1"));
    assert!(message("a", &[], [2, 2], &[]).contains("(at least 1)"));
    assert_eq!(message("a\0b", &["R"], [1, 1], &[0.0]), r#"the name "a\0b" contains a zero byte"#);
    assert_eq!(message("a", &["R\0"], [1, 1], &[0.0]), r#"the name "R\0" contains a zero byte"#);
    drop(tev);
    assert_eq!(shown.join().unwrap(), Shown::default());
}

#[test]
fn where_nobody_listens_the_message_says_what_to_start() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let error = Tev::connect(&free).unwrap_err();
    assert!(matches!(error, TevError::NotThere { .. }));
    assert!(error.to_string().starts_with(&format!("tev does not listen at {free}: ")), "{error}");
    assert!(Tev::connect("no address").is_err());
}
