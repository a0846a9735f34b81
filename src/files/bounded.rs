//! Reads files and lines up to a length limit, and never waits for a writer of a FIFO.

use std::{
    fs::File,
    io::{self, BufRead, Read},
    path::Path,
};

/// The null device, which reads as an empty file.
const EMPTY: &str = "/dev/null";

/// Opens a regular file. FIFOs and devices are rejected: they may block or be endless.
///
/// # Errors
/// A system error; [`io::ErrorKind::InvalidInput`] for anything but a regular file.
pub fn open_regular(path: &Path) -> io::Result<File> {
    let mut options = File::options();
    // Without the flag, opening a FIFO waits for its writer.
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, rustix::fs::OFlags::NONBLOCK.bits().cast_signed());
    let file = options.read(true).open(path)?;
    if file.metadata()?.is_file() || path == Path::new(EMPTY) {
        return Ok(file);
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "this is not a regular file"))
}

/// Opens a file that the user named: a regular file, or a pipe of this process, such as `/dev/fd/63` for `<(command)`.
///
/// # Errors
/// Like [`open_regular`].
pub fn open_named(path: &Path) -> io::Result<File> {
    // An anonymous pipe has no canonical path.
    let is_pipe = path.exists() && path.canonicalize().is_err();
    if is_pipe { File::open(path) } else { open_regular(path) }
}

/// Reads a regular file of at most `most_bytes`. A file whose metadata states a larger size is not read.
///
/// # Errors
/// Like [`open_regular`]; [`io::ErrorKind::FileTooLarge`] for a longer file.
pub fn read_file(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    read_opened(open_regular(path)?, most_bytes)
}

/// Like [`read_file`], for a file that the user named, see [`open_named`].
///
/// # Errors
/// Like [`read_file`].
pub fn read_named(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    read_opened(open_named(path)?, most_bytes)
}

fn read_opened(file: File, most_bytes: u64) -> io::Result<Vec<u8>> {
    if file.metadata()?.len() > most_bytes {
        return Err(too_long("file", most_bytes));
    }
    read_stream(file, most_bytes)
}

