/// The two kinds of failure that reach a user. Any other exception means a broken invariant, which is a bug of ours.
///
/// Every message is one line. It names the thing, its value, what is allowed, and the remedy.
#pragma once

#include <stdexcept>
#include <string>

namespace eikonal {

/// Wrong usage or an invalid scene. The programs exit with status 2 before they make any frame.
struct __attribute__((visibility("default"))) UserError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A file or frame that cannot be read, made or written. The programs exit with status 1 and keep finished frames.
struct __attribute__((visibility("default"))) FrameError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The text of the FrameError that ends work once a stop is requested.
inline constexpr const char* kStopped = "interrupted";

}  // namespace eikonal
