//! Bytes as text of 85 signs, five for four bytes: a sixteenth shorter than base64.

/// The text of bytes, which `bytesOfDigits` of `crates/web/assets/page.mjs` reads.
///
/// Four bytes are a number, the first byte the highest, and five digits to the base 85. The digit d
/// is the character of code 40 + d, except that `}` stands for `<`, which could end a script. Of
/// the last n < 4 bytes there are n + 1 digits.
pub(crate) fn encode(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(4) * 5);
    for group in bytes.chunks(4) {
        let mut four = [0; 4];
        four[..group.len()].copy_from_slice(group);
        let number = u32::from_be_bytes(four);
        for place in (0..5).rev().take(group.len() + 1) {
            let digit = number / 85_u32.pow(place) % 85;
            match char::from(40 + digit as u8) {
                '<' => text.push('}'),
                sign => text.push(sign),
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_of_four_bytes_are_five_digits() {
        assert_eq!(encode(&[0; 4]), "(((((");
        assert_eq!(encode(&[255; 4]), "z?^4(");
        assert_eq!(encode(&[0, 0, 0, 20]), "((((}");
        assert_eq!(encode(&[0, 0, 0, 0, 1]), "((((((C");
    }
}
