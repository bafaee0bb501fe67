//! Rays as text: six numbers a line with commas between; blank lines are skipped, and so is what follows a `#` at the
//! beginning of a word. Numbers and names may stand in double quotes.

use std::borrow::Cow;

use crate::scene::text::{before_comment, number, with_line_feeds};

/// Characters of a bad line that a message shows.
const SHOWN: usize = 60;

/// A line that is not a ray.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct BadLine {
    /// Its number from 1 in the text at hand.
    pub number: u64,
    /// What is wrong.
    pub problem: String,
}

/// The columns, as a header may name them.
const COLUMNS: [&str; 6] = ["ox", "oy", "oz", "tx", "ty", "tz"];

/// How many bytes a byte order mark and a line of column names take at the beginning of a file, and how
/// many lines that is. Comments may come before.
///
/// Only our own names in our own order are a header: other words may be damaged numbers, and in another
/// order the columns mean something else.
pub(super) fn header(bytes: &[u8]) -> (usize, u64) {
    let mark = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut end = mark;
    let line_end = line_end(bytes);
    for (number, line) in (1..).zip(bytes[mark..].split_inclusive(|&byte| byte == line_end)) {
        end += line.len();
        let line = String::from_utf8_lossy(line);
        if is_row(&line) {
            let names = fields(&line).map(str::to_lowercase).eq(COLUMNS);
            return if names { (end, number) } else { (mark, 0) };
        }
    }
    (mark, 0)
}

/// What ends the lines of a text: a carriage return where there is no line feed at all, as on old Macintoshes.
fn line_end(bytes: &[u8]) -> u8 {
    if bytes.contains(&b'\n') { b'\n' } else { b'\r' }
}

/// Where the last line ends of a text that may be cut within a line.
pub(super) fn last_line_end(bytes: &[u8]) -> Option<usize> {
    let line_end = line_end(bytes);
    bytes.iter().rposition(|&byte| byte == line_end)
}

/// Cuts text into parts of whole lines, each of about `size` bytes.
pub(super) fn parts(mut bytes: &[u8], size: usize) -> Vec<&[u8]> {
    let mut parts = Vec::new();
    let line_end = line_end(bytes);
    while !bytes.is_empty() {
        let after = size.min(bytes.len());
        let end = bytes[after..].iter().position(|&byte| byte == line_end);
        let (part, rest) = bytes.split_at(end.map_or(bytes.len(), |at| after + at + 1));
        parts.push(part);
        bytes = rest;
    }
    parts
}

/// Decodes whole lines; gives their number.
pub(super) fn decode(bytes: &[u8], rows: &mut Vec<[f64; 6]>) -> Result<u64, BadLine> {
    let (text, is_text) = match std::str::from_utf8(bytes) {
        Ok(text) => (text, true),
        Err(error) => {
            let valid = &bytes[..error.valid_up_to()];
            let lines = last_line_end(valid).map_or(0, |at| at + 1);
            (std::str::from_utf8(&valid[..lines]).expect("cut after a line"), false)
        }
    };
    let mut count = 0;
    for line in with_line_feeds(Cow::Borrowed(text)).lines() {
        count += 1;
        if let Some(row) = row(line) {
            rows.push(row);
        } else if is_row(line) {
            return Err(BadLine { number: count, problem: problem_of(line) });
        }
    }
    if !is_text {
        let problem = "this is not text; give CSV or .npy".to_owned();
        return Err(BadLine { number: count + 1, problem });
    }
    Ok(count)
}

/// What is wrong with a line that is no row.
fn problem_of(line: &str) -> String {
    let shown: String = line.trim().chars().take(SHOWN).collect();
    let row = before_comment(line);
    let has_six = |parts: &mut dyn Iterator<Item = &str>| parts.count() == COLUMNS.len();
    let found = if has_six(&mut row.split(';')) {
        "semicolons"
    } else if has_six(&mut row.split('\t')) {
        "tabs"
    } else if has_six(&mut row.split_whitespace()) && !row.contains(',') {
        "blanks"
    } else {
        return format!(
            "'{shown}' is not six numbers with commas between; give ox,oy,oz,tx,ty,tz in this order (a header has these names)"
        );
    };
    format!(
        "'{shown}' has {found} between its numbers; give commas, and points within numbers (numpy.savetxt: delimiter=',')"
    )
}

fn is_row(line: &str) -> bool {
    !before_comment(line).trim().is_empty()
}

/// What stands between the commas before a comment, without blanks and quotes around it.
fn fields(line: &str) -> impl Iterator<Item = &str> {
    before_comment(line).split(',').map(|field| {
        let field = field.trim();
        let quoted = field.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
        quoted.map_or(field, str::trim)
    })
}

