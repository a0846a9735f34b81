//! Answers that no handler gives, as bytes: to connections beyond a limit, and in place of hyper's own.

use std::fmt::Write as _;

use super::super::{kind::ProblemKind, problem::Problem};

/// Longer than any answer that hyper writes by itself.
const LONGEST_BARE: usize = 256;

/// A whole answer with the problem's document, after which the connection is closed.
pub(super) fn answer(problem: &Problem) -> Vec<u8> {
    let retry_after = problem.retry_after_seconds();
    let status = problem.status();
    // A document of texts and numbers is always JSON.
    let body = serde_json::to_vec(problem).unwrap_or_default();
    let mut head = format!(
        "HTTP/1.1 {status}\r\ncontent-type: application/problem+json\r\ncontent-length: {}\r\nconnection: close\r\n",
        body.len()
    );
    if let Some(seconds) = retry_after {
        // Writing to a String cannot fail.
        let _ = write!(head, "retry-after: {seconds}\r\n");
    }
    head.push_str("\r\n");
    [head.into_bytes(), body].concat()
}

/// The answer to write in place of `written`, if that is one that hyper gives by itself to a `head` that it cannot read:
/// a status and no document. The service's own answers of these statuses have a content type.
pub(super) fn in_place_of(written: &[u8], head: &[u8]) -> Option<Vec<u8>> {
    if written.len() > LONGEST_BARE {
        return None;
    }
    let bare = str::from_utf8(written).ok()?;
    let status = bare.strip_prefix("HTTP/1.1 ").or_else(|| bare.strip_prefix("HTTP/1.0 "))?.get(..3)?;
    if !bare.ends_with("\r\n\r\n") || bare.contains("content-type:") {
        return None;
    }
    let of_length = if ["400", "431"].contains(&status) { length_problem(head) } else { None };
    if let Some(problem) = of_length {
        return Some(answer(&problem));
    }
    let problem = match status {
        "400" => Problem::new(ProblemKind::BadRequest, "the head of the request is not that of HTTP/1.1"),
        "414" => Problem::new(ProblemKind::UriTooLong, "path and query of a request take at most 65534 bytes"),
        "431" => {
            let detail = "the head of a request takes at most 131072 bytes and 100 fields";
            Problem::new(ProblemKind::HeadTooLarge, detail)
        }
        _ => return None,
    };
    Some(answer(&problem))
}

/// Why hyper refuses the `Content-Length` of a head, if it does: it takes one number, of at most 2^64 - 3.
fn length_problem(head: &[u8]) -> Option<Problem> {
    let lines = head.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii).take_while(|line| !line.is_empty());
    let fields = lines.filter_map(|line| line.split_at_checked(line.iter().position(|byte| *byte == b':')?));
    let lengths = fields.filter(|(name, _)| name.eq_ignore_ascii_case(b"content-length"));
    let lengths: Vec<_> = lengths.map(|(_, value)| String::from_utf8_lossy(&value[1..]).trim().to_owned()).collect();
    let is_number = |length: &&String| !length.is_empty() && length.bytes().all(|byte| byte.is_ascii_digit());
    if let Some(other) = lengths.iter().find(|length| !is_number(length)) {
        let detail = format!("Content-Length is «{other}», which is no number of bytes");
        return Some(Problem::new(ProblemKind::BadRequest, detail));
    }
    if let Some(long) = lengths.iter().find(|length| length.parse::<u64>().map_or(true, |bytes| bytes >= u64::MAX - 1))
    {
        let detail = format!("Content-Length is {long}, and no body may be as long");
        return Some(Problem::new(ProblemKind::BodyTooLarge, detail));
    }
    let first = lengths.first()?;
    let other = lengths.iter().find(|length| *length != first)?;
    Some(Problem::new(ProblemKind::BadRequest, format!("Content-Length is both {first} and {other}")))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn only_an_answer_without_a_document_is_replaced() {
        let bare = |status: &str| {
            format!("HTTP/1.1 {status}\r\nconnection: close\r\ncontent-length: 0\r\ndate: Thu, 01 Jan 1970\r\n\r\n")
        };
        for status in ["400 Bad Request", "414 URI Too Long", "431 Request Header Fields Too Large"] {
            let problem = in_place_of(bare(status).as_bytes(), b"").expect(status);
            let text = String::from_utf8(problem).expect("UTF-8");
            assert!(text.starts_with(&format!("HTTP/1.1 {}", &status[..4])), "{text}");
            assert!(text.contains("application/problem+json") && text.contains("/problems/"), "{text}");
        }
        let others = [
            bare("200 OK"),
            bare("404 Not Found"),
            bare("400 Bad Request").replace("date:", "content-type:"),
            bare("400 Bad Request") + "x",
            String::new(),
        ];
        for other in others {
            assert_eq!(in_place_of(other.as_bytes(), b""), None, "{other}");
        }
    }

    #[test]
    fn an_answer_is_as_long_as_it_says() {
        let problem = Problem::new(ProblemKind::TooManyConnections, "x").with_retry_after(Duration::from_secs(2));
        let text = String::from_utf8(answer(&problem)).expect("UTF-8");
        let (head, body) = text.split_once("\r\n\r\n").expect("a head");
        assert!(head.contains(&format!("content-length: {}", body.len())), "{head}");
        assert!(head.contains("retry-after: ") && head.starts_with("HTTP/1.1 503 Service Unavailable\r\n"), "{head}");
    }
}
