/// The EXR file of a rendered frame. Its channels have the names in render.h.
///
/// Colour is half. Z, u, v and all other channels are float32, so that measurements keep their digits.
#pragma once

#include <filesystem>

#include "reference/trace/render.h"

namespace eikonal::reference {

/// Exact: ZIP, nothing is lost. Compact: for small sample files; colour is DWAA, which loses a little, and Z is rounded
/// to within kCompactDepthError.
enum class Storage { Exact, Compact };

/// Largest relative error of Z in a compact file.
inline constexpr double kCompactDepthError = 0x1p-18;

/// Writes every plane that the frame has. FrameError if the file cannot be written.
void write_frame(const std::filesystem::path& file, const RenderedFrame& frame, Storage storage);

}  // namespace eikonal::reference