fn row(line: &str) -> Option<[f64; 6]> {
    let mut words = fields(line).map(number);
    let mut row = [0.0; 6];
    for number in &mut row {
        *number = words.next()??;
    }
    words.next().is_none().then_some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_in_order_around_blank_lines_and_comments() {
        let mut rows = Vec::new();
        let text = "1,2,3,4,5,6\r\n\n# a comment\n -1 , +2e3,.5 ,5., nan,-inf";
        assert_eq!(decode(text.as_bytes(), &mut rows), Ok(4));
        assert_eq!(rows[0], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(rows[1][..4], [-1.0, 2000.0, 0.5, 5.0]);
        assert!(rows[1][4].is_nan() && rows[1][5] == f64::NEG_INFINITY && rows.len() == 2);
    }

    #[test]
    fn a_bad_line_is_named() {
        for bad in ["1,2,3,4,5", "1,2,3,4,5,6,7", "1,2,3,4,5,6,", "1 2 3 4 5 6", "1,2,x,4,5,6", ","]
        {
            let text = format!("1,2,3,4,5,6\n\n{bad}\n1,2,3,4,5,6\n");
            let error = decode(text.as_bytes(), &mut Vec::new()).unwrap_err();
            assert_eq!(error.number, 3);
            assert!(error.problem.contains(bad));
        }
        let error = decode(b"1,2,3,4,5,6\n1,2,\xff,4,5,6\n", &mut Vec::new()).unwrap_err();
        assert_eq!((error.number, error.problem.contains("not text")), (2, true));
    }

    #[test]
    fn a_separator_that_is_no_comma_is_named() {
        for (line, found) in [
            ("1;2;3;4;5;6", "semicolons"),
            ("1,5;2,5;3,5;4;5;6 # Europe", "semicolons"),
            ("1\t2\t3\t4\t5\t6", "tabs"),
            ("1.0e0 2 3  4 5 6", "blanks"),
        ] {
            let error = decode(line.as_bytes(), &mut Vec::new()).unwrap_err();
            let told = format!("has {found} between its numbers; give commas");
            assert!(error.problem.contains(&told), "{}", error.problem);
        }
    }

    #[test]
    fn a_comment_may_follow_a_row() {
        let mut rows = Vec::new();
        assert_eq!(
            decode(b"1,2,3,4,5,6 # the first\n\t# none\n1,2,3,4,5,1.#INF\n", &mut rows),
            Ok(3)
        );
        assert_eq!((rows.len(), rows[0][5], rows[1][5]), (2, 6.0, f64::INFINITY));
        assert_eq!(header(b"ox,oy,oz,tx,ty,tz # in metres\n1,2,3,4,5,6\n").1, 1);
        assert!(decode(b"1,2,3,4,5, # six\n", &mut rows).is_err());
    }

    #[test]
    fn lines_may_end_as_on_an_old_macintosh() {
        let mut rows = Vec::new();
        let text = b"ox,oy,oz,tx,ty,tz\r1,2,3,4,5,6\r\r7,8,9,0,1,2\roops";
        assert_eq!((header(text), last_line_end(text)), ((18, 1), Some(42)));
        assert_eq!(decode(&text[18..43], &mut rows), Ok(3));
        assert_eq!(rows[1], [7.0, 8.0, 9.0, 0.0, 1.0, 2.0]);
        assert_eq!(decode(&text[18..], &mut rows).unwrap_err().number, 4);
        assert_eq!(parts(&text[18..], 1).len(), 3);
    }

    #[test]
    fn numbers_in_quotes_are_read() {
        let mut rows = Vec::new();
        assert_eq!(decode(b"\"1\",\" 2\", \"3\" ,4,\"5\",\"6\"\n", &mut rows), Ok(1));
        assert_eq!(rows, [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]]);
        assert!(decode(b"\"1,2,3,4,5,6\n", &mut rows).is_err());
    }

    #[test]
    fn a_header_is_our_names_in_our_order() {
        assert_eq!(header(b"ox,oy,oz,tx,ty,tz\n1,2,3,4,5,6\n"), (18, 1));
        assert_eq!(header(b"\xef\xbb\xbf# rays\n\nox,oy,oz,tx,ty,tz\r\n"), (30, 3));
        assert_eq!(header(b"\"OX\", oy,Oz,\"TX\",ty,tz\n"), (23, 1));
        assert_eq!(header(b"\xef\xbb\xbf1,2,3,4,5,6\n"), (3, 0));
        for row in ["1,2,3,4,5,6\n", "nan,nan,nan,nan,nan,nan\n", "a,2,3,4,5,6\n", "a;b;c\n", ""] {
            assert_eq!(header(row.as_bytes()), (0, 0), "{row}");
        }
    }

    #[test]
    fn a_first_line_that_is_no_header_is_no_row_that_may_be_lost() {
        for line in ["tx,ty,tz,ox,oy,oz", "1e,--2,1f,2_0,$3,x", "a,b,c,d,e,f"] {
            assert_eq!(header(line.as_bytes()), (0, 0), "{line}");
            let error = decode(line.as_bytes(), &mut Vec::new()).unwrap_err();
            assert!(error.problem.contains("give ox,oy,oz,tx,ty,tz in this order"));
        }
    }

    #[test]
    fn parts_are_whole_lines() {
        let text = b"12\n3\n45678\n9";
        for size in 0..20 {
            let parts = parts(text, size);
            assert_eq!(parts.concat(), text);
            assert!(parts[..parts.len() - 1].iter().all(|part| part.ends_with(b"\n")));
        }
    }
}
