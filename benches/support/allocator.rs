//! The allocator of the wayfield binary, so that the benches run with the same allocator as users.

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;
