//! Names of functions, which a page does not need.

/// The module without its custom sections; `None` if it ends too early.
///
/// A module is eight bytes and sections: a number, 0 for custom ones, the length of the rest, and
/// the rest.
pub(super) fn stripped(module: &[u8]) -> Option<Vec<u8>> {
    let (head, mut rest) = module.split_at_checked(8)?;
    let mut kept = head.to_vec();
    while !rest.is_empty() {
        let (length, bytes) = number(&rest[1..])?;
        let (section, after) = rest.split_at_checked(1 + bytes + length)?;
        if section[0] != 0 {
            kept.extend(section);
        }
        rest = after;
    }
    Some(kept)
}

/// A number of seven bits a byte, the lowest first, and the bytes that it takes.
fn number(bytes: &[u8]) -> Option<(usize, usize)> {
    let last = bytes.iter().take(5).position(|byte| byte & 0x80 == 0)?;
    let digits = bytes[..=last].iter().rev();
    Some((digits.fold(0, |sum, byte| (sum << 7) | usize::from(byte & 0x7f)), last + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_custom_sections_go() {
        let head = b"\0asm\x01\0\0\0";
        let code = [&[10, 0x81, 0x01][..], &[7; 129]].concat();
        let names = [0, 2, 1, b'x'];
        let module = [&head[..], &names, &code, &names].concat();
        assert_eq!(stripped(&module).unwrap(), [&head[..], &code].concat());
        assert_eq!(stripped(&module[..module.len() - 1]), None);
    }
}
