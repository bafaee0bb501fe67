#!/bin/sh
# The checks of embree-ffi that need libclang: generated bindings are what the header says, and the witness agrees.
# Takes libclang from the system, from LIBCLANG_PATH, or from the Python wheel of that name.
set -eu
cd "$(dirname "$0")"

if [ -z "${LIBCLANG_PATH:-}" ] && ! ldconfig -p 2>/dev/null | grep -q 'libclang\(-[0-9.]*\)\?\.so'; then
    tools="${CARGO_TARGET_DIR:-../target}/libclang"
    [ -d "$tools/clang/native" ] || PIP_ROOT_USER_ACTION=ignore python3 -m pip install --quiet --disable-pip-version-check --target "$tools" libclang==18.1.1
    LIBCLANG_PATH="$(cd "$tools/clang/native" && pwd)"
    export LIBCLANG_PATH
fi
# The wheel's libclang comes without the compiler's own headers (stddef.h), which embree4-sys includes.
BINDGEN_EXTRA_CLANG_ARGS="${BINDGEN_EXTRA_CLANG_ARGS:-} -isystem $(cc -print-file-name=include)"
export BINDGEN_EXTRA_CLANG_ARGS

cargo run --quiet -p embree-ffi --features regenerate --example bindings -- --check
cargo test --quiet -p embree-ffi --features witness --test witness
