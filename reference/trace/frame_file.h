/// The EXR that a rendered frame becomes: channels as render.h names them.
///
/// Colour is half; Z, u, v and all the rest float32: measurements keep their digits.
#pragma once

#include <filesystem>

#include "reference/trace/render.h"

namespace eikonal::reference {

/// Exact: ZIP. Compact, for small sample files: colour DWAA (slightly lossy), Z rounded to within kCompactDepthError.
enum class Storage { Exact, Compact };

/// Relative.
inline constexpr double kCompactDepthError = 0x1p-18;

/// Writes every plane that the frame has. FrameError.
void write_frame(const std::filesystem::path& file, const RenderedFrame& frame, Storage storage);

}  // namespace eikonal::reference
