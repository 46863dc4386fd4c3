//! Reads the boxes of an MP4 file.

/// A box: its path such as `moov/trak`, and the range of its content.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) path: String,
    pub(super) content: std::ops::Range<usize>,
}

/// A number of four bytes.
pub(super) fn number(bytes: &[u8], place: usize) -> usize {
    u32::from_be_bytes(bytes[place..place + 4].try_into().expect("four bytes")) as usize
}

/// All boxes of a file in order. Panics if lengths are inconsistent.
pub(super) fn read(bytes: &[u8]) -> Vec<Found> {
    let mut found = Vec::new();
    within(bytes, 0..bytes.len(), "", &mut found);
    found
}

fn within(bytes: &[u8], part: std::ops::Range<usize>, path: &str, found: &mut Vec<Found>) {
    let mut place = part.start;
    while place < part.end {
        let length = number(bytes, place);
        assert!(length >= 8 && place + length <= part.end, "{path}: a box of {length} bytes at {place}");
        let name = std::str::from_utf8(&bytes[place + 4..place + 8]).expect("a name");
        let path = if path.is_empty() { name.to_string() } else { format!("{path}/{name}") };
        let content = place + 8..place + length;
        found.push(Found { path: path.clone(), content: content.clone() });
        // The number of bytes before the first inner box.
        let head = match name {
            "moov" | "trak" | "mdia" | "minf" | "dinf" | "stbl" => Some(0),
            "stsd" | "dref" => Some(8),
            "avc1" => Some(78),
            _ => None,
        };
        if let Some(head) = head {
            within(bytes, content.start + head..content.end, &path, found);
        }
        place += length;
    }
}

/// The content of the only box with this path.
pub(super) fn only<'a>(bytes: &'a [u8], path: &str) -> &'a [u8] {
    let mut found = read(bytes).into_iter().filter(|found| found.path == path);
    let first = found.next().unwrap_or_else(|| panic!("no {path}"));
    assert!(found.next().is_none(), "two {path}");
    &bytes[first.content]
}

/// The parameters of a film and its pictures, found through its boxes.
pub(super) fn units(bytes: &[u8]) -> (Vec<&[u8]>, Vec<&[u8]>) {
    let table = "moov/trak/mdia/minf/stbl";
    let configuration = only(bytes, &format!("{table}/stsd/avc1/avcC"));
    assert_eq!((configuration[0], configuration[4], configuration[5]), (1, 0xFF, 0xE1));
    let sized = |place: usize| {
        let length = usize::from(u16::from_be_bytes([configuration[place], configuration[place + 1]]));
        &configuration[place + 2..place + 2 + length]
    };
    let sequence = sized(6);
    let picture = sized(8 + sequence.len() + 1);
    let sizes = only(bytes, &format!("{table}/stsz"));
    let mut place = number(only(bytes, &format!("{table}/co64")), 12);
    let mut pictures = Vec::new();
    for sample in 0..number(sizes, 8) {
        let size = number(sizes, 12 + 4 * sample);
        assert_eq!(number(bytes, place), size - 4, "sample {sample}");
        pictures.push(&bytes[place + 4..place + size]);
        place += size;
    }
    assert_eq!(place, bytes.len(), "the last picture ends the file");
    (vec![sequence, picture], pictures)
}
