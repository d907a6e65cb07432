//! Pictures in 256 colours: a third of the size, so that a report with dozens
//! of figures can be committed and sent.

use std::collections::HashMap;

use anyhow::Result;
use color_quant::NeuQuant;
use fairing_figure::Image;
use png::{BitDepth, ColorType, Compression, Encoder};

/// Entries of a palette.
const ENTRIES: usize = 256;

/// Has an entry of its own, so that it stays exact.
const PAPER: [u8; 3] = [255; 3];

/// The picture as a PNG file with a palette; transparency is laid over white.
/// Pictures of at most 256 colours lose nothing.
pub(crate) fn png(image: &Image) -> Result<Vec<u8>> {
    encode(image.width() as usize, image.height() as usize, &over_white(image))
}

/// The same, at most `most` pixels wide. Each pixel is the mean, in linear
/// light, of the pixels that it covers.
pub(crate) fn narrow_png(image: &Image, most: usize) -> Result<Vec<u8>> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    if width <= most {
        return png(image);
    }
    let tall = (height * most).div_ceil(width);
    encode(most, tall, &narrow(&over_white(image), [width, height], [most, tall]))
}

/// The pixels without transparency, on white paper.
fn over_white(image: &Image) -> Vec<[u8; 3]> {
    let mixed = |c: u8, alpha: u8| {
        let (c, a) = (u32::from(c), u32::from(alpha));
        ((c * a + 255 * (255 - a) + 127) / 255) as u8
    };
    image.pixels().iter().map(|&[r, g, b, a]| [r, g, b].map(|c| mixed(c, a))).collect()
}

/// `few` pixels from `many`, each given as width and height.
fn narrow(pixels: &[[u8; 3]], many: [usize; 2], few: [usize; 2]) -> Vec<[u8; 3]> {
    let light: [f64; 256] = std::array::from_fn(|c| linear(c as f64 / 255.0));
    let linear: Vec<[f64; 3]> = pixels.iter().map(|p| p.map(|c| light[usize::from(c)])).collect();
    // First along rows, then along columns.
    let (across, down) = (shares(many[0], few[0]), shares(many[1], few[1]));
    let flat: Vec<[f64; 3]> = linear
        .chunks(many[0])
        .flat_map(|row| across.iter().map(|share| weighted(share, |x| row[x])))
        .collect();
    let mut out = Vec::with_capacity(few[0] * few[1]);
    for share in &down {
        for x in 0..few[0] {
            let mean = weighted(share, |y| flat[y * few[0] + x]);
            out.push(mean.map(|c| (255.0 * nonlinear(c)).round().clamp(0.0, 255.0) as u8));
        }
    }
    out
}

/// For each of `few` pixels the first of the `many` that it covers, and their
/// shares.
fn shares(many: usize, few: usize) -> Vec<(usize, Vec<f64>)> {
    let size = many as f64 / few as f64;
    (0..few)
        .map(|i| {
            let (from, to) = (i as f64 * size, (i + 1) as f64 * size);
            let (first, end) = (from as usize, (to.ceil() as usize).min(many));
            let part = |j: usize| to.min((j + 1) as f64) - from.max(j as f64);
            (first, (first..end).map(|j| part(j) / size).collect())
        })
        .collect()
}

fn weighted((first, shares): &(usize, Vec<f64>), pixel: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
    shares.iter().enumerate().fold([0.0; 3], |sum, (i, share)| {
        let p = pixel(first + i);
        [0, 1, 2].map(|k| sum[k] + share * p[k])
    })
}

/// The transfer function of sRGB, inverted.
fn linear(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
}

/// The transfer function of sRGB.
fn nonlinear(c: f64) -> f64 {
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * libm::pow(c, 1.0 / 2.4) - 0.055 }
}

fn encode(width: usize, height: usize, pixels: &[[u8; 3]]) -> Result<Vec<u8>> {
    let (palette, indices) = indexed(pixels);
    let mut out = vec![];
    let mut encoder = Encoder::new(&mut out, width as u32, height as u32);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette.concat());
    encoder.set_filter(png::Filter::NoFilter);
    // The highest level takes three times as long for two percent.
    encoder.set_compression(Compression::Balanced);
    encoder.write_header()?.write_image_data(&indices)?;
    Ok(out)
}

