//! The `.npy` files of NumPy: rays in, answers out.

/// What every `.npy` file begins with.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// What to do about a damaged file.
pub(super) const SAVE_AGAIN: &str = "save it again with numpy.save";

/// Numbers in a row.
const COLUMNS: usize = 6;

/// The header of the answers is padded to a multiple of this, as NumPy does.
const ALIGNMENT: usize = 64;

/// How the rays of a file lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Rows that the file says it has.
    pub rows: u64,
    /// Whether numbers are f64 rather than f32.
    double: bool,
}

impl Layout {
    /// Reads the header, which must be whole; also says how long it is.
    pub fn read(bytes: &[u8]) -> Result<(Self, usize), String> {
        let short = || format!("it ends within its header; {SAVE_AGAIN}");
        let version = *bytes.get(MAGIC.len()).ok_or_else(short)?;
        let at = MAGIC.len() + 2;
        let field = |size: usize| bytes.get(at..at + size).ok_or_else(short);
        let (start, length) = match version {
            1 => (at + 2, u32::from(u16::from_le_bytes(field(2)?.try_into().expect("2 bytes")))),
            2 | 3 => (at + 4, u32::from_le_bytes(field(4)?.try_into().expect("4 bytes"))),
            other => {
                return Err(format!(
                    "version {other} of .npy is unknown; versions 1 to 3 are read"
                ));
            }
        };
        let end = start + length as usize;
        let header = String::from_utf8_lossy(bytes.get(start..end).ok_or_else(short)?);
        Ok((Self::parse(&header)?, end))
    }

    /// Understands `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 6), }`.
    fn parse(header: &str) -> Result<Self, String> {
        // Python writes either quote around a string.
        let header = header.replace('"', "'");
        let value = |key: &str| {
            let (_, rest) = header
                .split_once(&format!("'{key}':"))
                .ok_or_else(|| format!("its header has no '{key}'; {SAVE_AGAIN}"))?;
            Ok::<_, String>(rest.trim_start())
        };
        let kind = value("descr")?;
        let double = match kind.get(..5) {
            Some("'<f4'") => false,
            Some("'<f8'") => true,
            _ => return Err(other_numbers(kind)),
        };
        if !value("fortran_order")?.starts_with("False") {
            return Err(
                "it is in Fortran order; save numpy.ascontiguousarray(rays) instead".to_owned()
            );
        }
        let shape = value("shape")?.split_inclusive(')').next().unwrap_or_default();
        let inner = shape.trim_start_matches('(').trim_end_matches(')');
        let sizes: Vec<u64> = inner
            .split(',')
            .map(str::trim)
            .filter(|size| !size.is_empty())
            .map_while(|size| size.trim_end_matches('L').parse().ok())
            .collect();
        match sizes[..] {
            [rows, columns] if columns == COLUMNS as u64 => Ok(Self { rows, double }),
            _ => {
                Err(format!("its shape is {shape}; give (N, 6), the rows being ox,oy,oz,tx,ty,tz"))
            }
        }
    }

    /// Bytes of a row.
    pub fn row_bytes(self) -> usize {
        COLUMNS * if self.double { size_of::<f64>() } else { size_of::<f32>() }
    }

    /// Decodes whole rows.
    pub fn decode(self, bytes: &[u8], rows: &mut Vec<[f64; COLUMNS]>) {
        /// The numbers of a row, `N` bytes each.
        fn row<const N: usize>(bytes: &[u8], read: impl Fn([u8; N]) -> f64) -> [f64; COLUMNS] {
            let (numbers, _) = bytes.as_chunks::<N>();
            std::array::from_fn(|i| read(numbers[i]))
        }
        let whole = bytes.chunks_exact(self.row_bytes());
        if self.double {
            rows.extend(whole.map(|bytes| row(bytes, f64::from_le_bytes)));
        } else {
            rows.extend(whole.map(|bytes| row(bytes, |number| f32::from_le_bytes(number).into())));
        }
    }
}

