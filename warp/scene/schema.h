/// The keys of a whole scene. This is the root of the one list of all keys, which the scene reader uses, and all code
/// that shows keys. The keys of a medium are beside its parameters, under noise/.
#pragma once

#include "noise/medium/key_reader.h"
#include "warp/scene/scene.h"

namespace eikonal {

/// The keys of the root table. They refer to the scene, which must outlive them.
Keys keys(Scene& scene);

}  // namespace eikonal
