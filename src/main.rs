//! umbra
fn main() {}
