//! The image while it renders, in the viewer tev (<https://github.com/Tom94/tev>).
//!
//! A viewer that is not there, or that is closed half-way, costs a warning and nothing else.

use crate::film::{Film, Pixel};
use std::net::{TcpStream, ToSocketAddrs};
use std::str::FromStr;
use std::time::{Duration, Instant};
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// Longest wait for the viewer.
const PATIENCE: Duration = Duration::from_secs(2);
/// Shortest time between two images.
const INTERVAL: Duration = Duration::from_millis(500);
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// Where to show the image while it renders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Preview {
    /// In the image viewer tev, at this address.
    Tev(String),
}

/// Where tev listens unless told otherwise.
const TEV_ADDRESS: &str = "127.0.0.1:14158";

impl FromStr for Preview {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let port = |address: &str| Some(address.rsplit_once(':')?.1.parse::<u16>().is_ok());
        match text.split_once('=') {
            None if text == "tev" => Ok(Self::Tev(TEV_ADDRESS.into())),
            Some(("tev", address)) if port(address) == Some(true) => Ok(Self::Tev(address.into())),
            _ => Err("expected tev or tev=host:port such as tev=127.0.0.1:14158".into()),
        }
    }
}

/// A connection to the viewer.
pub struct Tev {
    client: TevClient,
    name: String,
    sent: Option<Instant>,
}

impl Tev {
    /// Connects, and opens an image of that name. `None`, with a warning, if nobody listens.
    pub fn connect(address: &str, name: &str, film: &Film) -> Option<Self> {
        Self::try_connect(address, name, film)
            .map_err(|e| {
                tracing::warn!(
                    "no preview: tev does not answer at {address} ({e}); is it running?"
                );
            })
            .ok()
    }

    fn try_connect(address: &str, name: &str, film: &Film) -> std::io::Result<Self> {
        let mut last = std::io::Error::other("the name has no address");
        let mut stream = None;
        for address in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, PATIENCE) {
                Ok(s) => {
                    stream = Some(s);
                    break;
                }
                Err(e) => last = e,
            }
        }
        let stream = stream.ok_or(last)?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let mut client = TevClient::wrap(stream);
        client.send(PacketCreateImage {
            image_name: name,
            grab_focus: true,
            width: film.width(),
            height: film.height(),
            channel_names: &CHANNELS,
        })?;
        Ok(Self {
            client,
            name: name.to_owned(),
            sent: None,
        })
    }

    /// Sends the image so far, unless one was sent a moment ago and this is not the last.
    ///
    /// # Errors
    /// When the viewer has gone.
    pub fn show(&mut self, film: &Film, last: bool) -> std::io::Result<()> {
        let recent = self.sent.is_some_and(|sent| sent.elapsed() < INTERVAL);
        if recent && !last {
            return Ok(());
        }
        let mut data = Vec::with_capacity(film.width() as usize * 3);
        for y in 0..film.height() {
            data.clear();
            for x in 0..film.width() {
                data.extend(Pixel::mean(film.pixel(x, y)).map(|c| c as f32));
            }
            self.client.send(PacketUpdateImage {
                image_name: &self.name,
                grab_focus: false,
                channel_names: &CHANNELS,
                channel_offsets: &[0, 1, 2],
                channel_strides: &[3, 3, 3],
                x: 0,
                y,
                width: film.width(),
                height: 1,
                data: &data,
            })?;
        }
        self.sent = Some(Instant::now());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn previews_name_a_host_and_a_port() {
        let tev = |address: &str| Ok(Preview::Tev(address.into()));
        assert_eq!("tev".parse(), tev(TEV_ADDRESS));
        assert_eq!("tev=far:99".parse(), tev("far:99"));
        for text in ["", "gimp", "tev=", "tev=host", "tev=host:port", "gimp=a:1"] {
            assert!(text.parse::<Preview>().is_err(), "{text}");
        }
    }
}