/// Reads a stream of at most `most_bytes`.
///
/// # Errors
/// A system error; [`io::ErrorKind::FileTooLarge`] for a longer stream, after reading one byte more than the limit.
pub fn read_stream(stream: impl Read, most_bytes: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    stream.take(most_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes { Err(too_long("file", most_bytes)) } else { Ok(bytes) }
}

/// Reads the next line into `line`, without its line break. Returns `false` at the end.
///
/// # Errors
/// A system error; [`io::ErrorKind::FileTooLarge`] for a line of more than `most_bytes`.
pub fn read_line(stream: &mut impl BufRead, line: &mut Vec<u8>, most_bytes: u64) -> io::Result<bool> {
    line.clear();
    // The two extra bytes are for a line break.
    stream.by_ref().take(most_bytes.saturating_add(2)).read_until(b'\n', line)?;
    let is_line = !line.is_empty();
    if line.last() == Some(&b'\n') {
        line.pop();
        line.pop_if(|byte| *byte == b'\r');
    }
    if line.len() as u64 > most_bytes { Err(too_long("line", most_bytes)) } else { Ok(is_line) }
}

/// The error for a file or line above the limit.
fn too_long(what: &str, most_bytes: u64) -> io::Error {
    io::Error::new(io::ErrorKind::FileTooLarge, format!("the {what} is longer than {most_bytes} bytes, the limit"))
}

/// Maximum number of APP1 and APP2 segments in a JPEG. They hold profiles, previews and metadata of up to 64 KB each,
/// which decoders keep in memory.
const MOST_JPEG_SEGMENTS: usize = 512;

/// The number of bytes of ones that [`complete_jpeg`] adds. Decoders read up to 8 bytes ahead.
const ONES: usize = 32;

/// Checks a JPEG for a strict decoder, and adds ones after its pixels. If the data ends early, decoders read zeros, which
/// are valid codes. No code has only ones [ITU T.81, section C.2], so decoding then fails.
///
/// # Errors
/// The JPEG is cut off, has more metadata segments than a decoder should keep, or is a baseline JPEG with a scan for each
/// colour, of which zune-jpeg 0.5 decodes only some rows.
pub fn complete_jpeg(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let is_kept = |pair: &&[u8]| matches!(pair, [0xff, 0xe1 | 0xe2]);
    if bytes.windows(2).filter(is_kept).nth(MOST_JPEG_SEGMENTS).is_some() {
        return Err(format!("more than {MOST_JPEG_SEGMENTS} segments of metadata"));
    }
    let (end, has_one_scan) = end_of_jpeg(bytes).ok_or("it is cut off: its end marker is missing")?;
    if !has_one_scan {
        return Err("its colours have separate scans; save it with one scan, or progressive".to_owned());
    }
    Ok([&bytes[..end], &[0xff, 0].repeat(ONES), &[0xff, 0xd9]].concat())
}

/// The position of the end marker, and whether the JPEG is progressive or has one scan. Thumbnails in metadata and
/// images after the first have markers of their own.
fn end_of_jpeg(bytes: &[u8]) -> Option<(usize, bool)> {
    let (mut at, mut scans, mut is_progressive) = (2, 0, false);
    loop {
        // Zeros and restart markers are between pixels.
        let is_marker = |pair: &[u8]| pair[0] == 0xff && !matches!(pair[1], 0 | 0xff | 0xd0..=0xd7);
        at += bytes.get(at..)?.windows(2).position(is_marker)?;
        match bytes[at + 1] {
            0xd9 => return Some((at, is_progressive || scans <= 1)),
            0xc2 => is_progressive = true,
            0xda => scans += 1,
            _ => {}
        }
        at += 2 + usize::from(u16::from_be_bytes(*bytes.get(at + 2..)?.first_chunk()?));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        std::fs::write(&path, "abc").expect("a file");
        assert_eq!(read_file(&path, 3).expect("three bytes"), b"abc");
        let refused = read_file(&path, 2).expect_err("a byte more");
        assert_eq!(refused.to_string(), "the file is longer than 2 bytes, the limit");
    }

    #[cfg(unix)]
    #[test]
    fn only_regular_files_and_open_pipes_are_read() {
        use std::os::fd::AsRawFd as _;

        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        rustix::fs::mknodat(rustix::fs::CWD, path("fifo"), rustix::fs::FileType::Fifo, rustix::fs::Mode::RWXU, 0)
            .expect("a FIFO");
        std::fs::write(path("file"), "abc").expect("a file");
        for (name, to) in [("zero", "/dev/zero"), ("to-fifo", "fifo"), ("to-file", "file")] {
            std::os::unix::fs::symlink(to, path(name)).expect("a link");
        }
        for read in [read_file, read_named] {
            for name in ["fifo", "zero", "to-fifo", "."] {
                let refused = read(&path(name), 9).expect_err(name).to_string();
                assert_eq!(refused, "this is not a regular file", "{name}");
            }
            assert_eq!(read(&path("missing"), 9).expect_err("no file").kind(), io::ErrorKind::NotFound);
            assert_eq!(read(&path("to-file"), 3).expect("a link to a file"), b"abc");
            assert_eq!(read(Path::new(EMPTY), 3).expect("no bytes"), b"");
        }
        let of_pipe = |read: fn(&Path, u64) -> io::Result<Vec<u8>>, most_bytes| {
            let (reader, mut writer) = io::pipe().expect("a pipe");
            io::Write::write_all(&mut writer, b"abc").expect("three bytes");
            drop(writer);
            read(Path::new(&format!("/dev/fd/{}", reader.as_raw_fd())), most_bytes)
        };
        assert_eq!(of_pipe(read_named, 3).expect("three bytes"), b"abc");
        assert_eq!(of_pipe(read_named, 2).expect_err("a byte more").kind(), io::ErrorKind::FileTooLarge);
        assert!(of_pipe(read_file, 3).is_err());
    }

    #[test]
    fn lines_end_at_line_breaks_and_at_the_end() {
        let mut stream: &[u8] = b"abc\r\n\nab";
        let mut line = Vec::new();
        for expected in [&b"abc"[..], b"", b"ab"] {
            assert!(read_line(&mut stream, &mut line, 3).expect("a line"));
            assert_eq!(line, expected);
        }
        assert!(!read_line(&mut stream, &mut line, 3).expect("the end"));
    }

    #[test]
    fn a_longer_line_is_refused() {
        let mut line = Vec::new();
        for stream in [&b"abcd\n"[..], b"abcd", b"abcdefgh"] {
            assert!(read_line(&mut { stream }, &mut line, 3).is_err(), "{stream:?}");
        }
        let mut endless = io::BufReader::new(io::repeat(0));
        assert!(read_line(&mut endless, &mut line, 4096).is_err());
    }
}
