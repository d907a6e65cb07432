//! Pictures as pixels, and as PNG.

use crate::error::FigureError;

/// A picture of 8-bit sRGB pixels with straight (not premultiplied) alpha,
/// row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 4]>,
}

impl Image {
    /// The caller has made `width × height` pixels.
    pub(crate) fn new(width: u32, height: u32, pixels: Vec<[u8; 4]>) -> Self {
        debug_assert_eq!(pixels.len(), width as usize * height as usize);
        Self { width, height, pixels }
    }

    /// A picture of given pixels, row by row: red, green, blue, alpha.
    ///
    /// # Errors
    ///
    /// [`FigureError::Size`] if there are not `width × height` pixels, or none.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<[u8; 4]>) -> Result<Self, FigureError> {
        if pixels.is_empty() || pixels.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(FigureError::Size { width, height, samples: 1 });
        }
        Ok(Self { width, height, pixels })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row: red, green, blue, alpha.
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// The pixel in column `x` and row `y`, counted from the top left.
    ///
    /// # Panics
    ///
    /// If it lies outside of the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width && y < self.height, "({x}, {y}) lies outside of the picture");
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The bytes of a PNG file (8-bit RGBA, sRGB).
    ///
    /// # Errors
    ///
    /// [`FigureError::Png`] for a picture that PNG cannot hold.
    pub fn to_png(&self) -> Result<Vec<u8>, FigureError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_compression(png::Compression::Balanced);
        let encode = move || {
            let mut writer = encoder.write_header()?;
            writer.write_image_data(self.pixels.as_flattened())?;
            writer.finish()
        };
        encode().map_err(|source| FigureError::Png(source.to_string()))?;
        Ok(bytes)
    }
}
