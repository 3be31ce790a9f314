//! Many cells or points as one image inside a picture: a browser draws it as fast as a photograph.

use super::canvas::Rgb;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Pixels of an image for each pixel of the picture.
pub(super) const FINER: f64 = 2.0;

/// Red, green, blue and cover.
pub(super) type Pixel = [u8; 4];
pub(super) const CLEAR: Pixel = [0; 4];

pub(super) fn solid(Rgb(r, g, b): Rgb) -> Pixel {
    [r, g, b, 255]
}

/// Dots on a clear ground.
pub(super) struct Dots {
    width: usize,
    height: usize,
    pixels: Vec<Pixel>,
}

impl Dots {
    /// For a field of this size in pixels of the picture.
    pub fn new(width: f64, height: f64) -> Self {
        let (width, height) = ((width * FINER) as usize, (height * FINER) as usize);
        Self { width, height, pixels: vec![CLEAR; width * height] }
    }

    /// A dot, at pixels from the upper left corner of the field.
    pub fn dot(&mut self, (x, y): (f64, f64), radius: f64, colour: Rgb) {
        let (x, y, radius) = (x * FINER, y * FINER, radius * FINER);
        let range = |middle: f64, end: usize| {
            let last = (middle + radius).ceil().clamp(0.0, end as f64) as usize;
            (middle - radius).floor().clamp(0.0, end as f64) as usize..last
        };
        for j in range(y, self.height) {
            for i in range(x, self.width) {
                if (i as f64 + 0.5 - x).hypot(j as f64 + 0.5 - y) <= radius {
                    self.pixels[j * self.width + i] = solid(colour);
                }
            }
        }
    }

    /// As [`image`].
    pub fn image(&self) -> String {
        image(self.width, self.height, &self.pixels)
    }
}

/// A field of colours, red, green, blue and cover, row by row from above, as the `data:` address of a PNG image.
pub(super) fn image(width: usize, height: usize, pixels: &[Pixel]) -> String {
    // Writing to memory cannot fail, and no picture is too large.
    let bytes = encoded(width as u32, height as u32, pixels.as_flattened()).unwrap_or_default();
    format!("data:image/png;base64,{}", STANDARD.encode(bytes))
}

fn encoded(width: u32, height: u32, data: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the library's own decoder.
    #[test]
    fn colours_come_back_as_they_were() {
        let mut colours: Vec<Pixel> = (0..6).map(|i| solid(Rgb(i, 10 * i, 255 - i))).collect();
        colours[4] = CLEAR;
        let address = image(3, 2, &colours);
        let bytes = STANDARD.decode(address.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut data).unwrap();
        assert_eq!((info.width, info.height), (3, 2));
        let expected = |i: u8| if i == 4 { [0; 4] } else { [i, 10 * i, 255 - i, 255] };
        let expected: Vec<u8> = (0..6).flat_map(expected).collect();
        assert_eq!(data[..info.buffer_size()], expected);
    }

    /// Truth: the area of a circle.
    #[test]
    fn a_dot_covers_its_circle_and_nothing_outside_the_field() {
        let mut dots = Dots::new(40.0, 30.0);
        dots.dot((20.0, 15.0), 8.0, Rgb(1, 2, 3));
        let covered = dots.pixels.iter().filter(|one| **one != CLEAR).count() as f64 / (FINER * FINER);
        assert!((covered / (std::f64::consts::PI * 64.0) - 1.0).abs() < 0.02, "{covered}");
        dots.dot((0.0, 0.0), 8.0, Rgb(1, 2, 3));
        dots.dot((-50.0, 500.0), 8.0, Rgb(1, 2, 3));
        let more = dots.pixels.iter().filter(|one| **one != CLEAR).count() as f64 / (FINER * FINER) - covered;
        assert!((more / (std::f64::consts::PI * 16.0) - 1.0).abs() < 0.06, "{more}");
    }
}
