//! Pictures in 256 colours, whose files have a third of the size.
//!
//! Colours are chosen by splitting boxes of colours where they vary most and moving each choice to
//! the mean of the colours that it stands for. What is left is spread over neighbouring pixels
//! (Floyd and Steinberg 1976). Paper, ink and flat areas stay exact, which quantisers for
//! photographs do not promise.

use png::{BitDepth, ColorType, Compression, Encoder};

use crate::error::FigureError;
use crate::image::Image;

/// Entries of a palette.
const ENTRIES: usize = 256;

/// Bits of each channel that tell colours apart while the palette is chosen.
const BITS: u32 = 5;

/// Rounds in which choices move to the mean of their colours.
const ROUNDS: usize = 4;

/// Colours that make up more of a picture than this get an entry of their own:
/// paper, ink, and flat areas stay exact.
const FLAT: f64 = 0.01;

impl Image {
    /// The bytes of a PNG file with a palette of at most 256 colours (sRGB), at most `widest`
    /// pixels wide if given; transparency is laid over white. Pictures of fewer colours lose
    /// nothing. Each pixel of a narrowed picture is the mean, in linear light, of the pixels
    /// that it covers.
    ///
    /// # Errors
    ///
    /// [`FigureError::Png`] for a picture that PNG cannot hold.
    pub fn to_palette_png(&self, widest: Option<u32>) -> Result<Vec<u8>, FigureError> {
        let (width, height) = (self.width() as usize, self.height() as usize);
        let pixels = over_white(self);
        let encoded = match widest.map(|widest| widest.max(1) as usize) {
            Some(widest) if widest < width => {
                let tall = (height * widest).div_ceil(width);
                encode(widest, tall, &narrow(&pixels, [width, height], [widest, tall]))
            }
            _ => encode(width, height, &pixels),
        };
        encoded.map_err(|source| FigureError::Png(source.to_string()))
    }
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

fn encode(width: usize, height: usize, pixels: &[[u8; 3]]) -> Result<Vec<u8>, png::EncodingError> {
    let palette = choose(pixels);
    let indices = dither(pixels, width, &palette);
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

/// Pixels of nearly one colour.
#[derive(Clone, Copy)]
struct Bin {
    mean: [f64; 3],
    weight: f64,
}

fn choose(pixels: &[[u8; 3]]) -> Vec<[u8; 3]> {
    let mut sorted = pixels.to_vec();
    sorted.sort_unstable();
    let runs: Vec<&[[u8; 3]]> = sorted.chunk_by(|a, b| a == b).collect();
    if runs.len() <= ENTRIES {
        return runs.iter().map(|run| run[0]).collect();
    }
    let (flat, rest): (Vec<&[[u8; 3]]>, Vec<_>) =
        runs.into_iter().partition(|run| run.len() as f64 > FLAT * pixels.len() as f64);
    let mut palette: Vec<[u8; 3]> = flat.iter().map(|run| run[0]).collect();
    let bins = bins(&rest);
    let choices = split(bins.clone(), ENTRIES - palette.len());
    for choice in settle(&bins, choices) {
        palette.push(choice.map(|c| c.round().clamp(0.0, 255.0) as u8));
    }
    palette
}

/// Counts colours that agree in their leading bits.
fn bins(runs: &[&[[u8; 3]]]) -> Vec<Bin> {
    let mut sums = vec![([0.0; 3], 0.0); 1 << (3 * BITS)];
    for run in runs {
        let weight = run.len() as f64;
        let index = run[0].iter().fold(0, |i, &c| i << BITS | usize::from(c >> (8 - BITS)));
        let (sum, total) = &mut sums[index];
        for k in 0..3 {
            sum[k] += weight * f64::from(run[0][k]);
        }
        *total += weight;
    }
    let used = sums.into_iter().filter(|(_, weight)| *weight > 0.0);
    used.map(|(sum, weight)| Bin { mean: sum.map(|s| s / weight), weight }).collect()
}

/// The mean of some colours, and along each channel how much they vary.
fn moments(bins: &[Bin]) -> ([f64; 3], [f64; 3]) {
    let weight: f64 = bins.iter().map(|b| b.weight).sum();
    let sum = |k: usize| bins.iter().map(|b| b.weight * b.mean[k]).sum::<f64>();
    let mean = [0, 1, 2].map(|k| sum(k) / weight);
    let spread = |k: usize| bins.iter().map(|b| b.weight * (b.mean[k] - mean[k]).powi(2)).sum();
    (mean, [0, 1, 2].map(spread))
}

/// Splits the box that varies most, along the channel in which it does, until
/// there are enough.
fn split(bins: Vec<Bin>, count: usize) -> Vec<[f64; 3]> {
    let rated = |bins: Vec<Bin>| {
        let (mean, spread) = moments(&bins);
        let channel = (0..3).max_by(|&a, &b| spread[a].total_cmp(&spread[b])).unwrap_or(0);
        (spread[channel], channel, mean, bins)
    };
    let mut boxes = vec![rated(bins)];
    while boxes.len() < count {
        let worst = (0..boxes.len()).max_by(|&a, &b| boxes[a].0.total_cmp(&boxes[b].0));
        let Some(worst) = worst.filter(|&w| boxes[w].0 > 0.0) else { break };
        let (_, channel, mean, bins) = boxes.swap_remove(worst);
        let (low, high) = bins.into_iter().partition(|b| b.mean[channel] <= mean[channel]);
        boxes.extend([rated(low), rated(high)]);
    }
    boxes.into_iter().map(|(_, _, mean, _)| mean).collect()
}

/// Moves each choice to the mean of the colours nearest to it.
fn settle(bins: &[Bin], mut choices: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    for _ in 0..ROUNDS {
        let mut sums = vec![([0.0; 3], 0.0); choices.len()];
        for bin in bins {
            let (sum, weight) = &mut sums[nearest(&choices, bin.mean)];
            for k in 0..3 {
                sum[k] += bin.weight * bin.mean[k];
            }
            *weight += bin.weight;
        }
        for (choice, (sum, weight)) in choices.iter_mut().zip(sums) {
            if weight > 0.0 {
                *choice = sum.map(|s| s / weight);
            }
        }
    }
    choices
}

fn nearest(choices: &[[f64; 3]], color: [f64; 3]) -> usize {
    let distance = |c: &[f64; 3]| (0..3).map(|k| (c[k] - color[k]).powi(2)).sum::<f64>();
    let mut best = (0, f64::INFINITY);
    for (i, choice) in choices.iter().enumerate() {
        let d = distance(choice);
        if d < best.1 {
            best = (i, d);
        }
    }
    best.0
}

/// An entry for each pixel; what it is off by goes to the neighbours that are
/// still to come. Pixels whose colour has an entry take it.
fn dither(pixels: &[[u8; 3]], width: usize, palette: &[[u8; 3]]) -> Vec<u8> {
    let choices: Vec<[f64; 3]> = palette.iter().map(|c| c.map(f64::from)).collect();
    let exact: std::collections::HashMap<[u8; 3], u8> =
        palette.iter().enumerate().map(|(i, &c)| (c, i as u8)).collect();
    // The nearest entry to each colour of 6 bits a channel, found when needed.
    let mut known = vec![u16::MAX; 1 << 18];
    let mut find = |color: [f64; 3]| {
        let key = color.map(|c| (c.clamp(0.0, 255.0) as usize) >> 2);
        let slot = &mut known[key[0] << 12 | key[1] << 6 | key[2]];
        if *slot == u16::MAX {
            *slot = nearest(&choices, key.map(|k| (4 * k) as f64 + 1.5)) as u16;
        }
        usize::from(*slot)
    };
    let mut indices = Vec::with_capacity(pixels.len());
    let mut below = vec![[0.0; 3]; width + 2];
    for row in pixels.chunks(width) {
        let here = std::mem::replace(&mut below, vec![[0.0; 3]; width + 2]);
        let mut carried = [0.0; 3];
        for (x, pixel) in row.iter().enumerate() {
            if let Some(&index) = exact.get(pixel) {
                indices.push(index);
                carried = [0.0; 3];
                continue;
            }
            let wanted = [0, 1, 2].map(|k| f64::from(pixel[k]) + carried[k] + here[x + 1][k]);
            let index = find(wanted);
            indices.push(index as u8);
            for k in 0..3 {
                let off = (wanted[k] - choices[index][k]).clamp(-48.0, 48.0) / 16.0;
                carried[k] = 7.0 * off;
                below[x][k] += 3.0 * off;
                below[x + 1][k] += 5.0 * off;
                below[x + 2][k] += off;
            }
        }
    }
    indices
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
        // 240 entries over a square of 256 × 240 are 16 apart; with what is
        // carried over, twice that.
        let worst = back.iter().zip(&pixels).flat_map(|(a, b)| (0..3).map(|k| a[k].abs_diff(b[k])));
        assert!(worst.max() <= Some(40));
    }
}
