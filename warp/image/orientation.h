/// Photographs that are stored as the sensor lay, with a tag that tells how to turn them (Exif's Orientation).
///
/// The warp needs to know which way is up. Pixels are therefore turned upright when they are read, and the tag becomes
/// 1, "as stored". Their values do not change.
#pragma once

#include <string_view>

#include "warp/image/picture.h"

namespace eikonal {

/// Whether files of this format (OpenImageIO's name) use the tag in this sense. EXR does not: viewers ignore an
/// attribute of this name, which a conversion may have left. DPX does not: its tag states how a scanner ran.
bool may_lie_turned(std::string_view format);

/// Turns windows, pixels (if there are any), resolution and pixel aspect as the tag says. Only tags 2 … 8 do anything.
/// A program that heeds the tag shows the part as before.
void turn_upright(Part& part);

}  // namespace eikonal
