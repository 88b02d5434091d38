//! Where a request comes from, by what its browser says of it.
//!
//! * `Host` is the name under which the browser believes to have found this server. A foreign name that was
//!   made to lead to 127.0.0.1 (DNS rebinding) would make this server part of that foreign site.
//! * `Origin` is the page that opens a WebSocket, to which no same-origin policy applies: every page can.

use tungstenite::http::header::{AsHeaderName, HOST, ORIGIN};
use tungstenite::http::{StatusCode, Uri};

use super::http::{Request, Response, text};

/// Names of this computer that lead nowhere else.
const LOOPBACK: [&str; 3] = ["localhost", "127.0.0.1", "[::1]"];

/// Who asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// No page: a program.
    Program,
    /// A page of this very server.
    Own,
    /// A page of another server on this computer.
    Loopback,
    /// A page without a server, as one opened from a file (`null`).
    File,
    /// A page of somebody else's.
    Foreign,
}

/// Who asks.
pub fn of(request: &Request) -> Origin {
    let origin = match only(request, ORIGIN) {
        Ok(Some(origin)) => origin,
        Ok(None) => return Origin::Program,
        Err(Several) => return Origin::Foreign,
    };
    if origin == "null" {
        return Origin::File;
    }
    let Some(authority) = ["http://", "https://"]
        .into_iter()
        .find_map(|scheme| origin.strip_prefix(scheme))
    else {
        return Origin::Foreign;
    };
    if !is_loopback(authority) {
        return Origin::Foreign;
    }
    let own = only(request, HOST)
        .ok()
        .flatten()
        .is_some_and(|host| origin.starts_with("http:") && host.eq_ignore_ascii_case(authority));
    if own { Origin::Own } else { Origin::Loopback }
}

/// Refuses a request that was not meant for this computer.
///
/// # Errors
///
/// What to answer.
pub fn check_host(request: &Request) -> Result<(), Response> {
    match only(request, HOST) {
        Ok(Some(host)) if is_loopback(host) => Ok(()),
        Ok(Some(_)) => Err(text(
            StatusCode::FORBIDDEN,
            "This server is for this computer only: open it as localhost, 127.0.0.1 or [::1].",
        )),
        Ok(None) | Err(Several) => Err(text(
            StatusCode::BAD_REQUEST,
            "The request does not say which host it is for (one field `Host`).",
        )),
    }
}

/// The answer to a page that may not have what it asks for.
pub fn forbidden(what: &str) -> Response {
    text(StatusCode::FORBIDDEN, what)
}

struct Several;

/// The one field of this name, if there is one.
fn only(request: &Request, name: impl AsHeaderName) -> Result<Option<&str>, Several> {
    let mut fields = request.headers().get_all(name).iter();
    match (fields.next(), fields.next()) {
        (None, _) => Ok(None),
        // What is not text is the name of nobody.
        (Some(field), None) => Ok(Some(field.to_str().unwrap_or("?"))),
        (Some(_), Some(_)) => Err(Several),
    }
}

/// Whether `name` or `name:port` leads nowhere but to this computer.
fn is_loopback(authority: &str) -> bool {
    let name = match authority.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') => {
            let is_port = port.bytes().all(|byte| byte.is_ascii_digit());
            if !is_port || port.parse::<u16>().is_err() {
                return false;
            }
            name
        }
        _ => authority,
    };
    authority.parse::<Uri>().is_ok()
        && LOOPBACK
            .iter()
            .any(|loopback| name.eq_ignore_ascii_case(loopback))
}

#[cfg(test)]
mod tests {
    use super::{Origin, check_host, of};
    use crate::web::http::Request;
    use tungstenite::http;

    fn request(fields: &[(&str, &str)]) -> Request {
        let mut request = http::Request::builder().uri("/stream");
        for &(name, value) in fields {
            request = request.header(name, value);
        }
        request.body(()).unwrap()
    }

    #[test]
    fn origins() {
        let table = [
            ("http://localhost:8080", Origin::Own),
            ("http://LOCALHOST:8080", Origin::Own),
            ("https://localhost:8080", Origin::Loopback),
            ("http://localhost:3000", Origin::Loopback),
            ("http://localhost", Origin::Loopback),
            ("http://127.0.0.1:8080", Origin::Loopback),
            ("https://127.0.0.1", Origin::Loopback),
            ("http://[::1]:5500", Origin::Loopback),
            ("http://[::1]", Origin::Loopback),
            ("null", Origin::File),
            ("file://", Origin::Foreign),
            ("http://evil.example", Origin::Foreign),
            ("http://127.0.0.1.evil.example", Origin::Foreign),
            ("http://localhost.evil.example:8080", Origin::Foreign),
            ("http://localhost:8080.evil.example", Origin::Foreign),
            ("http://localhost:80@evil.example", Origin::Foreign),
            ("http://localhost@evil.example", Origin::Foreign),
            ("http://127.0.0.1:99999", Origin::Foreign),
            ("http://127.0.0.1:", Origin::Foreign),
            ("http://127.0.0.1/", Origin::Foreign),
            ("http://127.1", Origin::Foreign),
            ("http://[::2]:80", Origin::Foreign),
            ("http://[::1", Origin::Foreign),
            ("chrome-extension://abcdef", Origin::Foreign),
            ("", Origin::Foreign),
        ];
        for (origin, expected) in table {
            let request = request(&[("Host", "localhost:8080"), ("Origin", origin)]);
            assert_eq!(of(&request), expected, "{origin}");
        }
        assert_eq!(of(&request(&[("Host", "localhost:8080")])), Origin::Program);
        let two = request(&[("Origin", "http://localhost"), ("Origin", "null")]);
        assert_eq!(of(&two), Origin::Foreign);
    }

    #[test]
    fn hosts() {
        for host in [
            "localhost",
            "localhost:1",
            "127.0.0.1:8080",
            "[::1]:8080",
            "[::1]",
        ] {
            assert!(check_host(&request(&[("Host", host)])).is_ok(), "{host}");
        }
        for (fields, status) in [
            (&[("Host", "evil.example:8080")][..], 403),
            (&[("Host", "127.0.0.1.evil.example")], 403),
            (&[("Host", "0.0.0.0:8080")], 403),
            (&[("Host", "")], 403),
            (&[], 400),
            (&[("Host", "localhost"), ("Host", "evil.example")], 400),
        ] {
            let response = check_host(&request(fields)).unwrap_err();
            assert_eq!(response.status, status, "{fields:?}");
        }
    }
}
