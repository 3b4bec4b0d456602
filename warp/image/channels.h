/// Which channels of a part are colour, alpha or data, and which ones form a group.
///
/// The first rule that matches decides. A name is split at the last dot into layer and channel. Words of a layer's name
/// are separated by punctuation or by capitals: "uCryptoObject" is u, crypto, object. Case does not matter.
///   1. Data: 32-bit integer channels, and the channel that the file names as depth.
///   2. Data, including alpha: a layer named by cryptomatte metadata, or with a data word in its name. The words are
///      kDataWords in channels.cpp: depth, normal, position, motion, uv, id, crypto, mask, matte …, and the letters N,
///      P, Z alone. A channel without a layer takes the name of its part as its layer.
///   3. Alpha of its layer: A, alpha, or the channel that the file names as alpha.
///   4. Colour: R, G, B, red, green, blue. In a layer without a channel X also Y, luminance, I, gray and grey. In
///   integer
///      pictures other than EXR with at most four channels, all other channels (palettes, CMYK as delivered).
///   5. Data: everything else (Z, X, U, object_id, mask …). A channel that is not known to be colour is never filtered.
#pragma once

#include "warp/image/picture.h"

namespace eikonal {

/// Fills part.kinds and part.groups from part.spec. format: OpenImageIO's name of the file format.
void classify_channels(Part& part, std::string_view format);

/// The transfer curve of a picture, by its attribute oiio:ColorSpace and its pixel type:
///     linear, scene_linear, ACES…                            Linear
///     sRGB                                                   SRGB
///     Rec709                                                 BT709
///     KodakLog, Cineon                                       KodakLog
///     GammaX.Y, and GammaCorrected with oiio:Gamma           Linear near 1, else Gamma22 as the nearest curve
///     anything else                                          Linear for float types, SRGB for integers
/// format: OpenImageIO's name of the file format. Floats of PFM ("pnm") are linear, although OpenImageIO calls them
/// Rec709.
Transfer transfer_of(const OIIO::ImageSpec& spec, std::string_view format);

}  // namespace eikonal
