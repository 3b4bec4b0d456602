/// The two kinds of failure that reach a user. Anything else that is thrown is a broken invariant, hence our bug.
/// Every message is one line: it names the thing, the value, what is allowed, and the remedy.
#pragma once

#include <stdexcept>
#include <string>

namespace eikonal {

/// Wrong usage or an invalid scene: the programs exit with status 2 before any frame is made.
struct UserError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A file or frame that cannot be read, made or written: exit status 1; finished frames stay.
struct FrameError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace eikonal
