/// Which channels of a part are colour, alpha or data, and which belong together.
///
/// The rule, first match wins (names are split at the last dot into layer and channel; words inside a layer's name are
/// separated by punctuation or by capitals, "uCryptoObject" -> u crypto object; case does not matter):
///   1. 32-bit integer channels, and the depth channel the file names, are data.
///   2. A layer named by cryptomatte metadata, or with a data word in its name (kDataWords in channels.cpp: depth,
///      normal, position, motion, uv, id, crypto, mask, matte …; the letters N, P, Z alone), is data, alpha included.
///      Channels without a layer take their part's name for one.
///   3. A, alpha, or the channel the file calls alpha: alpha of its layer.
///   4. R, G, B, red, green, blue, and Y, luminance, I, gray, grey in a layer that has no X channel: colour. So are all
///      channels of integer pictures outside EXR, which name them otherwise (palettes, CMYK as delivered), but not more
///      than four of them.
///   5. Everything else (Z, X, U, object_id, mask …) is data: what is not known to be colour is never filtered.
#pragma once

#include "warp/image/picture.h"

namespace eikonal {

/// Fills part.kinds and part.groups from part.spec. `format` is OpenImageIO's name of the file format.
void classify_channels(Part& part, std::string_view format);

/// The transfer that the metadata and the pixel type of a picture mean.
/// oiio:ColorSpace linear, scene_linear, ACES…: Linear; sRGB: SRGB; Rec709: BT709; KodakLog, Cineon: KodakLog;
/// GammaX.Y and GammaCorrected with oiio:Gamma: Linear near 1, else Gamma22, the nearest there is. Anything else:
/// Linear for float types and SRGB for integers. format: OpenImageIO's name; the floats of PFM ("pnm") are linear,
/// though it calls them Rec709.
Transfer transfer_of(const OIIO::ImageSpec& spec, std::string_view format);

}  // namespace eikonal