/// What is said of numbers that are not ours; the header goes on after them.
fn other_numbers(header: &str) -> String {
    if header.starts_with('[') {
        let flat = "numpy.lib.recfunctions.structured_to_unstructured(rays)";
        return format!("its rows are of named fields, not of six numbers; save {flat} instead");
    }
    let kind = header.split(',').next().unwrap_or(header);
    format!("its numbers are {kind}; save rays.astype('<f8') or '<f4' instead")
}

/// The header of an array of `rows` bytes.
pub(super) fn header(rows: u64) -> Vec<u8> {
    let mut text = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({rows},), }}");
    let before = MAGIC.len() + 4;
    let padded = (before + text.len() + 1).next_multiple_of(ALIGNMENT) - before;
    text.push_str(&" ".repeat(padded - text.len() - 1));
    text.push('\n');
    let length = u16::try_from(text.len()).expect("the header is short");
    [MAGIC, &[1, 0], &length.to_le_bytes(), text.as_bytes()].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u8, header: &str) -> Vec<u8> {
        let length = header.len() as u32;
        let length = &length.to_le_bytes()[..if version == 1 { 2 } else { 4 }];
        [MAGIC, &[version, 0], length, header.as_bytes(), b"rest"].concat()
    }

    #[test]
    fn headers_of_all_versions_are_read() {
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (7, 6), }   \n";
        for version in 1..=3 {
            let bytes = file(version, header);
            let (layout, length) = Layout::read(&bytes).unwrap();
            assert_eq!(layout, Layout { rows: 7, double: false });
            assert_eq!(&bytes[length..], b"rest");
        }
    }

    #[test]
    fn either_quote_is_read() {
        let header = "{\"descr\": \"<f8\", \"fortran_order\": False, \"shape\": (7, 6)}\n";
        let (layout, _) = Layout::read(&file(1, header)).unwrap();
        assert_eq!(layout, Layout { rows: 7, double: true });
    }

    #[test]
    fn other_arrays_are_refused_with_what_to_do() {
        for (kind, order, shape, told) in [
            ("'<i4'", "False", "(7, 6)", "its numbers are '<i4'; save rays.astype"),
            ("'>f8'", "False", "(7, 6)", "its numbers are '>f8'"),
            ("'|O'", "False", "(7, 6)", "its numbers are '|O'; save"),
            (
                "[('x', '<f8'), ('y', '<f4', (2,))]",
                "False",
                "(7,)",
                "its rows are of named fields, not of six numbers; save numpy.lib.recfunctions",
            ),
            ("'<f8'", "True", "(7, 6)", "numpy.ascontiguousarray"),
            ("'<f8'", "False", "(7, 3)", "its shape is (7, 3); give (N, 6)"),
            ("'<f8'", "False", "(6,)", "its shape is (6,)"),
            ("'<f8'", "False", "()", "its shape is ()"),
            ("'<f8'", "False", "(7, 6, 1)", "its shape is (7, 6, 1)"),
            ("'<f8'", "False", "(-7, 6)", "its shape is (-7, 6)"),
        ] {
            let header =
                format!("{{'descr': {kind}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
            let problem = Layout::read(&file(1, &header)).unwrap_err();
            assert!(problem.contains(told), "{problem}");
        }
        assert!(Layout::read(&file(4, "")).unwrap_err().contains("version 4"));
        assert!(Layout::read(&file(1, "{}")).unwrap_err().contains("no 'descr'; save it again"));
        let whole = file(2, "{'descr': '<f4', 'fortran_order': False, 'shape': (7, 6), }\n");
        for length in MAGIC.len()..whole.len() - "rest".len() {
            assert!(Layout::read(&whole[..length]).unwrap_err().contains("ends within"));
        }
    }

    #[test]
    fn the_header_of_the_answers_is_aligned() {
        for rows in [0, 1, 100_000_000, u64::MAX] {
            let bytes = header(rows);
            assert_eq!(bytes.len() % ALIGNMENT, 0);
            assert!(bytes.ends_with(b"\n"));
        }
    }
}