/// A palette, and the entry of each pixel.
fn indexed(pixels: &[[u8; 3]]) -> (Vec<[u8; 3]>, Vec<u8>) {
    let mut palette = pixels.to_vec();
    palette.sort_unstable();
    palette.dedup();
    if palette.len() <= ENTRIES {
        let entry = |(i, &color): (usize, &[u8; 3])| (color, i as u8);
        let known: HashMap<[u8; 3], u8> = palette.iter().enumerate().map(entry).collect();
        return (palette, pixels.iter().map(|color| known[color]).collect());
    }
    let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
    let drawn = pixels.iter().filter(|color| **color != PAPER);
    let drawn: Vec<u8> = drawn.flat_map(|&color| opaque(color)).collect();
    // Every pixel decides on the palette.
    let quantizer = NeuQuant::new(1, ENTRIES - 1, &drawn);
    let mut palette = quantizer.color_map_rgb().as_chunks().0.to_vec();
    let mut known = HashMap::from([(PAPER, palette.len() as u8)]);
    palette.push(PAPER);
    let mut find = |&color: &[u8; 3]| {
        *known.entry(color).or_insert_with(|| quantizer.index_of(&opaque(color)) as u8)
    };
    let indices = pixels.iter().map(&mut find).collect();
    (palette, indices)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels of a file with a palette.
    fn decode(file: &[u8]) -> (usize, Vec<[u8; 3]>) {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(file));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut buffer).unwrap();
        (info.width as usize, buffer[..info.buffer_size()].as_chunks().0.to_vec())
    }

    #[test]
    fn few_colours_are_kept_exactly() {
        let pixels: Vec<[u8; 3]> = (0..64u8).map(|i| [i, 255 - i, 7]).collect();
        let (width, back) = decode(&encode(8, 8, &pixels).unwrap());
        assert_eq!(width, 8);
        assert_eq!(back, pixels);
    }

    /// Two by three pixels become one, of their mean light: half of the light
    /// of white is 188 of 255.
    #[test]
    fn narrowed_pictures_keep_their_light() {
        let stripes: Vec<[u8; 3]> =
            (0..6 * 6).map(|i| if i % 2 == 0 { [255; 3] } else { [0; 3] }).collect();
        let back = narrow(&stripes, [6, 6], [3, 3]);
        assert_eq!(back.len(), 9);
        assert!(back.iter().all(|p| *p == [188; 3]), "{back:?}");
        // Four pixels in three: 1/3 of the second belongs to the first.
        let row = [[255; 3], [0; 3], [0; 3], [255; 3]];
        let back = narrow(&row, [4, 1], [3, 1]);
        let expected = (255.0 * nonlinear(0.75)).round() as u8;
        assert_eq!(back, [[expected; 3], [0; 3], [expected; 3]]);
    }

    /// A ramp through 4096 colours on white: white stays white, areas keep
    /// their mean colour, and no pixel is far off.
    #[test]
    fn many_colours_keep_their_look() {
        let mut pixels = vec![[255; 3]; 64 * 64];
        for (i, p) in pixels.iter_mut().enumerate().take(60 * 64) {
            let (x, y) = ((i % 64) as u8, (i / 64) as u8);
            *p = [4 * x, 4 * y, 128];
        }
        let (_, back) = decode(&encode(64, 64, &pixels).unwrap());
        assert_eq!(back[60 * 64..], pixels[60 * 64..]);
        let mean = |p: &[[u8; 3]], k: usize| {
            p.iter().map(|c| f64::from(c[k])).sum::<f64>() / p.len() as f64
        };
        for block in 0..6 {
            let rows = block * 640..(block + 1) * 640;
            for k in 0..3 {
                let off = mean(&back[rows.clone()], k) - mean(&pixels[rows.clone()], k);
                assert!(off.abs() < 3.0, "block {block}, channel {k}: {off}");
            }
        }
        // 240 entries over a square of 256 × 240 are 16 apart.
        let worst = back.iter().zip(&pixels).flat_map(|(a, b)| (0..3).map(|k| a[k].abs_diff(b[k])));
        assert!(worst.max() <= Some(40));
    }
}
