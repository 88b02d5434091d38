//! The page and the streams for browsers: HTTP and WebSocket on loopback, and nowhere else.
//!
//! Any page in the world can make a browser ask a server on its own computer. So what a request says of
//! where it comes from is looked at first ([`origin`]): a browser does not let a page lie about it.

pub mod http;

pub mod origin;

pub mod page;

pub mod server;

pub mod websocket;
