/// Photographs that were stored as the sensor lay, with a tag that tells how to turn them (Exif's Orientation).
///
/// Up in the picture is up in the air, so pixels are turned upright as they are read, whatever is done with them later,
/// and the tag becomes 1, "as stored". The values stay what they are.
#pragma once

#include <string_view>

#include "warp/image/picture.h"

namespace eikonal {

/// Whether the tag means that in files of this format (OpenImageIO's name). Not in EXR, where an attribute of this name
/// that a conversion has left means nothing to those who show it; nor in DPX, where scanners tell how they ran.
bool may_lie_turned(std::string_view format);

/// Turns windows, pixels (if there are any), resolution and pixel aspect as the tag says (2 … 8; else nothing happens).
/// Shown by a program that heeds the tag, the part looks the same as before.
void turn_upright(Part& part);

}  // namespace eikonal
