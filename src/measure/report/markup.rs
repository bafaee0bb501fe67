//! Text and pictures as parts of an SVG or HTML document.

use std::fmt::Write;

/// Text whose characters mean themselves, in content and in attributes.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // No document may hold these at all.
            control if control.is_control() => escaped.push(' '),
            other => escaped.push(other),
        }
    }
    escaped
}

/// A PNG file as an address that needs no file.
#[must_use]
pub fn png_uri(bytes: &[u8]) -> String {
    let mut uri = "data:image/png;base64,".to_owned();
    base64(bytes, &mut uri);
    uri
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8], text: &mut String) {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for chunk in bytes.chunks(3) {
        let bits = chunk.iter().fold(0u32, |bits, byte| bits << 8 | u32::from(*byte))
            << (8 * (3 - chunk.len()));
        for place in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * place)) as usize & 63];
            text.push(if place <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
}

/// Appends formatted text; a string takes all of it.
pub(super) fn put(text: &mut String, part: std::fmt::Arguments) {
    text.write_fmt(part).expect("a string grows");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_rfc() {
        let vectors = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, encoded) in vectors {
            assert_eq!(png_uri(plain.as_bytes()), format!("data:image/png;base64,{encoded}"));
        }
        assert!(png_uri(&[0xfb, 0xff, 0xfe]).ends_with(",+//+"));
    }

    #[test]
    fn no_text_leaves_its_place() {
        assert_eq!(escape("a<b>&\"c\"\n"), "a&lt;b&gt;&amp;&quot;c&quot; ");
    }
}
