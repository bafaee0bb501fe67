//! Makes `src/bindings.rs` anew from `abi/embree4.h`, or with `--check` fails when the two have drifted apart.
//!
//! `cargo run -p embree-ffi --features regenerate --example bindings [-- --check]`; needs libclang.

use std::{path::Path, process::ExitCode};

fn main() -> ExitCode {
    let home = Path::new(env!("CARGO_MANIFEST_DIR"));
    let committed = home.join("src/bindings.rs");
    let fresh = generate(&home.join("abi/embree4.h"));
    if !std::env::args().any(|argument| argument == "--check") {
        std::fs::write(&committed, fresh).expect("src/bindings.rs can be written");
        return ExitCode::SUCCESS;
    }
    if std::fs::read_to_string(&committed).is_ok_and(|text| text == fresh) {
        println!("src/bindings.rs is what abi/embree4.h says");
        return ExitCode::SUCCESS;
    }
    eprintln!(
        "src/bindings.rs differs from what abi/embree4.h says: \
         cargo run -p embree-ffi --features regenerate --example bindings"
    );
    ExitCode::FAILURE
}

/// Plain types with their layout asserted, enumerations that admit values we do not know, functions found at run time.
fn generate(header: &Path) -> String {
    bindgen::Builder::default()
        .header(header.to_str().expect("a path of UTF-8"))
        .clang_arg("--target=x86_64-unknown-linux-gnu")
        .rust_target(bindgen::RustTarget::stable(85, 0).expect("a stable Rust"))
        .rust_edition(bindgen::RustEdition::Edition2024)
        .allowlist_type("RTC.*")
        .allowlist_function("rtc.*")
        .newtype_enum("RTC.*")
        .prepend_enum_name(false)
        .use_core()
        .derive_default(false)
        .dynamic_library_name("Embree")
        .dynamic_link_require_all(true)
        .wrap_unsafe_ops(true)
        .disable_header_comment()
        .raw_line("// Generated from abi/embree4.h by examples/bindings.rs. Do not edit.")
        .formatter(bindgen::Formatter::Prettyplease)
        .generate()
        .expect("bindgen reads abi/embree4.h")
        .to_string()
}
